#include "engine/base/row_loop.h"

#include <algorithm>

namespace isochor {

double BlockedDot::operator()(const RowLoop& loop, std::span<const double> a, std::span<const double> b) {
  const std::size_t n = a.size();
  const auto count = static_cast<Index>((n + block - 1) / block);
  loop(count, 4, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      const std::size_t from = at(c) * block, to = std::min(n, from + block);
      double sum[4] = {};
      std::size_t i = from;
      for (; i + 4 <= to; i += 4) {
        for (std::size_t j = 0; j < 4; ++j) sum[j] += a[i + j] * b[i + j];
      }
      for (; i < to; ++i) sum[0] += a[i] * b[i];
      partial_[at(c)] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
  });
  double total = 0;
  for (Index c = 0; c < count; ++c) total += partial_[at(c)];
  return total;
}

}  // namespace isochor
