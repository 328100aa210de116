// Two levels in place of factors: the equilibria of factors, on meshes and loads that nobody chose; an
// inertia that is told or looked for; and factors where it is not for two levels.
#include <cmath>
#include <random>

#include "engine/solvers/two_level/two_level_solver.h"
#include "solver/linear_support.h"
#include "support/compiled.h"
#include "support/dense.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

// Whatever the size.
constexpr TwoLevelChoice always{.pays = 0, .from = 0};

std::unique_ptr<LinearSolver> factors() {
  return make_linear_solver(Solver::multifrontal);
}

// Keeps what it is given.
class Recorder final : public LinearSolver {
 public:
  struct Record {
    SymmetricPattern pattern;
    std::vector<UnknownGeometry> geometry;
    std::vector<double> values, scale;
  };
  explicit Recorder(Record& record) : record_(record), real_(factors()) {}
  std::string_view name() const override { return "recorder"; }
  bool wants_geometry() const override { return true; }
  void set_geometry(std::vector<UnknownGeometry> g) override { record_.geometry = std::move(g); }
  void set_scale(std::span<const double> s) override { record_.scale.assign(s.begin(), s.end()); }
  FactorReport analyze(const SymmetricPattern& p) override {
    record_.pattern = p;
    return real_->analyze(p);
  }
  FactorReport factor(std::span<const double> v) override {
    record_.values.assign(v.begin(), v.end());
    return real_->factor(v);
  }
  SolveReport solve(std::span<const double> b, std::span<double> x) override { return real_->solve(b, x); }

 private:
  Record& record_;
  std::unique_ptr<LinearSolver> real_;
};

struct Case {
  test::Compiled scene;
  std::vector<Vec3> weight;
};

// A box or a hollow one, bent and numbered at random, held at one side and led along the other or not.
Case random_case(unsigned seed, double poisson, bool hollow) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uniform_int_distribution<int> few(2, 4);
  Mesh mesh = hollow ? test::hollow_box(false, CellType::tet4)
                     : test::box({few(random) + 1, few(random), few(random)}, {1.5, 1, 1});
  mesh = to_tet10(mesh);
  const Vec3 a{unit(random), unit(random), unit(random)}, b{unit(random), unit(random), unit(random)};
  mesh = test::mapped(mesh, [&](const Vec3& p) {
    return p + 0.05 * std::sin(2 * dot(a, p)) * b + 0.03 * std::cos(3 * dot(b, p)) * a;
  });
  std::vector<Index> place;
  BodyDef body;
  body.name = "body";
  body.mesh = test::shuffled(mesh, seed, place);
  body.element = Element::tet10;
  body.materials = {{"", test::neo_hookean(1e4, poisson), 1000}};
  std::vector<EffectPtr> effects;
  const BodyId id{0};
  VolumeDef rows;
  rows.body = id;
  effects.push_back(volume(rows));
  const auto hold = [&](const char* surface, std::vector<Vec3> directions, Vec3 way) {
    DirichletDef def;
    def.name = std::string("hold ") + surface;
    def.where.body = id;
    def.where.surfaces = {surface};
    def.directions = std::move(directions);
    def.displacement = way;
    effects.push_back(dirichlet(def));
  };
  hold("x0", {}, {});
  if (random() % 2 == 0) hold("x1", {Vec3{1, 0.3 * unit(random), 0}}, {0.05 * unit(random), 0, 0});
  if (hollow) {
    CavityDef chamber;
    chamber.body = id;
    chamber.surfaces = {"chamber"};
    chamber.control = random() % 2 == 0 ? CavityControl::pressure : CavityControl::volume;
    chamber.amount = Curve::ramp(chamber.control == CavityControl::pressure ? 500 : 1.2);
    if (chamber.control == CavityControl::volume) chamber.amount = Curve::constant(1.05);
    effects.push_back(cavity(chamber));
  }
  Case out{test::compile({body}, effects, true), {}};
  INFO(out.scene.error);
  REQUIRE(out.scene.system);
  const double strength = seed % 2 == 0 ? 8 : 2;
  const Vec3 pull{strength * unit(random), strength * unit(random), strength * unit(random)};
  for (const double m : out.scene.system->parts().mass) out.weight.push_back(m * pull);
  return out;
}

struct Solved {
  SaddleReport report;
  std::vector<Vec3> x;
  std::vector<double> lambda;
  std::string reason;
  bool two_levels = false, at_work = false;
};

Solved solve(const Case& c, std::unique_ptr<LinearSolver> solver, int threads = 1, double mass_scale = 0) {
  const System& s = *c.scene.system;
  const TbbParallel parallel{threads};
  Newton newton(c.scene.system, parallel, std::move(solver));
  test::ProblemData data(s);
  data.at_time(s, 1);
  data.mass_scale = mass_scale;
  for (std::size_t i = 0; i < c.weight.size(); ++i) data.force[i] += c.weight[i];
  Solved out;
  out.x = s.parts().rest;
  out.lambda.assign(at(s.rows()), 0);
  out.report = newton.solve(data.problem(), {}, out.x, out.lambda);
  out.reason = newton.linear_solver().reason();
  if (const auto* two = dynamic_cast<const TwoLevelSolver*>(&newton.linear_solver())) {
    out.two_levels = two->two_levels();
    out.at_work = two->at_work();
  }
  return out;
}

double distance(const Solved& a, const Solved& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const Vec3 d = a.x[i] - b.x[i];
    most = std::max(most, std::sqrt(dot(d, d)));
  }
  return most;
}

double pressure_distance(const Solved& a, const Solved& b) {
  double most = 0, size = 0;
  for (std::size_t r = 0; r < a.lambda.size(); ++r) {
    most = std::max(most, std::abs(a.lambda[r] - b.lambda[r]));
    size = std::max(size, std::abs(a.lambda[r]));
  }
  return most / size;
}

// The matrix at the start of a case.
Recorder::Record record_of(const Case& c) {
  Recorder::Record record;
  const System& s = *c.scene.system;
  const TbbParallel parallel{1};
  Kkt kkt(c.scene.system, parallel, std::make_unique<Recorder>(record));
  Assembly assembly(c.scene.system, parallel);
  const std::vector<double> none(at(s.rows()), 0.0), given(at(s.prescribed_rows()), 0.0);
  assembly.evaluate(Want::hessian, Definiteness::exact, s.parts().rest, none, given);
  const std::vector<double> stiffness(at(s.nodes()), 1.0);
  Kkt::Values values;
  values.stiffness = stiffness;
  StageSeconds seconds;
  REQUIRE(kkt.factor(assembly, values, seconds).status == FactorStatus::ok);
  return record;
}

std::unique_ptr<TwoLevelSolver> two_levels_for(const Recorder::Record& r,
                                               const TwoLevelChoice& choice = always) {
  auto solver = std::make_unique<TwoLevelSolver>(factors(), choice);
  solver->set_geometry(r.geometry);
  REQUIRE(solver->analyze(r.pattern).status == FactorStatus::ok);
  solver->begin_solve();
  solver->set_scale(r.scale);
  return solver;
}

Eigen::MatrixXd dense(const Recorder::Record& r) {
  return test::Matrix{r.pattern, r.values}.dense();
}

}  // namespace

TEST_CASE("two levels arrive where factors do, on random meshes, materials, supports and chambers") {
  int seen = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    for (const double poisson : {0.3, 0.45, 0.4999, 0.5}) {
      const bool hollow = seed % 3 == 0;
      INFO("seed " << seed << ", nu " << poisson << ", hollow " << hollow);
      const Case c = random_case(seed, poisson, hollow);
      const Solved direct = solve(c, factors());
      const Solved two = solve(c, make_two_level_solver(factors(), always));
      INFO(two.reason << "; " << two.report.message);
      REQUIRE(direct.report.status == SaddleStatus::converged);
      REQUIRE(two.report.status == SaddleStatus::converged);
      CHECK(two.two_levels);
      CHECK(two.report.krylov.iterations > 0);
      CHECK(two.report.iterations <= direct.report.iterations + direct.report.iterations / 2 + 3);
      CHECK(distance(direct, two) < 1e-8);
      CHECK(pressure_distance(direct, two) < 1e-6);
      seen += two.at_work ? 1 : 0;
    }
  }
  CHECK(seen >= 22);  // of 24: factors take over rarely
}

TEST_CASE("a step of dynamics by two levels ends where one by factors does") {
  const Case c = random_case(4, 0.5, false);
  const Solved direct = solve(c, factors(), 1, 1e4);
  const Solved two =
      solve(c, make_two_level_solver(factors(), {.pays = 0, .from = 0, .confirm = false}), 1, 1e4);
  REQUIRE(direct.report.status == SaddleStatus::converged);
  REQUIRE(two.report.status == SaddleStatus::converged);
  CHECK(two.at_work);
  CHECK(distance(direct, two) < 1e-9);
}

TEST_CASE("two levels give the same bits at any thread count") {
  BodyDef body;
  body.name = "body";
  body.mesh = to_tet10(test::box({9, 6, 6}));
  body.element = Element::tet10;
  body.materials = {{"", test::neo_hookean(1e4, 0.5), 1000}};
  VolumeDef rows;
  rows.body = BodyId{0};
  DirichletDef held;
  held.where.body = BodyId{0};
  held.where.surfaces = {"x0"};
  Case c{test::compile({body}, {volume(rows), dirichlet(held)}, true), {}};
  REQUIRE(c.scene.system);
  for (const double m : c.scene.system->parts().mass) c.weight.push_back(m * Vec3{0, 0, -3});
  const Solved one = solve(c, make_two_level_solver(factors(), always), 1);
  REQUIRE(one.report.status == SaddleStatus::converged);
  REQUIRE(one.at_work);
  for (const int threads : {2, 4}) {
    const Solved many = solve(c, make_two_level_solver(factors(), always), threads);
    CHECK(many.report.krylov.iterations == one.report.krylov.iterations);
    CHECK(std::equal(one.x.begin(), one.x.end(), many.x.begin()));
    CHECK(one.lambda == many.lambda);
  }
}

TEST_CASE(
    "the preconditioner is symmetric, has the inertia of the coarse matrix, and few iterations follow") {
  for (const double poisson : {0.3, 0.5}) {
    for (const bool hollow : {false, true}) {
      INFO("nu " << poisson << ", hollow " << hollow);
      const Recorder::Record r = record_of(random_case(7, poisson, hollow));
      auto solver = two_levels_for(r);
      REQUIRE(solver->factor(r.values).status == FactorStatus::ok);
      CHECK(solver->levels().middles() > 2 * r.pattern.size / 3 / 4);
      Eigen::MatrixXd m(r.pattern.size, r.pattern.size);
      for (Index c = 0; c < r.pattern.size; ++c) {
        std::vector<double> unit(at(r.pattern.size), 0.0);
        unit[at(c)] = 1;
        REQUIRE(solver->precondition(unit));
        m.col(c) = Eigen::Map<const Eigen::VectorXd>(unit.data(), r.pattern.size);
      }
      CHECK((m - m.transpose()).norm() < 1e-4 * m.norm());  // in single precision
      CHECK(test::negative_eigenvalues(0.5 * (m + m.transpose())) == solver->levels().rows());
      const std::vector<double> b = test::random_vector(r.pattern.size);
      std::vector<double> x(b.size());
      for (const auto& [tolerance, most] : {std::pair{1e-1, 12}, {1e-2, 20}, {1e-8, 70}}) {
        const SolveReport s = solver->solve_to(tolerance, b, x);
        INFO("tolerance " << tolerance << ", " << s.iterations << " directions");
        CHECK(s.ok);
        CHECK(solver->at_work());
        CHECK(s.iterations <= most + 30);  // the second one with a look at the inertia
        const Eigen::VectorXd right = Eigen::Map<const Eigen::VectorXd>(b.data(), r.pattern.size);
        const Eigen::VectorXd left =
            right - dense(r) * Eigen::Map<const Eigen::VectorXd>(x.data(), r.pattern.size);
        CHECK(left.norm() <= 1.02 * tolerance * right.norm());
      }
    }
  }
}

// The stiffness is made softer everywhere until it has negative eigenvalues: between the first and the second
// of them exactly one too many.
TEST_CASE("a wrong inertia is reported, or found before a second solution") {
  Index odd = 0;
  for (unsigned seed : {11u, 12u, 13u, 14u}) {
    const Case c = random_case(seed, 0.45, false);
    Recorder::Record r = record_of(c);
    const auto displacements = static_cast<Index>(r.geometry.size());
    const Index rows = r.pattern.size - displacements;
    const auto shifted = [&](double by) {
      Recorder::Record out = r;
      for (Index u = 0; u < displacements; ++u) {
        out.values[static_cast<std::size_t>(r.pattern.column_start[at(u)])] -= by;
      }
      return out;
    };
    const auto too_many = [&](double by) {
      const Recorder::Record at_shift = shifted(by);
      const auto solver = factors();
      REQUIRE(solver->analyze(at_shift.pattern).status == FactorStatus::ok);
      const FactorReport f = solver->factor(at_shift.values);
      REQUIRE(f.status == FactorStatus::ok);
      return f.negative_pivots - rows;
    };
    double low = 0, high = 1;
    REQUIRE(too_many(low) == 0);
    for (int k = 0; k < 25; ++k) (too_many(0.5 * (low + high)) > 0 ? high : low) = 0.5 * (low + high);
    for (const double part : {0.5, 0.9, 1.05, 1.1, 1.2, 1.3, 1.6, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0}) {
      const Recorder::Record s = shifted(part * high);
      const Index wrong = too_many(part * high);
      INFO("seed " << seed << ", at " << part << " of the first eigenvalue: " << wrong << " too many");
      auto solver = two_levels_for(s);
      const FactorReport f = solver->factor(s.values);
      REQUIRE(f.status == FactorStatus::ok);
      const std::vector<double> b = test::random_vector(s.pattern.size, seed);
      std::vector<double> x(b.size());
      const bool first = solver->solve_to(1e-2, b, x).ok;
      const bool second = solver->solve_to(1e-1, b, x).ok;
      const bool told = f.negative_pivots >= 0 && f.negative_pivots != rows;
      if (wrong == 0)
        CHECK((!told && first && second));
      else if (wrong % 2 == 1 || told)  // an even number may go unnoticed
        CHECK((told || !first || !second));
      odd += wrong % 2;
    }
  }
  CHECK(odd >= 6);
}

TEST_CASE("factors where two levels are not for it") {
  // Linear tets have no middles.
  BodyDef body;
  body.name = "body";
  body.mesh = test::mapped(test::box({3, 3, 3}), test::wavy);
  body.element = Element::tet4;
  body.materials = {{"", test::neo_hookean(1e4, 0.5), 1000}};
  VolumeDef rows;
  rows.body = BodyId{0};
  DirichletDef held;
  held.where.body = BodyId{0};
  held.where.surfaces = {"x0"};
  Case linear{test::compile({body}, {volume(rows), dirichlet(held)}, true), {}};
  REQUIRE(linear.scene.system);
  for (const double m : linear.scene.system->parts().mass) linear.weight.push_back(m * Vec3{0, 0, -3});
  const Solved s = solve(linear, make_two_level_solver(factors(), always));
  CHECK(s.report.status == SaddleStatus::converged);
  CHECK_FALSE(s.two_levels);
  CHECK(s.report.krylov.iterations == 0);

  // Small ones are factored, to the bit.
  const Case small = random_case(3, 0.5, true);
  const Solved plain = solve(small, factors());
  const Solved chosen = solve(small, make_two_level_solver(factors(), {}));
  CHECK_FALSE(chosen.two_levels);
  CHECK(std::equal(plain.x.begin(), plain.x.end(), chosen.x.begin()));
  CHECK(plain.lambda == chosen.lambda);
}

TEST_CASE("two levels that do not get there are followed by factors") {
  const Recorder::Record r = record_of(random_case(5, 0.5, false));
  auto solver = two_levels_for(r, {.pays = 0, .from = 0, .tolerance = 1e-30});
  REQUIRE(solver->factor(r.values).status == FactorStatus::ok);
  REQUIRE(solver->at_work());
  const std::vector<double> b = test::random_vector(r.pattern.size);
  std::vector<double> x(b.size());
  const SolveReport s = solver->solve(b, x);
  CHECK(s.ok);
  CHECK_FALSE(solver->at_work());
  CHECK(s.residual < 1e-12);
  // The next saddle point begins anew.
  solver->begin_solve();
  CHECK(solver->at_work());
  std::vector<double> bad = r.values;
  bad[5] = std::numeric_limits<double>::quiet_NaN();
  CHECK(solver->factor(bad).status == FactorStatus::not_finite);
}

// About the smallest that they are taken for.
TEST_CASE("a world takes two levels for a large body of Tet10, and ends where factors do") {
  const auto bend = [](Solver solver) {
    WorldOptions options = test::static_options();
    options.gravity = {0, 0, -9.81};
    options.solver = solver;
    World world = test::make_world(options);
    const BodyId body = test::add_body(world, to_tet10(test::box({24, 8, 8}, {0.3, 0.1, 0.1})),
                                       Element::tet10, test::neo_hookean(1e6, 0.5));
    test::add_volume(world, body);
    test::hold(world, body, {"x0"});
    const StepReport report = test::must_advance(world);
    const auto x = world.positions(body);
    return std::tuple(world.method(), report.krylov.iterations, std::vector<Vec3>(x.begin(), x.end()));
  };
  const auto [method, iterations, x] = bend(Solver::automatic);
  const auto [direct, none, y] = bend(Solver::multifrontal);
  INFO(method);
  CHECK(method.find("two_level") != std::string::npos);
  CHECK(iterations > 0);
  CHECK(none == 0);
  double most = 0;
  for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, std::sqrt(dot(x[i] - y[i], x[i] - y[i])));
  CHECK(most < 1e-9 * 0.3);
}
