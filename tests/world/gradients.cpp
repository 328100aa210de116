// Gradients of equilibria: every output by every parameter. The judge builds the scene anew with the
// parameter moved, solves it to the last digits and takes differences.
#include "isochor/gradients.h"

#include <limits>
#include <set>

#include "support/derivative_lists.h"

using namespace test;
using Catch::Matchers::WithinAbs;
using isochor::VolumeSpace;

namespace {

std::vector<std::pair<std::string, Output>> all_outputs(const Block& block) {
  const Index tip = nearest_node(block.world.rest_positions(block.body), {1, 1, 1});
  const Index next = nearest_node(block.world.rest_positions(block.body), {1, 0, 1});
  std::vector<std::pair<std::string, Output>> out{
      {"node", Output::node(block.body, tip, {0.3, -0.2, 1})},
      {"two nodes", Output::positions(block.body, {tip, next}, {{0, 0, 1}, {0, 0, -1}})},
      {"point", Output::material_point(block.body, {0.9, 0.4, 0.8}, {0, 1, 1})},
      {"distance", Output::distance(block.body, {tip, next}, {{1.1, 1, 1.2}, {1, 0.1, 1}})},
      {"square", Output::square(block.body, {tip, next}, {{0, 1, 1}, {0.5, 0, -1}}, 0.7)},
      {"function", spread(block.body)}};
  for (auto& one : measures_of(block)) out.push_back(std::move(one));
  return out;
}

std::vector<Output> just_outputs(const Block& block) {
  std::vector<Output> out;
  for (auto& [name, o] : all_outputs(block)) out.push_back(std::move(o));
  return out;
}

// Of the outputs of the scene built with other knobs.
std::vector<double> values_of(const Knobs& knobs, const Kind& kind) {
  Block block = make_block(knobs, kind);
  GradientQuery query;
  query.outputs = just_outputs(block);
  return value(block.world.gradients(query)).values;
}

void check_list(const Knobs& knobs, const Kind& kind) {
  Block block = make_block(knobs, kind);
  GradientQuery query;
  query.outputs = just_outputs(block);
  const auto asked = parameters_of(block);
  for (const Asked& a : asked) query.parameters.push_back(a.parameter);
  const std::uint64_t before = block.world.state_hash();
  query.mode = GradientQuery::Mode::adjoint;
  const Gradients adjoint = value(block.world.gradients(query));
  query.mode = GradientQuery::Mode::tangent;
  const Gradients tangent = value(block.world.gradients(query));
  CHECK(block.world.state_hash() == before);
  CHECK(adjoint.adjoint);
  CHECK_FALSE(tangent.adjoint);
  CHECK(adjoint.regular);
  CHECK(adjoint.values == tangent.values);
  std::vector<std::string> names;
  for (const auto& [name, output] : all_outputs(block)) names.push_back(name);
  check_all(knobs, names, asked, {adjoint, tangent}, 1e-3,
            [&](const Knobs& moved) { return values_of(moved, kind); });
}

}  // namespace

TEST_CASE("every output by every parameter, with all elements and rows, is what differences say",
          "[gradients]") {
  for (const auto element : kAllElements) {
    for (const double poisson : {0.3, 0.49, 0.5}) {
      CAPTURE(name_of(element), poisson);
      Knobs knobs;
      knobs.poisson = poisson;
      check_list(knobs, {element, VolumeSpace::node, isochor::CavityControl::pressure});
    }
  }
}

TEST_CASE("outputs are what the world says of itself", "[gradients]") {
  for (const auto element : kAllElements) {
    CAPTURE(name_of(element));
    Knobs knobs;
    knobs.poisson = 0.49;
    Block block = make_block(knobs, {element, VolumeSpace::node, isochor::CavityControl::pressure});
    const isochor::BodyFields fields = block.world.fields(block.body);
    const isochor::Energies e = block.world.energies();
    GradientQuery query;
    std::vector<double> wanted;
    const auto is = [&](Output o, double number) {
      query.outputs.push_back(std::move(o));
      wanted.push_back(number);
    };
    const auto cell = static_cast<Index>(fields.cell_J.size() / 3);
    is(Output::stress(block.body, cell, "von_mises"), fields.cell_von_mises[static_cast<std::size_t>(cell)]);
    is(Output::stress(block.body, cell, "pressure"), fields.cell_pressure[static_cast<std::size_t>(cell)]);
    std::size_t k = 6 * static_cast<std::size_t>(cell);
    for (const char* component : {"xx", "yy", "zz", "xy", "yz", "zx"})
      is(Output::stress(block.body, cell, component), fields.cell_stress[k++]);
    is(Output::energy("elastic"), e.elastic);
    is(Output::energy("gravity"), e.gravity);
    is(Output::energy("loads"), e.loads);
    is(Output::energy("pressures"), e.pressures);
    is(Output::energy("potential"), e.potential());
    const auto told = value(block.world.gradients(query)).values;
    for (std::size_t j = 0; j < wanted.size(); ++j) {
      CAPTURE(j);
      CHECK_THAT(told[j],
                 WithinAbs(wanted[j], 1e-12 * std::abs(wanted[j]) + 1e-12 * fields.cell_von_mises[0]));
    }
    // A chamber pushes on all sides: on a body it has no force in all but on the rim, and a cable pulls by
    // what it ends at.
    GradientQuery forces;
    forces.outputs = {Output::effect_force(block.cavity, block.body, {0, 1, 0}),
                      Output::effect_force(block.cable, block.body, {1, 0, 0}),
                      Output::gauge(block.cable, "tension")};
    const auto pull = value(block.world.gradients(forces)).values;
    CHECK_THAT(pull[0], WithinAbs(0, 1e-9 * knobs.cavity));
    CHECK(pull[1] < 0);
    CHECK(-pull[1] <= pull[2]);
  }
}

TEST_CASE("the list asks for every kind of output and of parameter", "[gradients]") {
  const Block block = make_block({}, {});
  std::set<Output::Kind> outputs;
  std::set<Parameter::Kind> parameters{Parameter::Kind::cells};  // in a case of its own
  for (const auto& [name, o] : all_outputs(block)) outputs.insert(o.kind);
  for (const Asked& a : parameters_of(block)) parameters.insert(a.parameter.kind);
  parameters.insert(Parameter::Kind::velocity);  // of ways through time
  CHECK(outputs.size() == 1 + static_cast<std::size_t>(Output::Kind::function));
  CHECK(parameters.size() == 1 + static_cast<std::size_t>(Parameter::Kind::curve));
}

TEST_CASE("the same with rows of every space, and with a chamber of given volume", "[gradients]") {
  for (const auto space : {VolumeSpace::element, VolumeSpace::body, VolumeSpace::ring}) {
    CAPTURE(static_cast<int>(space));
    Knobs knobs;
    knobs.poisson = 0.49;
    knobs.cavity = 1.05;
    check_list(knobs, {isochor::Element::tet4, space, isochor::CavityControl::volume_ratio});
  }
}

TEST_CASE("stiffnesses of cells are what differences of fields say, and add up to that of the body",
          "[gradients]") {
  for (const auto element : kAllElements) {
    for (const auto space : {VolumeSpace::node, VolumeSpace::element, VolumeSpace::ring}) {
      CAPTURE(name_of(element), static_cast<int>(space));
      Knobs knobs;
      knobs.poisson = 0.45;
      // Of edge-smoothed tets, with the guard at work.
      const double guard = element == isochor::Element::tet4_edge_smoothed ? 0.05 : 0;
      const Kind kind{element, space, isochor::CavityControl::pressure, guard};
      const auto cells = static_cast<std::size_t>(make_block(knobs, kind).world.mesh({}).cell_count());
      for (std::size_t c = 0; c < cells; ++c)
        knobs.field.push_back(1 + 0.3 * std::sin(static_cast<double>(c)));
      Block block = make_block(knobs, kind);
      GradientQuery query;
      query.outputs = just_outputs(block);
      query.parameters = {Parameter::cell_stiffness(block.body), Parameter::stiffness(block.body)};
      const Gradients g = value(block.world.gradients(query));
      for (std::size_t j = 0; j < query.outputs.size(); ++j) {
        double sum = 0, size = 0;
        for (const double v : g.by[j][0]) sum += v, size += std::abs(v);
        CHECK_THAT(sum, WithinAbs(g.of(j, 1), 1e-12 * size));
      }
      const double h = 1e-2;
      for (const std::size_t c : {std::size_t{0}, cells / 2, cells - 1}) {
        std::vector<double> wanted(query.outputs.size(), 0);
        for (const auto& [step, weight] : {std::pair(-2, 1. / 12), std::pair(-1, -8. / 12),
                                           std::pair(1, 8. / 12), std::pair(2, -1. / 12)}) {
          Knobs moved = knobs;
          moved.field[c] *= 1 + step * h;
          const std::vector<double> there = values_of(moved, kind);
          for (std::size_t j = 0; j < there.size(); ++j) wanted[j] += weight / h * there[j];
        }
        for (std::size_t j = 0; j < wanted.size(); ++j) {
          double size = 0;
          for (const double v : g.by[j][0]) size = std::max(size, std::abs(v));
          CAPTURE(c, j);
          CHECK_THAT(g.by[j][0][c], WithinAbs(wanted[j], 1e-6 * size + 1e-10 * std::abs(g.values[j])));
        }
      }
    }
  }
}

TEST_CASE(
    "scaling all stiffnesses and loads changes no position, and rigid motions of the rest shape go along",
    "[gradients]") {
  Knobs knobs;
  knobs.poisson = 0.5;
  Block block =
      make_block(knobs, {isochor::Element::tet10, VolumeSpace::node, isochor::CavityControl::pressure});
  const Index tip = nearest_node(block.world.rest_positions(block.body), {1, 1, 1});
  GradientQuery query;
  query.outputs = {Output::node(block.body, tip, {1, 0, 0}), Output::node(block.body, tip, {0, 0, 1})};
  const std::vector<Vec3> along(static_cast<std::size_t>(block.world.mesh(block.body).node_count()),
                                {1, 0, 0});
  query.parameters = {Parameter::stiffness(block.body), Parameter::amount_of(block.cavity),
                      Parameter::gravity({0, 0, 1}), Parameter::force_at(block.body, kPushed, kPush),
                      cable_stiffness(block)};
  const std::vector<double> size = {1, knobs.cavity, knobs.gravity, knobs.push, knobs.spring};
  const Gradients g = value(block.world.gradients(query));
  for (std::size_t j = 0; j < 2; ++j) {
    double sum = 0, most = 0;
    for (std::size_t p = 0; p < size.size(); ++p) {
      sum += size[p] * g.of(j, p);
      most = std::max(most, std::abs(size[p] * g.of(j, p)));
    }
    CHECK(most > 0);
    CHECK_THAT(sum, WithinAbs(0, 1e-9 * most));
  }
  // The cable's path is not that of the body, so a body without it.
  World plain = make_world(tight_statics());
  const BodyId body = add_body(plain, hollow_block(isochor::CellType::tet4), isochor::Element::tet4,
                               neo_hookean(1e4, 0.5), 1000);
  add_volume(plain, body);
  const auto clamp = hold(plain, body, {"x0"}, {}, {0, 0.02, 0}, isochor::Curve::constant(1));
  value(plain.set_gravity({0, 0, -9.81}));
  must_advance(plain);
  GradientQuery rigid;
  rigid.outputs = {Output::node(body, tip, {1, 0, 0}), Output::node(body, tip, {0, 0, 1}),
                   Output::reaction(clamp, {1, 1, 1})};
  rigid.parameters = {Parameter::shape(
      body, std::vector<Vec3>(static_cast<std::size_t>(plain.mesh(body).node_count()), {1, 0, 0}))};
  const Gradients moved = value(plain.gradients(rigid));
  CHECK_THAT(moved.of(0, 0), WithinAbs(1, 1e-9));
  CHECK_THAT(moved.of(1, 0), WithinAbs(0, 1e-9));
  CHECK_THAT(moved.of(2, 0), WithinAbs(0, 1e-7 * std::abs(moved.values[2])));
}

TEST_CASE("outputs and points of curves that there are none of are refused by name", "[gradients]") {
  Block block = make_block({}, {isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure});
  const auto asked = [&](Output o, Parameter p) {
    GradientQuery query;
    query.outputs = {std::move(o)};
    query.parameters = {std::move(p)};
    return refusal(block.world.gradients(query));
  };
  const Output tip = Output::node(block.body, 0, {1, 0, 0});
  const Parameter weight = Parameter::density(block.body);
  CHECK_THAT(asked(Output::energy("heat"), weight),
             ContainsSubstring("outputs[0]: there is no energy \"heat\""));
  CHECK_THAT(asked(Output::energy("kinetic"), weight), ContainsSubstring("nothing moves in statics"));
  CHECK_THAT(asked(Output::stress(block.body, 99999, "xx"), weight), ContainsSubstring("no cell 99999"));
  CHECK_THAT(asked(Output::stress(block.body, 0, "tresca"), weight), ContainsSubstring("none of that name"));
  CHECK_THAT(asked(Output::effect_force(block.clamp, block.body, {1, 0, 0}), weight),
             ContainsSubstring("take the reaction"));
  CHECK_THAT(asked(Output::square(block.body, {0}, {{1, 0, 0}}, std::nan("")), weight),
             ContainsSubstring("target = nan"));
  CHECK_THAT(asked(Output::of_positions(block.body, nullptr), weight), ContainsSubstring("no function"));
  CHECK_THAT(asked(Output::of_positions(block.body,
                                        [](std::span<const Vec3>, std::span<Vec3>) {
                                          return isochor::Result<double>(isochor::Error{"out of range"});
                                        }),
                   weight),
             ContainsSubstring("out of range"));
  CHECK_THAT(asked(Output::of_positions(block.body,
                                        [](std::span<const Vec3>, std::span<Vec3> g) {
                                          g[3].y = std::nan("");
                                          return isochor::Result<double>(1.0);
                                        }),
                   weight),
             ContainsSubstring("not finite"));
  const isochor::Curve level = isochor::Curve::constant(400);
  CHECK_THAT(asked(tip, Parameter::curve_point(block.cavity, level, 1)), ContainsSubstring("no point 1"));
  CHECK_THAT(asked(tip, Parameter::curve_point(block.cavity, isochor::Curve::constant(300), 0)),
             ContainsSubstring("but the amount is 400"));
}

TEST_CASE("what has no gradient is refused by name", "[gradients]") {
  Block block = make_block({}, {isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure});
  const auto asked = [&](Output o, Parameter p, GradientQuery::Mode mode = GradientQuery::Mode::automatic) {
    GradientQuery query;
    query.outputs = {std::move(o)};
    query.parameters = {std::move(p)};
    query.mode = mode;
    return refusal(block.world.gradients(query));
  };
  const Output tip = Output::node(block.body, 0, {1, 0, 0});
  const Parameter weight = Parameter::density(block.body);
  CHECK_THAT(asked(Output::node(block.body, 999999, {1, 0, 0}), weight), ContainsSubstring("node 999999"));
  CHECK_THAT(asked(Output::gauge(block.cavity, "color"), weight), ContainsSubstring("no such gauge"));
  CHECK_THAT(asked(Output::reaction(block.cable, {1, 0, 0}), weight), ContainsSubstring("no reaction"));
  CHECK_THAT(asked(Output::positions(block.body, {0, 1}, {{1, 0, 0}}), weight),
             ContainsSubstring("one vector a node"));
  CHECK_THAT(asked(tip, Parameter::density(block.body, "steel")), ContainsSubstring("steel"));
  CHECK_THAT(asked(tip, Parameter::cell_stiffness(block.body), GradientQuery::Mode::tangent),
             ContainsSubstring("adjoint"));
  CHECK_THAT(asked(tip, Parameter::shape(block.body, {{1, 0, 0}})), ContainsSubstring("1 vectors"));
  CHECK_THAT(asked(tip, Parameter::material(block.body, "", 2e4,
                                            [](double v) -> isochor::Result<isochor::MaterialPtr> {
                                              return neo_hookean(v, 0.3);
                                            })),
             ContainsSubstring("not what the scene has"));
  CHECK_THAT(asked(tip, Parameter::material(block.body, "", 0, nullptr)), ContainsSubstring("no function"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(asked(tip, Parameter::gravity({0, nan, 1})),
             ContainsSubstring("parameters[0]: the vector is (0, nan, 1)"));
  CHECK_THAT(asked(Output::reaction(block.clamp, {nan, 0, 0}), weight),
             ContainsSubstring("outputs[0]: the force is (nan"));
  CHECK_THAT(asked(Output::node(block.body, 0, {0, 0, nan}), weight),
             ContainsSubstring("outputs[0]: the vector 0 is"));
  CHECK_THAT(asked(tip, Parameter::constant_of(block.cable, 900,
                                               [](double) -> isochor::Result<isochor::EffectPtr> {
                                                 return isochor::Error{"cables are sold out"};
                                               })),
             ContainsSubstring("cables are sold out"));
  // A state that nobody solved for.
  World fresh = make_world(tight_statics());
  const BodyId body = add_body(fresh, hollow_block(isochor::CellType::tet4), isochor::Element::tet4,
                               neo_hookean(1e4, 0.3), 1000);
  hold(fresh, body, {"x0"});
  value(fresh.set_gravity({0, 0, -9.81}));
  must_advance(fresh);
  std::vector<Vec3> elsewhere(fresh.positions(body).begin(), fresh.positions(body).end());
  for (Vec3& x : elsewhere) x.z *= 1.01;
  value(fresh.set_positions(body, elsewhere));
  GradientQuery query;
  query.outputs = {Output::node(body, 0, {1, 0, 0})};
  query.parameters = {Parameter::density(body)};
  CHECK_THAT(refusal(fresh.gradients(query)), ContainsSubstring("no equilibrium"));
  // A body in motion.
  World moving = make_world(dynamic_options());
  add_body(moving, hollow_block(isochor::CellType::tet4), isochor::Element::tet4, neo_hookean(1e4, 0.3),
           1000);
  must_advance(moving, 0.01);
  CHECK_THAT(refusal(moving.gradients(query)), ContainsSubstring("inertia"));
}

namespace {

struct Pressed {
  World world;
  BodyId body{};
  EffectId top{};
};

// A block between a moved side and a floor.
Pressed pressed(double gap, double down, double friction) {
  Pressed p{make_world(tight_statics())};
  p.body = add_body(p.world, block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), isochor::Element::tet4,
                    neo_hookean(1e4, 0.4), 1000);
  add_volume(p.world, p.body, VolumeSpace::element);
  p.top = hold(p.world, p.body, {"z1"}, {}, {0, 0, -1}, isochor::Curve::constant(down));
  isochor::ContactDef floor;
  floor.name = "floor";
  floor.body = p.body;
  floor.surfaces = {"z0"};
  floor.obstacle.shape = isochor::ObstacleShape::plane;
  floor.obstacle.position = {0, 0, -gap};
  floor.obstacle.axis = {0, 0, 1};
  floor.friction = friction;
  value(p.world.add(isochor::contact(floor)));
  must_advance(p.world);
  must_advance(p.world, 0.01);
  return p;
}

GradientQuery about(const Pressed& p) {
  GradientQuery query;
  const Index corner = nearest_node(p.world.rest_positions(p.body), {1, 1, 0.5});
  query.outputs = {Output::node(p.body, corner, {1, 0, 0}), Output::reaction(p.top, {0, 0, 1})};
  query.parameters = {Parameter::amount_of(p.top), Parameter::stiffness(p.body)};
  return query;
}

}  // namespace

TEST_CASE("a floor without friction is part of the gradient, and touching says so", "[gradients]") {
  Pressed firm = pressed(0.001, 0.05, 0);
  const Gradients g = value(firm.world.gradients(about(firm)));
  CHECK(g.regular);
  CHECK(g.undecided.empty());
  const double h = 1e-4;
  std::vector<std::vector<double>> there;
  for (const double by : {-h, h}) {
    Pressed moved = pressed(0.001, 0.05 + by, 0);
    there.push_back(value(moved.world.gradients(about(moved))).values);
  }
  for (std::size_t j = 0; j < 2; ++j) {
    const double wanted = (there[1][j] - there[0][j]) / (2 * h);
    CHECK_THAT(g.of(j, 0), WithinAbs(wanted, 1e-5 * std::abs(wanted)));
  }
  // Moved by given displacements alone: forces follow the stiffness, positions do not.
  CHECK_THAT(g.of(0, 1), WithinAbs(0, 1e-10));
  CHECK_THAT(g.of(1, 1), WithinAbs(g.values[1], 1e-8 * std::abs(g.values[1])));
  Pressed touching = pressed(0.05 + 1e-8, 0.05, 0);
  const Gradients one_sided = value(touching.world.gradients(about(touching)));
  CHECK_FALSE(one_sided.regular);
  CHECK(one_sided.undecided == std::vector<std::string>{"floor"});
  CHECK_THAT(one_sided.note, ContainsSubstring("about to touch"));
}

TEST_CASE("the force of a contact holds what presses, and goes with it", "[gradients]") {
  for (const double friction : {0.0, 0.4}) {
    CAPTURE(friction);
    Pressed firm = pressed(0.001, 0.05, friction);
    GradientQuery query;
    const auto floor = firm.world.effects().back();
    query.outputs = {Output::effect_force(floor, firm.body, {0, 0, 1}), Output::reaction(firm.top, {0, 0, 1}),
                     Output::effect_force(floor, firm.body, {1, 0.5, 0})};
    query.parameters = {Parameter::amount_of(firm.top), Parameter::stiffness(firm.body)};
    query.mode = GradientQuery::Mode::tangent;
    const Gradients g = value(firm.world.gradients(query));
    const auto pairs = firm.world.contact_pairs();
    REQUIRE(pairs.size() == 1);
    CHECK_THAT(g.values[0], WithinAbs(pairs[0].force.z, 1e-9 * pairs[0].force.z));
    CHECK_THAT(g.values[2], WithinAbs(pairs[0].force.x + 0.5 * pairs[0].force.y, 1e-9 * pairs[0].force.z));
    // Nothing else holds the block, which has no weight.
    for (std::size_t p = 0; p < query.parameters.size(); ++p) {
      CHECK(std::abs(g.of(0, p)) > 0);
      CHECK_THAT(g.of(0, p), WithinAbs(-g.of(1, p), 1e-7 * std::abs(g.of(0, p))));
    }
  }
}

TEST_CASE("with friction the adjoint is that of an unsymmetric matrix, and what holds on is said",
          "[gradients]") {
  for (const double friction : {0.1, 0.5, 1.2}) {
    CAPTURE(friction);
    Pressed rough = pressed(0.001, 0.05, friction);
    GradientQuery query = about(rough);
    const auto floor = rough.world.effects().back();
    const Index low = nearest_node(rough.world.rest_positions(rough.body), {1, 0.5, 0});
    query.outputs.push_back(Output::node(rough.body, low, {1, 0.4, 0}));  // that rubs
    query.outputs.push_back(Output::effect_force(floor, rough.body, {0.3, 1, 0.2}));
    query.outputs.push_back(Output::stress(rough.body, 3, "von_mises"));
    query.parameters.push_back(Parameter::gravity({0.2, 0, 1}));
    query.parameters.push_back(Parameter::force_at(rough.body, {1, 1, 0.5}, {1, 0, -1}));
    const Gradients tangent = value(rough.world.gradients(query));
    CHECK_FALSE(tangent.adjoint);
    CHECK_FALSE(tangent.regular);
    CHECK_THAT(tangent.note, ContainsSubstring("friction"));
    query.parameters.push_back(Parameter::cell_stiffness(rough.body));
    query.mode = GradientQuery::Mode::adjoint;
    const Gradients adjoint = value(rough.world.gradients(query));
    CHECK(adjoint.adjoint);
    for (std::size_t j = 0; j < query.outputs.size(); ++j) {
      CAPTURE(j);
      const std::vector<double> sizes{0.05, 1, 1, 10};
      double scale = 0, sum = 0, most = 0;
      for (std::size_t p = 0; p < sizes.size(); ++p)
        scale = std::max(scale, std::abs(tangent.of(j, p)) * sizes[p]);
      CHECK(scale > 0);
      for (std::size_t p = 0; p < sizes.size(); ++p) {
        CAPTURE(p);
        CHECK_THAT(adjoint.of(j, p), WithinAbs(tangent.of(j, p), 1e-10 * scale / sizes[p]));
      }
      for (const double v : adjoint.by[j].back()) sum += v, most = std::max(most, std::abs(v));
      CHECK_THAT(sum, WithinAbs(adjoint.of(j, 1), 1e-10 * most + 1e-9 * scale));
    }
  }
}

TEST_CASE("an equilibrium behind a limit point is refused unless it is meant", "[gradients]") {
  isochor::WorldOptions options = tight_statics();
  options.scheme = isochor::continuation();
  options.gravity = {0, 0, -60};
  options.gravity_curve = isochor::Curve::ramp(10, 10);
  options.force_tolerance = 1e-11;
  World arch = make_world(options);
  Mesh mesh = block({0, 0, 0}, {1, 0.05, 0.03}, {24, 1, 2});
  for (Vec3& X : mesh.nodes) X.z += 0.08 * std::sin(3.14159265358979 * X.x);
  const BodyId body =
      add_body(arch, std::move(mesh), isochor::Element::tet4_edge_smoothed, neo_hookean(1e6, 0.5), 1000);
  add_volume(arch, body);
  hold(arch, body, {"x0", "x1"});
  GradientQuery query;
  query.outputs = {Output::node(body, nearest_node(arch.rest_positions(body), {0.5, 0, 0.11}), {0, 0, 1})};
  query.parameters = {Parameter::stiffness(body), Parameter::density(body)};
  bool stable = false, unstable = false;
  for (int k = 0; k < 60 && !unstable; ++k) {
    const isochor::StepReport r = arch.follow(0.01);
    REQUIRE(r.status == isochor::StepStatus::converged);
    if (r.unstable_directions == 0) {
      stable = true;
      CHECK(arch.gradients(query).ok());
      continue;
    }
    unstable = true;
    CHECK_THAT(refusal(arch.gradients(query)), ContainsSubstring("unstable"));
    query.unstable = true;
    const Gradients g = value(arch.gradients(query));
    // Heavier is as if it were softer.
    CHECK_THAT(1000 * g.of(0, 1), WithinAbs(-g.of(0, 0), 1e-6 * std::abs(g.of(0, 0))));
  }
  CHECK(stable);
  CHECK(unstable);
}
