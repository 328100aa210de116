// Where the parts of State::extra are: what pools keep, what the time scheme keeps, what the control of
// errors keeps.
#pragma once

#include "engine/base/base.h"

namespace isochor {

struct StateLayout {
  std::size_t pools = 0, scheme = 0, error = 0;  // numbers

  std::size_t size() const { return pools + scheme + error; }
  std::span<const double> of_pools(const std::vector<double>& extra) const {
    return std::span(extra).first(pools);
  }
  std::span<double> of_scheme(std::vector<double>& extra) const {
    return std::span(extra).subspan(pools, scheme);
  }
  std::span<double> of_error(std::vector<double>& extra) const {
    return std::span(extra).subspan(pools + scheme, error);
  }
};

}  // namespace isochor
