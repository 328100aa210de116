// MUMPS, sequential, for symmetric indefinite matrices: multifrontal LDL^T with threshold pivoting.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/solvers/linear_solver.h"
#include "engine/solvers/ordering.h"

namespace isochor {

// The defaults are what the engine uses; the rest is for measurements.
struct MumpsOptions {
  // A pivot must be at least this fraction of its column. Smaller: less fill, more growth, which refinement
  // pays for.
  double pivot_threshold = 0.01;
  // A pivot row below this fraction of the matrix norm is zero: the matrix is reported as singular.
  double singular_threshold = 1e-14;
  // The engine hands in scaled values, so MUMPS' own scaling is work without use.
  bool scaling = false;
  // Of the quotient graph of the groups. `best` tries the three that win somewhere (nested dissection twice,
  // minimum fill) and keeps the one whose analysis promises the fewest operations.
  OrderingMethod ordering = OrderingMethod::best;
  // One of MUMPS' own orderings (its ICNTL(7)) instead of ours on the groups; -1: ours.
  int own_ordering = -1;
  // LU of a matrix given by two triangles (LinearSolver::factor).
  bool unsymmetric = false;
};

// Null when MUMPS is not part of this build.
std::unique_ptr<LinearSolver> make_mumps_solver(const MumpsOptions& options = {});
// Pivot positions of the vertices of a graph (both directions of every edge, no loops) by an ordering that
// comes with MUMPS: pord or amf. False when it is not to be had.
bool mumps_graph_ordering(std::span<const Index> start, std::span<const Index> neighbor,
                          OrderingMethod method, std::vector<Index>& position);
std::string mumps_version();  // empty when not built in

}  // namespace isochor
