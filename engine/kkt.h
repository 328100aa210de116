// The linear systems of Newton's method: matrix of the saddle point, scaled and factored; right-hand sides
// in, steps of positions and multipliers out. Rows come in as they are treated: kept in the matrix, condensed
// into the stiffness (their compliance is invertible), or bordered (eliminated around the factorization).
#pragma once

#include "engine/assembly.h"

namespace isochor {

// Seconds by stage.
struct StageSeconds {
  double analyze = 0, evaluate = 0, gather = 0, factor = 0, solve = 0, line_search = 0;
  StageSeconds& operator+=(const StageSeconds& o);
};

class Stopwatch {
 public:
  explicit Stopwatch(double& total);
  ~Stopwatch();
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& total_;
  double start_;
};

class Kkt {
 public:
  Kkt(std::shared_ptr<const System> system, const Parallel& parallel, std::unique_ptr<LinearSolver> solver);

  // What one matrix is made of, besides the last evaluation of the assembly (Want::hessian).
  struct Values {
    double mass_scale = 0;                  // [1/s^2]
    double shift = 0;                       // of the displacement block, relative to each node's stiffness
    std::span<const double> stiffness;      // reference of every node [N/m]
    std::span<const double> tangent;        // one for each System::compliance() entry; read where laws are
    std::span<const std::uint8_t> clamped;  // rows held at a bound; empty: none
    double trace = 0;  // compliance added to the matrix alone, relative; the equations solved are others
  };
  struct Outcome {
    FactorStatus status = FactorStatus::ok;
    Index negative =
        -1;  // negative pivots of the whole system, all rows counted; -1: the backend cannot tell
    std::string message;
  };
  Outcome factor(const Assembly& assembly, const Values& values, StageSeconds& seconds);

  // Solves for the steps: node_rhs over all nodes (what falls on given directions is ignored), row_rhs over
  // all compliant rows in the sign of [K, G^T; G, -C]. Returns false when the residual is not acceptable.
  bool solve(std::span<const Vec3> node_rhs, std::span<const double> row_rhs, std::span<Vec3> dx,
             std::span<double> dlambda, StageSeconds& seconds);

  LinearSolver& linear_solver() { return *solver_; }
  double residual() const { return residual_; }  // of the last solve, relative
  std::int64_t factor_nonzeros() const { return factor_nonzeros_; }
  int analyses() const { return analyses_; }

 private:
  void scale_unknowns(const Values& values);
  void add_condensed(const Values& values);
  void add_trace(double trace);
  Outcome eliminate_border(const Values& values, Outcome outcome);
  void border_column(Index row, std::span<double> column) const;
  double border_dot(Index row, std::span<const double> v) const;
  double compliance_of(const Values& values, std::size_t entry) const;

  std::shared_ptr<const System> system_;
  const Parallel& parallel_;
  std::unique_ptr<LinearSolver> solver_;
  std::int64_t factor_nonzeros_ = 0;
  int analyses_ = 0;
  bool analyzed_ = false;
  double residual_ = 0;
  std::vector<double> values_, scale_, rhs_, solution_;
  // Rows outside the matrix: their Jacobian in free directions, their compliance (condensed) and, for the
  // border, A^-1 B and the factored Schur complement.
  std::vector<Vec3> row_jacobian_;
  std::vector<double> condensed_compliance_, condensed_part_;
  std::vector<double> border_solution_, schur_, schur_vectors_, border_value_, border_work_;
};

}  // namespace isochor
