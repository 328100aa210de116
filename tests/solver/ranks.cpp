// A system that is shared out over ranks against the engine alone. Here ranks are threads, and a dense solver
// puts the matrix together from what they hold, so that what the engine has to do with ranks is tested
// without MPI.
#include <Eigen/Core>
#include <barrier>
#include <thread>

#include "engine/base/base.h"
#include "engine/solvers/linear_solver.h"
#include "engine/system/assembly.h"
#include "support/compiled.h"
#include "support/dense.h"
#include "support/worlds.h"

using namespace test;
using isochor::at;
using isochor::norm;
using isochor::World;

namespace {

// What threads that are ranks of each other have in common.
struct Table {
  explicit Table(int size) : all_are_here(size), part(static_cast<std::size_t>(size)) {}
  std::barrier<> all_are_here;
  std::vector<std::vector<double>> part;
};

class ThreadRanks final : public isochor::Ranks {
 public:
  ThreadRanks(Table& table, int rank) : table_(table), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(table_.part.size()); }
  void sum(std::span<double> values) const override {
    const auto& parts = show(values);
    std::fill(values.begin(), values.end(), 0.0);
    for (const auto& part : parts) {
      for (std::size_t i = 0; i < values.size(); ++i) values[i] += part[i];
    }
    table_.all_are_here.arrive_and_wait();
  }
  void gather(std::span<double> values, std::span<const std::int64_t> begin) const override {
    const auto& parts = show(values);
    for (std::size_t r = 0; r < parts.size(); ++r)
      std::copy(parts[r].begin() + begin[r], parts[r].begin() + begin[r + 1], values.begin() + begin[r]);
    table_.all_are_here.arrive_and_wait();
  }
  std::unique_ptr<isochor::LinearSolver> linear_solver(isochor::Solver kind, bool) const override;

 private:
  const std::vector<std::vector<double>>& show(std::span<const double> values) const {
    table_.part[static_cast<std::size_t>(rank_)].assign(values.begin(), values.end());
    table_.all_are_here.arrive_and_wait();
    return table_.part;
  }
  Table& table_;
  int rank_;
};

// Of symmetric matrices, and of unsymmetric ones, whose transposed upper triangle follows the lower one.
class DenseSolver final : public isochor::LinearSolver {
 public:
  explicit DenseSolver(const isochor::Ranks& ranks) : ranks_(ranks) {}
  std::string_view name() const override { return "dense"; }
  isochor::FactorReport analyze(const isochor::SymmetricPattern& pattern) override {
    pattern_ = &pattern;
    return {};
  }
  isochor::FactorReport factor(std::span<const double> values) override {
    const Index n = pattern_->size;
    const auto entries = static_cast<std::size_t>(pattern_->nonzeros());
    matrix_.setZero(n, n);
    for (Index c = 0; c < n; ++c) {
      for (auto k = pattern_->column_start[at(c)]; k < pattern_->column_start[at(c) + 1]; ++k) {
        const Index r = pattern_->row[static_cast<std::size_t>(k)];
        matrix_(c, r) = values[values.size() - entries + static_cast<std::size_t>(k)];
        matrix_(r, c) = values[static_cast<std::size_t>(k)];
      }
    }
    ranks_.sum({matrix_.data(), at(n) * at(n)});
    isochor::FactorReport report;
    report.negative_pivots = values.size() > entries ? -1 : test::negative_eigenvalues(matrix_);
    inverse_ = test::inverse(matrix_);
    return report;
  }
  isochor::SolveReport solve(std::span<const double> b, std::span<double> x) override {
    const auto n = static_cast<Eigen::Index>(b.size());
    Eigen::Map<Eigen::VectorXd>(x.data(), n) = inverse_ * Eigen::Map<const Eigen::VectorXd>(b.data(), n);
    return {true, 1e-15, 0};
  }
  bool precondition(std::span<double> x) override {
    const std::vector<double> b(x.begin(), x.end());
    return solve(b, x).ok;
  }

 private:
  const isochor::Ranks& ranks_;
  const isochor::SymmetricPattern* pattern_ = nullptr;
  Eigen::MatrixXd matrix_, inverse_;
};

std::unique_ptr<isochor::LinearSolver> ThreadRanks::linear_solver(isochor::Solver, bool) const {
  return std::make_unique<DenseSolver>(*this);
}

struct Outcome {
  std::vector<Vec3> x;
  std::string refusal, reason;
  std::uint64_t hash = 0;
  int iterations = 0;
  std::size_t slots = 0;
  std::vector<double> energies;
};

using Build = std::function<void(World&)>;

// No assertions: threads have none.
Outcome run(const isochor::WorldOptions& options, const Build& build, double h, int steps,
            std::shared_ptr<const isochor::Ranks> ranks) {
  Outcome out;
  isochor::Host host;
  host.ranks = std::move(ranks);
  auto made = World::create(options, host);
  if (!made) {
    out.refusal = made.error();
    return out;
  }
  World world = std::move(made).value();
  build(world);
  if (auto r = world.compile(); !r) {
    out.refusal = r.error();
    return out;
  }
  for (int s = 0; s < steps; ++s) {
    const isochor::StepReport report = world.advance(h);
    out.iterations += report.iterations;
    if (report.status != isochor::StepStatus::converged) out.reason = report.reason;
    const isochor::Energies e = world.energies();
    for (const double v : {e.elastic, e.kinetic, e.loads, e.pressures}) out.energies.push_back(v);
  }
  for (const isochor::BodyId body : world.bodies()) {
    const auto x = world.positions(body);
    out.x.insert(out.x.end(), x.begin(), x.end());
  }
  out.hash = world.state_hash();
  out.slots = world.size().engine_bytes;
  return out;
}

std::vector<Outcome> run_on(int size, const isochor::WorldOptions& options, const Build& build, double h,
                            int steps) {
  Table table(size);
  std::vector<Outcome> outcomes(static_cast<std::size_t>(size));
  std::vector<std::thread> threads;
  for (int r = 0; r < size; ++r) {
    threads.emplace_back([&, r] {
      outcomes[static_cast<std::size_t>(r)] =
          run(options, build, h, steps, std::make_shared<ThreadRanks>(table, r));
    });
  }
  for (std::thread& t : threads) t.join();
  return outcomes;
}

// `most`: slots that a rank may have, of those of one process. Two layers of cells of a small block are
// border.
void compare(const isochor::WorldOptions& options, const Build& build, double h, int steps, double length,
             double most = 0.85) {
  const Outcome alone = run(options, build, h, steps, nullptr);
  REQUIRE(alone.refusal + alone.reason == "");
  for (const int size : {1, 2, 3}) {
    const std::vector<Outcome> shared = run_on(size, options, build, h, steps);
    for (const Outcome& rank : shared) {
      INFO(size << " ranks, slots " << rank.slots << " of " << alone.slots);
      REQUIRE(rank.refusal + rank.reason == "");
      CHECK(rank.hash == shared[0].hash);
      CHECK(std::abs(rank.iterations - alone.iterations) <= steps);
      double largest = 0;
      for (std::size_t i = 0; i < alone.x.size(); ++i)
        largest = std::max(largest, norm(rank.x[i] - alone.x[i]));
      CHECK(largest <= 1e-9 * length);
      for (std::size_t k = 0; k < alone.energies.size(); ++k)
        CHECK(rank.energies[k] == Approx(alone.energies[k]).epsilon(1e-7).margin(1e-9));
      if (size > 1) CHECK(static_cast<double>(rank.slots) < most * static_cast<double>(alone.slots));
    }
  }
}

}  // namespace

TEST_CASE("a pressed block on ranks is that of one process, whatever the element and its rows") {
  const auto with = [](isochor::Element element, isochor::VolumeSpace space, double poisson,
                       isochor::CellType type = isochor::CellType::tet4) {
    return [=](World& world) {
      const isochor::BodyId body = add_body(world, block({0, 0, 0}, {0.2, 0.1, 0.1}, {6, 2, 2}, type),
                                            element, neo_hookean(1e5, poisson));
      add_volume(world, body, space);
      hold(world, body, {"x0"});
      hold(world, body, {"x1"}, {}, {-0.03, 0.01, 0});
    };
  };
  isochor::WorldOptions options = static_options();
  using isochor::Element;
  using isochor::VolumeSpace;
  compare(options, with(Element::tet4, VolumeSpace::node, 0.5), 0.5, 2, 0.25);
  compare(options, with(Element::tet4_edge_smoothed, VolumeSpace::node, 0.5), 0.5, 2, 0.25);
  compare(options, with(Element::hex8, VolumeSpace::element, 0.5, isochor::CellType::hex8), 0.5, 2, 0.25);
  // Condensed, and one row over all of it that is bordered.
  compare(options, with(Element::tet4, VolumeSpace::element, 0.4), 0.5, 2, 0.25);
  const auto bordered = [](World& world) {
    const isochor::BodyId body =
        add_body(world, block({0, 0, 0}, {0.2, 0.1, 0.1}, {6, 2, 2}), Element::tet4, neo_hookean(1e5, 0.45));
    isochor::VolumeDef whole;
    whole.body = body;
    whole.space = VolumeSpace::body;
    whole.treatment = isochor::RowTreatment::bordered;
    value(world.add(isochor::volume(whole)));
    hold(world, body, {"x0"});
    hold(world, body, {"x1"}, {}, {-0.03, 0.01, 0});
  };
  compare(options, bordered, 0.5, 2, 0.25);
}

TEST_CASE("a thrown block with a consistent mass matrix falls on ranks as on one process") {
  isochor::WorldOptions options = dynamic_options();
  options.consistent_mass = true;
  options.gravity = {1, 0, -9.8};
  compare(
      options,
      [](World& world) {
        const isochor::BodyId body = add_body(world, block({0, 0, 0}, {0.2, 0.1, 0.1}, {6, 2, 2}),
                                              isochor::Element::tet4, neo_hookean(1e5, 0.5));
        add_volume(world, body);
        hold(world, body, {"x0"});
      },
      0.01, 3, 0.25);
}

TEST_CASE("blocks that rub each other do so on ranks as on one process, with the same bits on all ranks") {
  const auto sheared = [](isochor::FrictionCoupling coupling) {
    return [=](World& world) {
      const auto material = neo_hookean(1e5, 0.3);
      const isochor::BodyId low = add_body(world, block({0, 0, 0}, {1, 1, 0.5}, {3, 3, 2}),
                                           isochor::Element::tet4, material, 1000, "lower");
      const isochor::BodyId high = add_body(world, block({0.1, 0.13, 0.5}, {0.9, 0.9, 1}, {4, 3, 2}),
                                            isochor::Element::tet4, material, 1000, "upper");
      hold(world, low, {"z0"});
      hold(world, high, {"z1"}, {}, {0.06, 0.01, -0.05});
      isochor::SurfaceContactDef touch;
      touch.body = low;
      touch.surfaces = {"z1"};
      touch.against = high;
      touch.against_surfaces = {"z0"};
      touch.friction = 0.4;
      touch.coupling = coupling;
      value(world.add(isochor::surface_contact(touch)));
    };
  };
  // Contact is evaluated by all.
  for (const auto coupling : {isochor::FrictionCoupling::lagged, isochor::FrictionCoupling::coupled})
    compare(static_options(), sheared(coupling), 0.25, 4, 1.7, 1);
}

TEST_CASE("what is not shared out over ranks is refused on all of them, by name") {
  isochor::WorldOptions options = static_options();
  options.method = isochor::Method::augmented_gradients;
  const std::vector<Outcome> refused = run_on(
      2, options,
      [](World& world) {
        const isochor::BodyId body = add_body(world, block({0, 0, 0}, {0.2, 0.1, 0.1}, {2, 1, 1}),
                                              isochor::Element::tet4, neo_hookean(1e5, 0.5));
        add_volume(world, body);
        hold(world, body, {"x0"});
      },
      1, 1);
  for (const Outcome& rank : refused) {
    CHECK_THAT(rank.refusal,
               ContainsSubstring("augmented_gradients") && ContainsSubstring("run on one process"));
  }
}

namespace {

// All that an assembly adds up, in one list.
std::vector<double> sums_of(std::shared_ptr<const isochor::System> system) {
  const isochor::TbbParallel parallel(1);
  isochor::Assembly assembly(system, parallel);
  const auto& rest = system->parts().rest;
  std::vector<Vec3> x(rest), v(rest.size()), nodes(rest.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double k = static_cast<double>(i);
    x[i] += 0.004 * Vec3{std::sin(k), std::cos(3 * k), std::sin(2 * k)};
    v[i] = {std::cos(k), std::sin(5 * k), 1};
  }
  std::vector<double> lambda(at(system->rows())), prescribed(at(system->prescribed_rows())),
      rows(lambda.size()), numbers(x.size());
  for (std::size_t r = 0; r < lambda.size(); ++r) lambda[r] = 1e3 * std::sin(static_cast<double>(r));
  assembly.evaluate(isochor::Want::hessian, isochor::Definiteness::exact, x, lambda, prescribed);
  std::vector<double> out{assembly.energy(), assembly.absolute_energy()};
  const auto put_rows = [&] { out.insert(out.end(), rows.begin(), rows.end()); };
  const auto put_nodes = [&] {
    for (const Vec3& n : nodes) out.insert(out.end(), {n.x, n.y, n.z});
  };
  assembly.row_values(rows);
  put_rows();
  assembly.jacobian_times(v, rows);
  put_rows();
  assembly.residual(nodes);
  put_nodes();
  assembly.constraint_force(lambda, nodes);
  put_nodes();
  assembly.hessian_times(v, nodes);
  put_nodes();
  assembly.mass_times(v, nodes);
  put_nodes();
  for (const auto magnitude :
       {&isochor::Assembly::residual_magnitude, &isochor::Assembly::stiffness_diagonal}) {
    (assembly.*magnitude)(numbers);
    out.insert(out.end(), numbers.begin(), numbers.end());
  }
  return out;
}

}  // namespace

TEST_CASE("what an assembly adds up is the same on every rank as on one process") {
  for (const auto space :
       {isochor::VolumeSpace::node, isochor::VolumeSpace::element, isochor::VolumeSpace::body}) {
    CAPTURE(static_cast<int>(space));
    isochor::BodyDef body;
    body.mesh = block({0, 0, 0}, {0.2, 0.1, 0.1}, {6, 2, 2});
    body.element = isochor::Element::tet4;
    body.materials = {{"", neo_hookean(1e5, 0.45), 1000}};
    isochor::VolumeDef volume;
    volume.space = space;
    isochor::MembraneDef skin;
    skin.surfaces = {"z1"};
    skin.young = 1e5;
    skin.thickness = 1e-3;
    const Compiled alone = compile({body}, {isochor::volume(volume), isochor::membrane(skin)});
    REQUIRE(alone.error.empty());
    const std::vector<double> wanted = sums_of(alone.system);
    for (const int size : {2, 3}) {
      Table table(size);
      std::vector<std::vector<double>> found(static_cast<std::size_t>(size));
      std::vector<std::thread> threads;
      for (int r = 0; r < size; ++r) {
        threads.emplace_back([&, r] {
          isochor::SystemParts parts = alone.system->parts();
          parts.ranks = std::make_shared<ThreadRanks>(table, r);
          auto shared = isochor::System::compile(std::move(parts));
          if (shared) found[static_cast<std::size_t>(r)] = sums_of(shared.value());
        });
      }
      for (std::thread& t : threads) t.join();
      for (const auto& rank : found) {
        REQUIRE(rank.size() == wanted.size());
        for (std::size_t i = 0; i < wanted.size(); ++i) {
          if (std::abs(rank[i] - wanted[i]) > 1e-10 * (1 + std::abs(wanted[i])))
            FAIL(size << " ranks, number " << i << ": " << rank[i] << ", not " << wanted[i]);
        }
      }
    }
  }
}
