// Rows of contact with Newton's law of impact.
#pragma once

#include <algorithm>
#include <memory>

#include "constraints/contact_pool.h"
#include "constraints/contact_rows.h"

namespace isochor {

// A point whose gap g closes within an increment h at a speed u (of positions and velocities at its start,
// obstacles included) gets the target g + h e u for its end: the gap opens at e u there (the time stepping of
// Moreau 1988). Of frictionless impacts, P the impulses, the change of energy under implicit Euler is
//   sum P (u_before + u_after) / 2 = -sum P (1 - e) u / 2 <= 0.
// The gap may have opened by sliding along a curved obstacle alone; the smaller of both targets counts, so
// that curvature adds no speed. What rests has no speed at the start of an increment and goes on resting.
class BouncingRows final : public ContactRows {
 public:
  BouncingRows(std::string name, double resolve_time, std::shared_ptr<const ContactPool> pool,
               double restitution, double slowest)
      : ContactRows(std::move(name), resolve_time),
        pool_(std::move(pool)),
        restitution_(restitution),
        slowest_(slowest) {}

  bool looks_back() const override { return true; }
  bool look_back(const RowStart& start, std::span<double> value) const override {
    const double h = start.t1 - start.t0;
    const ContactFrame before = pool_->frame(start.t0, start.x), later = pool_->frame(start.t1, start.ahead);
    bool any = false;
    for (Index s = 0; s < pool_->stencils(); ++s) {
      const double ahead = pool_->gap(s, later, start.ahead);
      if (!(ahead < value[at(s)])) continue;
      const double speed = -pool_->gap_rate(s, before, later, h, start.x, start.v);
      if (!(speed > slowest_)) continue;
      const double gap = pool_->gap(s, before, start.x);
      value[at(s)] = std::max(
          value[at(s)], std::min(gap + h * restitution_ * speed, ahead + h * (1 + restitution_) * speed));
      any = true;
    }
    return any;
  }

 private:
  std::shared_ptr<const ContactPool> pool_;
  double restitution_, slowest_;  // e [-]; speed that what is slower does not bounce at [m/s]
};

}  // namespace isochor
