// Minimal residuals that begin anew when their room is used up.
#pragma once

#include <cmath>
#include <utility>

#include "engine/solvers/gmres.h"

namespace isochor {

struct GmresRounds {
  double wanted = 1e-8;      // residual against the right-hand side, in the Euclidean norm
  int most = 3;              // rounds
  int most_directions = 90;  // of all of them; a round begins where it has room
};
struct GmresVectors {
  std::span<const double> b;
  std::span<double> x, residual, work;  // x: zero at first
};

// True when it arrived, by the residual itself; otherwise x is what is worth going on from. Ends early where
// another round would not do. `directions` is counted up.
template <class Apply, class Precondition>
bool solve_in_rounds(Gmres& gmres, const GmresRounds& rounds, const GmresVectors& v, const Apply& apply,
                     const Precondition& precondition, int& directions) {
  constexpr double slow = 0.1;  // what a round leaves where another would not do
  const double start = gmres.norm(v.b);
  std::copy(v.b.begin(), v.b.end(), v.residual.begin());
  double now = start;
  for (int round = 0; round < rounds.most && directions + gmres.room() <= rounds.most_directions; ++round) {
    const int taken = gmres.solve(v.residual, v.work, rounds.wanted * start / now, apply, precondition);
    if (taken < 0) return false;
    directions += taken;
    for (std::size_t i = 0; i < v.x.size(); ++i) v.work[i] += v.x[i];
    apply(std::span<const double>(v.work), v.residual);
    for (std::size_t i = 0; i < v.x.size(); ++i) v.residual[i] = v.b[i] - v.residual[i];
    const double before = std::exchange(now, gmres.norm(v.residual));
    if (!(now < before)) return false;
    std::copy(v.work.begin(), v.work.end(), v.x.begin());
    // The method's own residual drifts from this one in the last digits.
    if (now <= 1.01 * rounds.wanted * start) return true;
    if (now > slow * before) return false;
  }
  return false;
}

}  // namespace isochor
