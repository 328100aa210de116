// Where errors come from: refining there must pay more than refining anywhere else.
#include <cmath>
#include <numeric>
#include <random>

#include "isochor/gradients.h"
#include "support/worlds.h"

using namespace test;
using isochor::BodyId;
using isochor::Element;
using isochor::ErrorOrigin;
using isochor::Output;
using isochor::World;

namespace {

std::vector<ErrorOrigin> origins(World& world, const std::vector<Output>& outputs) {
  return value(world.error_origins(outputs));
}

double sum(const ErrorOrigin& origin) {
  double all = 0;
  for (const auto& cells : origin.cells) all = std::accumulate(cells.begin(), cells.end(), all);
  return all;
}

// A bar that is held at one end and pushed down at the other, of an incompressible or another material.
struct Bar {
  World world;
  BodyId body;
  double deflection = 0;
  Output tip() const { return Output::material_point(body, {4, 0.5, 0.5}, {0, 0, -1}); }
};

Bar bent(Mesh mesh, Element element, double poisson = 0.3) {
  Bar bar{make_world(static_options()), {}};
  bar.body = add_body(bar.world, std::move(mesh), element, neo_hookean(1e5, poisson));
  if (poisson == 0.5) add_volume(bar.world, bar.body);
  hold(bar.world, bar.body, {"x0"});
  isochor::TractionDef load;
  load.body = bar.body;
  load.surface = "x1";
  load.traction = {0, 0, -100};
  value(bar.world.add(isochor::traction(load)));
  const auto report = bar.world.advance(1);
  INFO(report.reason);
  REQUIRE(report.status == isochor::StepStatus::converged);
  const isochor::GradientQuery query{{bar.tip()}, {}, isochor::GradientQuery::Mode::adjoint, false};
  bar.deflection = value(bar.world.gradients(query)).values[0] + 0.5;
  return bar;
}

Mesh bar_mesh() {
  return block({0, 0, 0}, {4, 1, 1}, {8, 2, 2});
}

std::vector<Index> largest(const std::vector<double>& shares, std::size_t count) {
  std::vector<Index> cells(shares.size());
  std::iota(cells.begin(), cells.end(), 0);
  std::stable_sort(cells.begin(), cells.end(), [&](Index a, Index b) {
    return shares[static_cast<std::size_t>(a)] > shares[static_cast<std::size_t>(b)];
  });
  cells.resize(count);
  return cells;
}

}  // namespace

TEST_CASE("refining the cells with the largest shares pays more than refining others") {
  for (const double poisson : {0.3, 0.5}) {
    CAPTURE(poisson);
    Bar bar = bent(bar_mesh(), Element::tet4, poisson);
    const auto found = origins(bar.world, {bar.tip()});
    REQUIRE(found.at(0).by_output);
    CHECK(sum(found[0]) == Approx(1).epsilon(1e-12));
    const auto& shares = found[0].cells.at(0);
    const std::size_t count = shares.size() / 6;
    const double gain =
        bent(value(isochor::refine_cells(bar_mesh(), largest(shares, count))).mesh, Element::tet4, poisson)
            .deflection -
        bar.deflection;
    CHECK(gain > 0);
    std::mt19937 random(1);
    double others = 0;
    for (int k = 0; k < 4; ++k) {
      std::vector<Index> cells(shares.size());
      std::iota(cells.begin(), cells.end(), 0);
      std::shuffle(cells.begin(), cells.end(), random);
      cells.resize(count);
      others +=
          0.25 *
          (bent(value(isochor::refine_cells(bar_mesh(), cells)).mesh, Element::tet4, poisson).deflection -
           bar.deflection);
    }
    CAPTURE(gain, others);
    CHECK(gain > 1.2 * others);
  }
}

TEST_CASE("what an output does not feel has no share in its error") {
  World world = make_world(static_options());
  const auto material = neo_hookean(1e5, 0.3);
  std::array<BodyId, 2> body;
  for (int k = 0; k < 2; ++k) {
    const double y = 3.0 * k;
    body[static_cast<std::size_t>(k)] = add_body(world, block({0, y, 0}, {4, y + 1, 1}, {4, 1, 1}),
                                                 Element::tet10, material, 1000, k == 0 ? "first" : "second");
    hold(world, body[static_cast<std::size_t>(k)], {"x0"});
    isochor::TractionDef load;
    load.body = body[static_cast<std::size_t>(k)];
    load.surface = "x1";
    load.traction = {0, 0, -100};
    value(world.add(isochor::traction(load)));
  }
  REQUIRE(world.advance(1).status == isochor::StepStatus::converged);
  const auto found =
      origins(world, {Output::material_point(body[0], {4, 0.5, 0.5}, {0, 0, 1}), Output::elastic_energy()});
  for (const double share : found.at(0).cells.at(1)) CHECK(share == 0);
  CHECK(sum(found[0]) == Approx(1));
  // The energy of two equal bars comes from both alike.
  CHECK(std::accumulate(found[1].cells[0].begin(), found[1].cells[0].end(), 0.0) ==
        Approx(0.5).epsilon(1e-6));
}

TEST_CASE("a body at rest, or strained by the same everywhere, is in no error") {
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10}) {
    World world = make_world(static_options());
    const BodyId body =
        add_body(world, block({0, 0, 0}, {1, 1, 1}, {3, 3, 3}), element, neo_hookean(1e5, 0.3));
    CHECK(sum(origins(world, {}).at(0)) == 0);
    std::vector<Vec3> x(world.rest_positions(body).begin(), world.rest_positions(body).end());
    for (Vec3& p : x) p = {1.1 * p.x + 0.2 * p.y, 0.9 * p.y - 0.1 * p.z, p.z + 0.3 * p.x};
    value(world.set_positions(body, x));
    CHECK(sum(origins(world, {}).at(0)) == 0);
    for (Vec3& p : x) p.z += 0.1 * p.x * p.x * p.x;
    value(world.set_positions(body, x));
    CHECK(sum(origins(world, {}).at(0)) == Approx(1));
  }
}

TEST_CASE("shares do not depend on where a scene stands, and leave the state as it is") {
  Bar bar = bent(bar_mesh(), Element::tet10);
  Mesh moved = bar_mesh();
  for (Vec3& p : moved.nodes) p += Vec3{10, -20, 5};
  Bar other = bent(std::move(moved), Element::tet10);
  const auto hash = bar.world.state_hash();
  const auto a = origins(bar.world, {Output::elastic_energy()});
  const auto b = origins(other.world, {Output::elastic_energy()});
  for (std::size_t c = 0; c < a.at(0).cells.at(0).size(); ++c) {
    if (std::abs(a[0].cells[0][c] - b.at(0).cells.at(0)[c]) > 1e-6) FAIL("cell " << c);
  }
  CHECK(bar.world.state_hash() == hash);
}

TEST_CASE("without a derivative the shares are those of the strain, and say so") {
  World world = make_world(dynamic_options());
  const BodyId body = add_body(world, bar_mesh(), Element::tet4, neo_hookean(1e5, 0.3));
  hold(world, body, {"x0"});
  value(world.set_gravity({0, 0, -10}));
  REQUIRE(world.advance(0.1).status == isochor::StepStatus::converged);
  const auto found = origins(world, {Output::node(body, 3, {0, 0, 1})});
  CHECK_FALSE(found.at(0).by_output);
  CHECK_THAT(found[0].note, ContainsSubstring("dynamics"));
  CHECK(sum(found[0]) == Approx(1));
  const auto wrong = world.error_origins(std::vector<Output>{Output::gauge(isochor::EffectId{}, "volume")});
  CHECK_FALSE(wrong.ok());
}
