#include "engine/scene/supports.h"

#include <algorithm>
#include <cmath>

namespace isochor {

void SupportPrescriber::add(Index node, const Vec3& rest, std::vector<Term> terms) {
  PrescribedNode p;
  p.node = node;
  for (const Term& term : terms) {
    Vec3 d = term.direction;
    for (int k = 0; k < p.directions; ++k) {
      const Vec3& f = p.direction[static_cast<std::size_t>(k)];
      d -= dot(d, f) * f;
    }
    p.direction[static_cast<std::size_t>(p.directions++)] = (1 / std::sqrt(dot(d, d))) * d;
  }
  // With all three given, the frame is that of the axes: no rotation of the unknowns is needed anyway.
  nodes.push_back(p);
  rest_.push_back(rest);
  for (const Term& term : terms) {
    if (std::find(motions_.begin(), motions_.end(), term.motion) == motions_.end())
      motions_.push_back(term.motion);
  }
  terms_.push_back(std::move(terms));
}

double SupportPrescriber::turn(double t0, double t1) const {
  double largest = 0;
  for (const auto& motion : motions_) largest = std::max(largest, motion->turn(t0, t1));
  return largest;
}

void SupportPrescriber::target(double t, std::span<Vec3> position) const {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const PrescribedNode& p = nodes[i];
    // The orthonormal frame came from the directions in turn, so the system for its coordinates is
    // triangular: direction_j . sum_k y_k frame_k = direction_j . u_j.
    Vec3 u{};
    for (int j = 0; j < p.directions; ++j) {
      const Term& term = terms_[i][static_cast<std::size_t>(j)];
      const Vec3& f = p.direction[static_cast<std::size_t>(j)];
      const double wanted = dot(term.direction, term.motion->displacement(t, rest_[i]) - u);
      u += (wanted / dot(term.direction, f)) * f;
    }
    position[i] = rest_[i] + u;
  }
}

}  // namespace isochor
