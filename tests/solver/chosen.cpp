// What `automatic` takes: factors while they fit, iterations beyond that, and the other one after a failure.
#include <cmath>

#include "engine/solvers/chosen_solver.h"
#include "engine/solvers/foreign/eigen_solver.h"
#include "engine/solvers/iterative/iterative_solver.h"
#include "solver/linear_support.h"
#include "support/worlds.h"

namespace {

using namespace isochor;
using test::Matrix;

// A solver that fails as it is told.
class Failing final : public LinearSolver {
 public:
  Failing(std::unique_ptr<LinearSolver> real, FactorStatus status, bool solves)
      : real_(std::move(real)), status_(status), solves_(solves) {}
  std::string_view name() const override { return "failing"; }
  FactorReport analyze(const SymmetricPattern& p) override { return real_->analyze(p); }
  FactorReport factor(std::span<const double> values) override {
    FactorReport report = real_->factor(values);
    report.status = status_;
    return report;
  }
  SolveReport solve(std::span<const double> b, std::span<double> x) override {
    SolveReport report = real_->solve(b, x);
    report.ok = solves_;
    return report;
  }

 private:
  std::unique_ptr<LinearSolver> real_;
  FactorStatus status_;
  bool solves_;
};

std::unique_ptr<LinearSolver> failing(FactorStatus status, bool solves) {
  return std::make_unique<Failing>(make_eigen_solver(), status, solves);
}

struct Solved {
  std::string name, reason;
  double error = 0;
  bool ok = false;
};

Solved solve(ChosenSolver& solver) {
  const test::Matrix a = test::saddle({150, 40, false, 0.1, 0});
  std::vector<double> x(at(a.pattern.size)), exact(at(a.pattern.size));
  for (std::size_t i = 0; i < exact.size(); ++i) exact[i] = std::sin(1.0 + static_cast<double>(i));
  const Eigen::VectorXd product = a.dense() * Eigen::Map<const Eigen::VectorXd>(exact.data(), a.pattern.size);
  const std::vector<double> b(product.data(), product.data() + product.size());
  Solved out;
  REQUIRE(solver.analyze(a.pattern).status == FactorStatus::ok);
  const FactorReport factored = solver.factor(a.values);
  INFO(factored.message);
  REQUIRE(factored.status == FactorStatus::ok);
  out.ok = solver.solve(b, x).ok;
  for (std::size_t i = 0; i < x.size(); ++i) out.error = std::max(out.error, std::abs(x[i] - exact[i]));
  out.name = solver.name();
  out.reason = solver.reason();
  return out;
}

}  // namespace

TEST_CASE("factors are taken while they fit, iterations beyond") {
  {
    ChosenSolver solver(make_eigen_solver(), make_iterative_solver(), {});
    const Solved s = solve(solver);
    CHECK(s.ok);
    CHECK(s.name == "eigen");
    CHECK(s.error < 1e-8);
  }
  {
    ChosenSolver solver(make_eigen_solver(), make_iterative_solver(), {.memory = 1});
    const Solved s = solve(solver);
    CHECK(s.ok);
    CHECK(s.name == "iterative");
    CHECK(s.reason.find("GiB") != std::string::npos);
    CHECK(s.error < 1e-5);
  }
  {
    ChosenSolver solver(make_eigen_solver(), make_iterative_solver(), {.prefer_iterative = true});
    CHECK(solve(solver).name == "iterative");
  }
}

TEST_CASE("one solver takes over from the other") {
  {
    ChosenSolver solver(failing(FactorStatus::out_of_memory, true), make_iterative_solver(), {});
    const Solved s = solve(solver);
    CHECK(s.ok);
    CHECK(s.name == "iterative");
    CHECK(s.reason.find("ran out") != std::string::npos);
  }
  {
    ChosenSolver solver(make_eigen_solver(), failing(FactorStatus::ok, false), {.prefer_iterative = true});
    const Solved s = solve(solver);
    CHECK(s.ok);
    CHECK(s.name == "eigen");
    CHECK(s.error < 1e-8);
    CHECK(s.reason.find("failed") != std::string::npos);
  }
  {
    // Nothing is left: a failure, not a loop.
    ChosenSolver solver(make_eigen_solver(), failing(FactorStatus::ok, false), {.memory = 1});
    CHECK_FALSE(solve(solver).ok);
  }
}

TEST_CASE("a large body in motion is iterated, at rest it is factored") {
  CHECK(memory_for_factors() > 1e8);
  BoxMeshDef box;
  box.divisions = {27, 27, 27};
  for (const bool moves : {true, false}) {
    WorldOptions options = moves ? test::dynamic_options() : test::static_options();
    options.gravity = {0, 0, -9.81};
    World world = test::make_world(options);
    const BodyId body =
        test::add_body(world, test::value(box_mesh(box)), Element::tet4, test::neo_hookean(100e3, 0.5), 1000);
    test::add_volume(world, body);
    test::hold(world, body, {"x0"});
    if (moves) {
      const StepReport r = world.step(1e-3);
      INFO(r.reason);
      CHECK(r.status == StepStatus::converged);
      CHECK(r.krylov.iterations > 0);
      CHECK(r.row_residual < 1e-10);
    }
    INFO(world.method());
    CHECK((world.method().find("iterative") != std::string::npos) == moves);
  }
}
