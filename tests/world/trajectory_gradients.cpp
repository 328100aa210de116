// Gradients of what is seen on a way through time. The judge builds the scene anew with the parameter moved,
// goes the same way to the last digits and takes differences.
#include <limits>

#include "engine/step/time_scheme.h"
#include "isochor/gradients.h"
#include "support/hollow_block.h"

using namespace test;
using Catch::Matchers::WithinAbs;
using isochor::GradientQuery;
using isochor::Gradients;
using isochor::Output;
using isochor::Parameter;
using isochor::SchemePtr;
using isochor::TimedOutput;
using isochor::TrajectoryQuery;
using isochor::VolumeSpace;

namespace {

const std::vector<double> kSteps{0.05, 0.05, 0.03, 0.06};

isochor::WorldOptions tight(SchemePtr scheme) {
  isochor::WorldOptions options = tight_statics();
  options.scheme = std::move(scheme);
  return options;
}

Knobs moving(double poisson) {
  Knobs knobs;
  knobs.poisson = poisson;
  knobs.clamp = 0;
  knobs.velocity = 0.4;
  return knobs;
}

// Gauges belong to where an increment is evaluated, which the midpoint rule does not do at its end.
std::vector<TimedOutput> outputs_of(const Block& block, bool gauges) {
  const Index tip = nearest_node(block.world.rest_positions(block.body), {1, 1, 1});
  const Index next = nearest_node(block.world.rest_positions(block.body), {1, 0, 1});
  std::vector<TimedOutput> out{
      {{{4, Output::node(block.body, tip, {0.3, -0.2, 1})}}},
      {{{2, Output::material_point(block.body, {0.9, 0.4, 0.8}, {0, 1, 1})}}},
      // A target over time.
      {{{1, Output::distance(block.body, {tip, next}, {{1.1, 1, 1.2}, {1, 0.1, 1}})},
        {3, Output::distance(block.body, {tip}, {{1, 1, 1.3}})},
        {4, Output::distance(block.body, {tip, next}, {{1.1, 1, 1.2}, {1, 0.1, 1}})}}},
      {{{0, Output::node(block.body, tip, {1, 1, 1})}, {4, Output::node(block.body, next, {0, 0, 1})}}}};
  if (!gauges) return out;
  out.push_back({{{3, Output::gauge(block.cavity, "volume")}}});
  out.push_back({{{4, Output::gauge(block.cable, "tension")}}});
  return out;
}

struct Asked {
  std::string name;
  Parameter parameter;
  double Knobs::*knob;
};

std::vector<Asked> parameters_of(const Block& block, bool statics) {
  const Knobs k = block.knobs;
  const Kind kind = block.kind;
  const std::vector<Vec3> motion = shape_motion(block.world.mesh(block.body));
  std::vector<Asked> out{
      {"amount of a support", Parameter::amount_of(block.clamp), &Knobs::clamp},
      {"amount of a cavity", Parameter::amount_of(block.cavity), &Knobs::cavity},
      {"amount of a cable", Parameter::amount_of(block.cable), &Knobs::cable},
      {"force", Parameter::force_at(block.body, kPushed, kPush), &Knobs::push},
      {"gravity", Parameter::gravity({0, 0, 1}), &Knobs::gravity},
      {"density", Parameter::density(block.body), &Knobs::density},
      {"Young's modulus",
       Parameter::material(block.body, "", k.young, [k](double v) { return material_of(v, k.poisson, k); }),
       &Knobs::young},
      {"Poisson's ratio",
       Parameter::material(block.body, "", k.poisson, [k](double v) { return material_of(k.young, v, k); }),
       &Knobs::poisson},
      {"stiffness", Parameter::stiffness(block.body), &Knobs::stiffness},
      {"stiffness of the cable",
       Parameter::constant_of(block.cable, k.spring,
                              [k, kind](double v) {
                                Knobs other = k;
                                other.spring = v;
                                return isochor::cable(cable_of(other, kind));
                              }),
       &Knobs::spring},
      {"shape", Parameter::shape(block.body, motion), &Knobs::shape}};
  if (!statics)
    out.push_back({"velocity", Parameter::initial_velocity(block.body, motion), &Knobs::velocity});
  return out;
}

TrajectoryQuery query_of(const Block& block, bool gauges, bool statics) {
  TrajectoryQuery query;
  query.steps = kSteps;
  query.outputs = outputs_of(block, gauges);
  for (const Asked& a : parameters_of(block, statics)) query.parameters.push_back(a.parameter);
  return query;
}

std::vector<double> values_of(const Knobs& knobs, const Kind& kind, const SchemePtr& scheme, bool gauges) {
  Block block = build_block(knobs, kind, tight(scheme));
  TrajectoryQuery query;
  query.steps = kSteps;
  query.outputs = outputs_of(block, gauges);
  return value(block.world.trajectory_gradients(query)).values;
}

std::vector<double> difference(const Block& block, double Knobs::*knob, const SchemePtr& scheme,
                               bool gauges) {
  const double at = block.knobs.*knob;
  const bool ends = knob == &Knobs::poisson && at == 0.5;
  double h = 2e-3 * (at == 0 ? 0.1 : std::abs(at));
  if (knob == &Knobs::poisson && !ends) h = 2e-2 * (0.5 - at);
  const std::vector<std::pair<int, double>> rule =
      ends ? std::vector<std::pair<int, double>>{{0, 137. / 60}, {-1, -5},     {-2, 5},
                                                 {-3, -10. / 3}, {-4, 5. / 4}, {-5, -1. / 5}}
           : std::vector<std::pair<int, double>>{{-2, 1. / 12}, {-1, -8. / 12}, {1, 8. / 12}, {2, -1. / 12}};
  std::vector<double> sum;
  for (const auto& [step, weight] : rule) {
    Knobs moved = block.knobs;
    moved.*knob = at + step * h;
    const std::vector<double> there = values_of(moved, block.kind, scheme, gauges);
    sum.resize(there.size());
    for (std::size_t j = 0; j < there.size(); ++j) sum[j] += weight / h * there[j];
  }
  return sum;
}

void check_list(const Knobs& knobs, const Kind& kind, const SchemePtr& scheme) {
  const bool gauges = scheme->name() != "implicit_midpoint", statics = !scheme->has_inertia();
  Block block = build_block(knobs, kind, tight(scheme));
  TrajectoryQuery query = query_of(block, gauges, statics);
  const std::vector<std::byte> start = block.world.save();
  query.mode = GradientQuery::Mode::adjoint;
  const Gradients adjoint = value(block.world.trajectory_gradients(query));
  const std::uint64_t end = block.world.state_hash();
  value(block.world.load(start));
  query.mode = GradientQuery::Mode::tangent;
  const Gradients tangent = value(block.world.trajectory_gradients(query));
  CHECK(block.world.state_hash() == end);
  CHECK(adjoint.adjoint);
  CHECK_FALSE(tangent.adjoint);
  CHECK(adjoint.regular);
  const auto asked = parameters_of(block, statics);
  std::vector<double> largest(query.outputs.size(), 0), size;
  for (const Asked& a : asked) size.push_back(knobs.*a.knob == 0 ? 0.1 : std::abs(knobs.*a.knob));
  for (std::size_t j = 0; j < query.outputs.size(); ++j) {
    CHECK_THAT(adjoint.values[j], WithinAbs(tangent.values[j], 1e-14 + 1e-12 * std::abs(tangent.values[j])));
    for (std::size_t p = 0; p < asked.size(); ++p)
      largest[j] = std::max(largest[j], std::abs(adjoint.of(j, p)) * size[p]);
  }
  for (std::size_t p = 0; p < asked.size(); ++p) {
    const std::vector<double> wanted = difference(block, asked[p].knob, scheme, gauges);
    for (std::size_t j = 0; j < query.outputs.size(); ++j) {
      INFO("output " << j << " by " << asked[p].name);
      const double scale = largest[j] / size[p];
      // Points inside of cells stay where they are in the mesh, and the judge looks them up anew.
      if (j != 1 || asked[p].name != "shape")
        CHECK_THAT(adjoint.of(j, p), WithinAbs(wanted[j], 1e-6 * scale));
      CHECK_THAT(adjoint.of(j, p), WithinAbs(tangent.of(j, p), 1e-10 * scale));
    }
  }
}

template <class T>
std::string refusal(const isochor::Result<T>& result) {
  REQUIRE_FALSE(result.ok());
  return result.error();
}

}  // namespace

TEST_CASE("every output by every parameter, with every scheme, is what differences say", "[gradients]") {
  const std::vector<SchemePtr> schemes{isochor::implicit_euler(),
                                       isochor::bdf2(),
                                       isochor::implicit_midpoint(),
                                       isochor::generalized_alpha(0.6),
                                       isochor::newmark(),
                                       isochor::static_until(0.06, isochor::bdf2()),
                                       isochor::statics()};
  for (const SchemePtr& scheme : schemes) {
    CAPTURE(std::string(scheme->name()));
    Knobs knobs = moving(0.49);
    if (!scheme->has_inertia() || scheme->name().starts_with("static")) knobs.velocity = 0;
    check_list(knobs, {isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure}, scheme);
  }
}

TEST_CASE("the same with every element and Poisson's ratio, and with consistent mass", "[gradients]") {
  for (const auto element : kAllElements) {
    for (const double poisson : {0.3, 0.5}) {
      CAPTURE(name_of(element), poisson);
      check_list(moving(poisson), {element, VolumeSpace::node, isochor::CavityControl::pressure},
                 isochor::bdf2());
    }
  }
}

TEST_CASE("states that are made again change no gradient", "[gradients]") {
  const Kind kind{isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure};
  for (const auto mode : {GradientQuery::Mode::adjoint, GradientQuery::Mode::tangent}) {
    std::vector<Gradients> all;
    for (const Index kept : {0, 1, 2, 3, 9}) {
      Block block = build_block(moving(0.5), kind, tight(isochor::bdf2()));
      TrajectoryQuery query = query_of(block, true, false);
      query.mode = mode;
      query.kept_states = kept;
      all.push_back(value(block.world.trajectory_gradients(query)));
    }
    for (const Gradients& g : all) {
      CHECK(g.values == all[0].values);
      CHECK(g.by == all[0].by);
    }
  }
}

TEST_CASE("the world is at the end of the way, as after the same steps", "[gradients]") {
  const Kind kind{isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure};
  Block block = build_block(moving(0.3), kind, tight(isochor::generalized_alpha(0.8)));
  Block plain = build_block(moving(0.3), kind, tight(isochor::generalized_alpha(0.8)));
  (void)value(block.world.trajectory_gradients(query_of(block, true, false)));
  for (const double h : kSteps) CHECK(plain.world.step(h).status == isochor::StepStatus::converged);
  CHECK(block.world.state_hash() == plain.world.state_hash());
  CHECK(block.world.time() == plain.world.time());
}

TEST_CASE("stiffnesses of cells add up to that of the body", "[gradients]") {
  const Kind kind{isochor::Element::tet4_edge_smoothed, VolumeSpace::node, isochor::CavityControl::pressure};
  Block block = build_block(moving(0.45), kind, tight(isochor::bdf2()));
  TrajectoryQuery query = query_of(block, true, false);
  query.parameters = {Parameter::cell_stiffness(block.body), Parameter::stiffness(block.body)};
  const Gradients g = value(block.world.trajectory_gradients(query));
  CHECK(g.adjoint);
  for (std::size_t j = 0; j < query.outputs.size(); ++j) {
    double sum = 0, size = 0;
    for (const double v : g.by[j][0]) sum += v, size += std::abs(v);
    CHECK(size > 0);
    CHECK_THAT(sum, WithinAbs(g.of(j, 1), 1e-11 * size));
  }
}

// A mass on a spring is x'' = -w^2 x; here a bar that is stretched by its own inertia, as small as to be
// linear.
TEST_CASE("a body that flies moves with its velocity and falls with gravity", "[gradients]") {
  for (const auto& scheme : {isochor::bdf2(), isochor::newmark(), isochor::implicit_midpoint()}) {
    World world = make_world(tight(scheme));
    const BodyId body = add_body(world, block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), isochor::Element::tet4,
                                 neo_hookean(1e4, 0.3));
    std::vector<Vec3> v(world.rest_positions(body).size(), {1, 2, 3});
    value(world.set_velocities(body, v));
    TrajectoryQuery query;
    query.steps = std::vector<double>(10, 0.01);
    query.outputs = {{{{10, Output::node(body, 0, {1, 0, 0})}}}, {{{10, Output::node(body, 0, {0, 0, 1})}}}};
    query.parameters = {Parameter::initial_velocity(body, v), Parameter::gravity({0, 0, 1}),
                        Parameter::density(body), Parameter::stiffness(body)};
    const Gradients g = value(world.trajectory_gradients(query));
    CHECK_THAT(g.of(0, 0), WithinAbs(0.1, 1e-9));
    CHECK_THAT(g.of(1, 0), WithinAbs(0.3, 1e-9));
    // Of first order where a scheme begins.
    CHECK_THAT(g.of(1, 1), WithinAbs(0.005, 6e-4));
    CHECK_THAT(g.of(1, 2), WithinAbs(0, 1e-12));
    CHECK_THAT(g.of(1, 3), WithinAbs(0, 1e-9));
  }
}

TEST_CASE("ways that have no gradients are refused by name, and leave the world where it was",
          "[gradients]") {
  const Kind kind{isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure};
  Block block = build_block(moving(0.3), kind, tight(isochor::implicit_euler()));
  const std::uint64_t before = (value(block.world.compile()), block.world.state_hash());
  const auto refused = [&](const auto& change) {
    TrajectoryQuery query = query_of(block, true, false);
    change(query);
    const std::string text = refusal(block.world.trajectory_gradients(query));
    CHECK(block.world.state_hash() == before);
    return text;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(refused([](TrajectoryQuery& q) { q.steps.clear(); }), ContainsSubstring("steps is empty"));
  CHECK_THAT(refused([&](TrajectoryQuery& q) { q.steps[1] = nan; }), ContainsSubstring("steps[1] = nan"));
  CHECK_THAT(refused([](TrajectoryQuery& q) { q.steps[2] = -1; }), ContainsSubstring("steps[2] = -1"));
  CHECK_THAT(refused([](TrajectoryQuery& q) { q.kept_states = -1; }), ContainsSubstring("kept_states = -1"));
  CHECK_THAT(refused([](TrajectoryQuery& q) { q.outputs[0].terms[0].step = 5; }),
             ContainsSubstring("outputs[0]: step = 5"));
  CHECK_THAT(refused([](TrajectoryQuery& q) { q.outputs[1].terms.clear(); }),
             ContainsSubstring("outputs[1] has no terms"));
  CHECK_THAT(refused([&](TrajectoryQuery& q) {
               q.outputs[0].terms[0].output = Output::node(block.body, 999999, {1, 0, 0});
             }),
             ContainsSubstring("outputs[0]: an output names node 999999"));
  CHECK_THAT(refused([](TrajectoryQuery& q) { q.outputs[0].terms[0].output = Output::elastic_energy(); }),
             ContainsSubstring("energies"));
  CHECK_THAT(refused([&](TrajectoryQuery& q) {
               q.parameters = {Parameter::initial_velocity(block.body, {{1, 0, 0}})};
             }),
             ContainsSubstring("parameters[0]: initial_velocity: motion has 1 vectors"));
  CHECK_THAT(refused([&](TrajectoryQuery& q) {
               q.parameters = {Parameter::cell_stiffness(block.body)};
               q.mode = GradientQuery::Mode::tangent;
             }),
             ContainsSubstring("adjoint"));

  // What looks back over an increment.
  Block damped = build_block(moving(0.3), kind, tight(isochor::implicit_euler()));
  isochor::DampingDef damping;
  damping.body = damped.body;
  damping.viscosity = 10;
  value(damped.world.add(isochor::damping(damping)));
  CHECK_THAT(refusal(damped.world.trajectory_gradients(query_of(damped, true, false))),
             ContainsSubstring("looks back over the increment"));

  GradientQuery still;
  still.outputs = {Output::node(block.body, 0, {1, 0, 0})};
  still.parameters = {Parameter::initial_velocity(block.body, {})};
  Block balanced = make_block({}, kind);
  still.outputs[0].body = still.parameters[0].body = balanced.body;
  CHECK_THAT(refusal(balanced.world.gradients(still)), ContainsSubstring("no velocity to begin with"));
}
