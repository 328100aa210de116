// The saddle point of one increment, made once: what it asks, what a solve may cost, and how it ended.
#pragma once

#include "engine/system/system.h"
#include "isochor/work.h"

namespace isochor {

struct SaddleOptions {
  int max_iterations = 60;
  // Of a budget: no more, whatever else a method counts its iterations by. 0: none.
  int budget = 0;
  int max_factorizations = 1000;  // mending an inertia takes more than one an iteration
  // From so many on, a solve goes on only while it gets somewhere.
  int patient_iterations = 1000, patient_factorizations = 1000;
  // Of iterations inside of steps (SaddleReport::inner_work()): a solve whose steps take that much of them
  // gets nowhere.
  double most_inner_work() const { return 3.0 * max_factorizations; }
  // A body in motion whose steps all go downhill is given several times the limits above.
  bool persistent = false;
  // Residual force against the magnitudes that cancel in it, in the norm sqrt(sum |r_i|^2 / k_i), k_i the
  // stiffness of a node at rest plus its inertia.
  double force_tolerance = 1e-9;
  // max |phi - target - C lambda| / measure: relative volume for volume rows.
  double row_tolerance = 1e-10;
  bool corrections = true;  // whether factors at hand may be used again
  // Of the stencils' Hessians in every matrix.
  Definiteness definiteness = Definiteness::exact;
  // Largest distance to a prescribed position, relative to the scene's length.
  double position_tolerance = 1e-12;
};

// What stays fixed while one saddle point is solved.
struct SaddleProblem {
  double mass_scale = 0;               // [1/s^2]
  std::span<const Vec3> predicted;     // inertia's positions; unused when mass_scale is 0
  std::span<const Vec3> force;         // dead loads [N]
  std::span<const double> target;      // compliant rows
  std::span<const double> prescribed;  // multipliers of prescribed rows
  // Those where the increment began; empty: not known. A matrix may be taken from there.
  std::span<const double> prescribed_before;
  std::span<const Vec3> position;  // targets of given nodes, one for each System::free_bases() entry
  std::span<const double> memory;  // System::memory() numbers: what pools keep between steps
  StencilIncrement increment;      // its times, and where it began
};

enum class SaddleStatus : std::uint8_t {
  converged,
  iteration_limit,
  line_search_failed,
  singular,
  diverged,    // positions left every reasonable bound
  not_finite,  // NaN or infinity in loads, or an energy without value at the start
  cancelled,
  out_of_memory,
  passed_through,  // converged, but nodes passed through what they must not
  inadmissible,    // converged to an end that must not be a state; the message says why
};
std::string_view to_string(SaddleStatus status);

struct SaddleReport : SolveCounters {
  SaddleStatus status = SaddleStatus::converged;
  Index negative_pivots = -1;  // of the last factorization; rows() when the inertia is right
  double force_residual = 0, row_residual = 0, linear_residual = 0;
  double step = 0;  // largest displacement of the last step [m]
  std::string message;
  // Of a matrix that stayed singular: who is in its null vector. Nodes that may move without a force, or,
  // where `null_rows` is not empty, effects whose rows depend on each other and the nodes around them.
  std::vector<Index> null_nodes;
  std::vector<std::string> null_rows;

  // Counts the work of an earlier solve of the same step in.
  void add_work(const SaddleReport& earlier) { SolveCounters::operator+=(earlier); }
  // What iterations inside of steps took, in factorizations, roughly: the same on every machine.
  double inner_work() const {
    return 0.1 * dual.steps + 0.05 * static_cast<double>(dual.iterations) +
           0.02 * static_cast<double>(krylov.iterations);
  }
  double work() const { return factorizations + 0.1 * corrections + inner_work(); }
};

// Energy that positions and multipliers hold [J]: elastic, of compliant rows and of rows with a law, less the
// work of loads since rest; no inertia.
struct StoredEnergy {
  double energy = 0;
  double elastic = 0;  // magnitude of the elastic part, to compare changes with
  double noise = 0;    // rounding error of the energy
  double row = 0;      // residual of the rows, as SaddleReport::row_residual
  bool met = false;    // rows and given positions are where the problem wants them
};

bool all_finite(const SaddleProblem& p);

}  // namespace isochor
