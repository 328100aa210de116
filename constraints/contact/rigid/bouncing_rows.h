// Rows of contact with Newton's law of impact.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "constraints/contact/contact_rows.h"
#include "constraints/contact/rigid/contact_impact.h"
#include "constraints/contact/rigid/contact_pool.h"

namespace isochor {

// Points whose gaps close within an increment, at speeds u when it begins (obstacles included), are hit then:
// impulses P >= 0 along the normals make all of them open at e u or more, P = 0 where more (Moreau 1988),
// found by sweeps over the points; again, for points that this sends on their way in. Soft nodes have their
// own mass in this, rigid bodies mass and inertia. The increment begins with the velocities behind the impact
// and has the rows of ContactRows. Energy changes by
//   sum P (u_before + u_after) / 2 = -sum P (1 - e) u / 2 <= 0
// in the impact, and not upward in the increment under implicit Euler.
class BouncingRows final : public ContactRows, public ImpactRows {
 public:
  BouncingRows(std::string name, double resolve_time, std::shared_ptr<const ContactPool> pool,
               double restitution, double slowest)
      : ContactRows(std::move(name), resolve_time),
        pool_(std::move(pool)),
        restitution_(restitution),
        slowest_(slowest) {}

  RowFacets facets() const override {
    RowFacets f = ContactRows::facets();
    f.impact = this;
    return f;
  }
  bool add_jumps(const ImpactStart& start, std::span<Vec3> jump) const override {
    constexpr int most_rounds = 20;
    const ContactFrame before = geometry().frame(start.t0, start.x),
                       later = geometry().frame(start.t1, start.ahead);
    // An impact may send other points the way of one.
    int rounds = 0;
    for (double fastest; rounds < most_rounds; ++rounds) {
      if (fastest = find_hits(start, before, later, jump); fastest == 0) break;
      strike(start, before, later, fastest, jump);
    }
    return rounds > 0;
  }

 private:
  // Speeds of the points that close now into the first half of the work, no impulses into the second. Returns
  // the largest speed.
  double find_hits(const ImpactStart& start, const ContactFrame& before, const ContactFrame& later,
                   std::span<const Vec3> jump) const {
    const auto speed = start.work.first(at(rows())), impulse = start.work.subspan(at(rows()));
    double fastest = 0;
    for (Index s = 0; s < rows(); ++s) {
      speed[at(s)] = impulse[at(s)] = 0;
      const double u = -gap_rate(geometry(), s, start, before, later, jump);
      if (!(u > slowest_)) continue;
      const double jumped = -u - gap_rate(geometry(), s, start, before, later, {});
      if (!(geometry().gap(s, later, start.ahead) + (start.t1 - start.t0) * jumped < start.target[at(s)]))
        continue;
      speed[at(s)] = u;
      fastest = std::max(fastest, u);
    }
    return fastest;
  }

  void strike(const ImpactStart& start, const ContactFrame& before, const ContactFrame& later, double fastest,
              std::span<Vec3> jump) const {
    constexpr int most_sweeps = 200;
    constexpr double settled = 1e-12;
    const auto speed = start.work.first(at(rows())), impulse = start.work.subspan(at(rows()));
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      double change = 0;
      for (Index s = 0; s < rows(); ++s) {
        if (speed[at(s)] == 0) continue;
        const Impact hit = impact(geometry(), s, start, before);
        if (!(hit.mobility > 0)) continue;
        const double missing =
            restitution_ * speed[at(s)] - gap_rate(geometry(), s, start, before, later, jump);
        const double next = std::max(0.0, impulse[at(s)] + missing / hit.mobility);
        const double push = next - impulse[at(s)];
        impulse[at(s)] = next;
        change = std::max(change, std::abs(push) * hit.mobility);
        const auto nodes = pool_->nodes()[s];
        for (std::size_t i = 0; i < nodes.size(); ++i) jump[at(nodes[i])] += push * hit.velocity[i];
      }
      if (change <= settled * fastest) break;
    }
  }

  const RigidGeometry& geometry() const { return pool_->geometry(); }

  std::shared_ptr<const ContactPool> pool_;
  double restitution_, slowest_;  // e [-]; speed that what is slower does not bounce at [m/s]
};

}  // namespace isochor
