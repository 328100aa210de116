#include "engine/solvers/foreign/mumps_solver.h"

#ifdef ISOCHOR_HAVE_MUMPS

#include <dmumps_c.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

#include "engine/base/base.h"
#include "engine/solvers/direct_solver.h"

namespace isochor {
namespace {

// MUMPS keeps state in Fortran modules: instances may live side by side, calls may not. Every call of the
// process goes through this lock, so worlds in several threads work, one factorization at a time.
std::mutex& mumps_mutex() {
  static std::mutex mutex;
  return mutex;
}

constexpr int use_communicator_of_all = -987654;  // MUMPS' own name for MPI_COMM_WORLD
constexpr int job_start = -1, job_end = -2, job_analyze = 1, job_factor = 2, job_solve = 3;

// PORD ends the process ("no valid number of stages") on graphs that collapse to one vertex, as small ones
// do, where it has little to win anyway.
constexpr Index kSmallestForPord = 4000;

class MumpsSolver final : public DirectSolver {
 public:
  explicit MumpsSolver(const MumpsOptions& options) : DirectSolver(options.unsymmetric), options_(options) {}
  ~MumpsSolver() override { close(); }
  MumpsSolver(const MumpsSolver&) = delete;
  MumpsSolver& operator=(const MumpsSolver&) = delete;

  std::string_view name() const override { return "mumps"; }

 protected:
  FactorReport analyze_pattern() override;
  FactorReport factor_values() override;
  bool apply_inverse(std::span<double> x) override;

 private:
  // The controls, numbered as in the users' guide.
  int& icntl(int i) { return mumps_.icntl[i - 1]; }
  double& cntl(int i) { return mumps_.cntl[i - 1]; }
  int infog(int i) const { return mumps_.infog[i - 1]; }
  void call(int job);
  void close();
  void analyze_with(const Ordering& ordering);
  FactorReport failure(const char* stage) const;

  MumpsOptions options_;
  DMUMPS_STRUC_C mumps_{};
  std::vector<MUMPS_INT> row_, column_, position_;  // from 1
  bool open_ = false;
};

void MumpsSolver::call(int job) {
  const std::lock_guard lock(mumps_mutex());
  mumps_.job = job;
  dmumps_c(&mumps_);
}

void MumpsSolver::close() {
  if (open_) call(job_end);
  open_ = false;
}

FactorReport MumpsSolver::failure(const char* stage) const {
  FactorReport report;
  const int code = infog(1), detail = infog(2);
  switch (code) {
    case -6:
    case -10:
      report.status = FactorStatus::singular;
      report.message =
          code == -6 ? "the matrix is structurally singular" : "the matrix is numerically singular";
      return report;
    case -5:
    case -7:
    case -8:
    case -9:
    case -13:
      report.status = FactorStatus::out_of_memory;
      break;
    default:
      report.status = FactorStatus::failed;
  }
  report.message = std::string("MUMPS failed in ") + stage + " with INFOG(1) = " + std::to_string(code) +
                   ", INFOG(2) = " + std::to_string(detail);
  return report;
}

FactorReport MumpsSolver::analyze_pattern() {
  close();
  const SymmetricPattern& p = pattern();
  // Entries of one row or column in turn, counted from 1 as Fortran does.
  row_.resize(p.row.size());
  column_.resize(p.row.size());
  for (Index c = 0; c < p.size; ++c) {
    for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
      row_[static_cast<std::size_t>(k)] = p.row[static_cast<std::size_t>(k)] + 1;
      column_[static_cast<std::size_t>(k)] = c + 1;
    }
  }
  if (two_triangles()) {
    // Entries named twice are added up, so the zeros on the second diagonal do no harm.
    const auto row = row_, column = column_;
    row_.insert(row_.end(), column.begin(), column.end());
    column_.insert(column_.end(), row.begin(), row.end());
  }

  mumps_ = {};
  mumps_.sym = two_triangles() ? 0 : 2;
  mumps_.par = 1;
  mumps_.comm_fortran = use_communicator_of_all;
  call(job_start);
  if (infog(1) < 0) return failure("its start");
  open_ = true;
  for (int i = 1; i <= 4; ++i) icntl(i) = 0;  // no printing
  icntl(5) = 0;                               // assembled matrix
  icntl(6) = 0;                               // no column permutation: it would undo the symmetry of ours
  icntl(8) = options_.scaling ? 77 : 0;
  icntl(10) = 0;  // we refine ourselves, against the caller's values
  icntl(12) =
      1;  // no compressed ordering: pairing rows beforehand costs more fill than the pivoting it saves
  icntl(13) = 1;  // no root front apart, whose pivots would be missing from the inertia
  icntl(14) = 30;
  icntl(24) = 1;  // find null pivots instead of dividing by rounding noise
  cntl(1) = options_.pivot_threshold;
  cntl(3) = options_.singular_threshold;

  mumps_.n = p.size;
  mumps_.nnz = static_cast<MUMPS_INT8>(row_.size());
  mumps_.irn = row_.data();
  mumps_.jcn = column_.data();
  // Without groups there is nothing that keeps a zero diagonal behind its neighbors; MUMPS has means of its
  // own.
  if (options_.own_ordering >= 0 || p.group.empty()) {
    icntl(7) = options_.own_ordering >= 0 ? options_.own_ordering : 7;
    if (p.group.empty()) icntl(12) = 0;
    call(job_analyze);
  } else if (options_.ordering != OrderingMethod::best) {
    analyze_with(order_unknowns(p, options_.ordering));
  } else {
    Ordering best;
    double fewest = std::numeric_limits<double>::infinity();
    OrderingMethod last = OrderingMethod::as_given;
    for (const auto method : {OrderingMethod::metis, OrderingMethod::amf, OrderingMethod::pord}) {
      // It would be METIS once more, on all unknowns and in vain: half of the analysis of a small system.
      if (method == OrderingMethod::pord && p.size < kSmallestForPord) continue;
      Ordering ordering = order_unknowns(p, method);
      if (ordering.method != method) continue;
      analyze_with(ordering);
      if (infog(1) < 0) return failure("the analysis");
      last = method;
      if (mumps_.rinfog[0] < fewest) {
        fewest = mumps_.rinfog[0];
        best = std::move(ordering);
      }
    }
    if (best.position.empty()) best = order_unknowns(p, OrderingMethod::amd);
    // A graph too small for any of the methods has not been analyzed at all so far.
    if (best.method != last || last == OrderingMethod::as_given) analyze_with(best);
  }
  if (infog(1) < 0) return failure("the analysis");
  FactorReport report;
  report.factor_nonzeros = infog(3) < 0 ? -std::int64_t{infog(3)} * 1000000 : infog(3);
  report.memory = 1e6 * infog(16);
  return report;
}

void MumpsSolver::analyze_with(const Ordering& ordering) {
  position_.resize(ordering.position.size());
  for (std::size_t i = 0; i < position_.size(); ++i) position_[i] = ordering.position[i] + 1;
  icntl(7) = 1;
  mumps_.perm_in = position_.data();
  call(job_analyze);
}

FactorReport MumpsSolver::factor_values() {
  mumps_.a = const_cast<double*>(values().data());
  if (norm() == 0) {
    FactorReport report;
    report.status = FactorStatus::singular;
    report.message = "the matrix is zero";
    return report;
  }
  // Pivoting may need more room than the analysis foresaw. What was enough once is kept for the factors to
  // come.
  call(job_factor);
  while ((infog(1) == -8 || infog(1) == -9) && icntl(14) < 3000) {
    icntl(14) = 2 * icntl(14) + 20;
    call(job_factor);
  }
  if (infog(1) < 0) return failure("the factorization");
  FactorReport report;
  report.negative_pivots = two_triangles() ? -1 : infog(12);
  report.factor_nonzeros = infog(9) < 0 ? -std::int64_t{infog(9)} * 1000000 : infog(9);
  if (infog(28) > 0) {
    report.status = FactorStatus::singular;
    report.message = "the matrix is numerically singular: " + std::to_string(infog(28)) + " null pivots";
  }
  return report;
}

bool MumpsSolver::apply_inverse(std::span<double> x) {
  mumps_.rhs = x.data();
  mumps_.nrhs = 1;
  mumps_.lrhs = mumps_.n;
  call(job_solve);
  return infog(1) >= 0;
}

}  // namespace

std::unique_ptr<LinearSolver> make_mumps_solver(const MumpsOptions& options) {
  return std::make_unique<MumpsSolver>(options);
}

bool mumps_graph_ordering(std::span<const Index> start, std::span<const Index> neighbor,
                          OrderingMethod method, std::vector<Index>& position) {
  const Index n = static_cast<Index>(start.size()) - 1;
  // Where all are neighbors there is nothing to order.
  if (neighbor.size() == at(n) * at(n - 1)) return false;
  if (method == OrderingMethod::pord && n < kSmallestForPord) return false;
  std::vector<MUMPS_INT> row, column;
  for (Index i = 0; i < n; ++i) {
    row.push_back(i + 1);
    column.push_back(i + 1);
    for (Index k = start[at(i)]; k < start[at(i) + 1]; ++k) {
      if (neighbor[at(k)] <= i) continue;
      row.push_back(neighbor[at(k)] + 1);
      column.push_back(i + 1);
    }
  }
  // All memory of our own is taken before there is an instance that must be ended.
  position.resize(at(n));
  std::vector<std::uint8_t> seen(at(n), 0);
  DMUMPS_STRUC_C graph{};
  const std::lock_guard lock(mumps_mutex());
  const auto run = [&](int job) {
    graph.job = job;
    dmumps_c(&graph);
  };
  graph.sym = 2;
  graph.par = 1;
  graph.comm_fortran = use_communicator_of_all;
  run(job_start);
  if (graph.infog[0] < 0) return false;
  for (int i = 0; i < 4; ++i) graph.icntl[i] = 0;  // no printing
  graph.icntl[5] = 0;                              // no column permutation
  graph.icntl[6] = method == OrderingMethod::pord ? 4 : 2;
  graph.icntl[11] = 1;  // no compression
  graph.n = n;
  graph.nnz = static_cast<MUMPS_INT8>(row.size());
  graph.irn = row.data();
  graph.jcn = column.data();
  run(job_analyze);
  bool ok = graph.infog[0] >= 0 && graph.sym_perm != nullptr;
  if (ok) {
    for (Index i = 0; i < n; ++i) position[at(i)] = graph.sym_perm[i] - 1;
    for (const Index k : position) {
      ok = ok && k >= 0 && k < n && !seen[at(k)];
      if (ok) seen[at(k)] = 1;
    }
  }
  run(job_end);
  return ok;
}

std::string mumps_version() {
  return MUMPS_VERSION;
}

}  // namespace isochor

#else

namespace isochor {

std::unique_ptr<LinearSolver> make_mumps_solver(const MumpsOptions&) {
  return nullptr;
}
bool mumps_graph_ordering(std::span<const Index>, std::span<const Index>, OrderingMethod,
                          std::vector<Index>&) {
  return false;
}
std::string mumps_version() {
  return {};
}

}  // namespace isochor

#endif
