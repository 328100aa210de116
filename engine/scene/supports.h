// All prescribed motions of a scene, merged node by node.
#pragma once

#include "engine/scene/builder.h"

namespace isochor {

class SupportPrescriber final : public Prescriber {
 public:
  struct Term {
    Vec3 direction;
    std::shared_ptr<const Motion> motion;
  };
  std::string_view name() const override { return "supports"; }
  // Linearly independent directions; the displacement along each is that of its motion.
  void add(Index node, const Vec3& rest, std::vector<Term> terms);
  void target(double t, std::span<Vec3> position) const override;
  double turn(double t0, double t1) const override;

 private:
  std::vector<Vec3> rest_;
  std::vector<std::vector<Term>> terms_;
  std::vector<std::shared_ptr<const Motion>> motions_;  // each once
};

}  // namespace isochor
