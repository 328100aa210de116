// Gradients of what is seen on a way through time. The judge builds the scene anew with the parameter moved,
// goes the same way to the last digits and takes differences.
#include <limits>

#include "engine/step/time_scheme.h"
#include "engine/world/revolve.h"
#include "support/derivative_lists.h"

using namespace test;
using Catch::Matchers::WithinAbs;
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

// What is refused where a material remembers.
bool is_of_springs(const Output& output) {
  const std::string& part = output.quantity;
  return output.kind == Output::Kind::stress ||
         (output.kind == Output::Kind::energy &&
          (part == "elastic" || part == "potential" || part == "total"));
}

// What is of an increment belongs to where that is evaluated, which the midpoint rule does not do at its end.
std::vector<std::pair<std::string, TimedOutput>> named_outputs(const Block& block, bool at_ends, bool moves) {
  const Index tip = nearest_node(block.world.rest_positions(block.body), {1, 1, 1});
  const Index next = nearest_node(block.world.rest_positions(block.body), {1, 0, 1});
  std::vector<std::pair<std::string, TimedOutput>> out{
      {"node", {{{4, Output::node(block.body, tip, {0.3, -0.2, 1})}}}},
      {"point", {{{2, Output::material_point(block.body, {0.9, 0.4, 0.8}, {0, 1, 1})}}}},
      {"target over time",
       {{{1, Output::distance(block.body, {tip, next}, {{1.1, 1, 1.2}, {1, 0.1, 1}})},
         {3, Output::distance(block.body, {tip}, {{1, 1, 1.3}})},
         {4, Output::distance(block.body, {tip, next}, {{1.1, 1, 1.2}, {1, 0.1, 1}})}}}},
      {"start and end",
       {{{0, Output::node(block.body, tip, {1, 1, 1})}, {4, Output::node(block.body, next, {0, 0, 1})}}}},
      {"squares",
       {{{2, Output::square(block.body, {tip}, {{0, 1, 1}}, 0.7)},
         {4, Output::square(block.body, {next}, {{1, 0, 1}}, 0.2)}}}},
      {"functions", {{{0, spread(block.body)}, {3, spread(block.body)}}}}};
  if (!at_ends) return out;
  Index step = 0;
  TimedOutput sum;  // several of them at one step
  const bool remembers = block.knobs.ratio > 0;
  for (auto& [name, output] : measures_of(block)) {
    if (remembers && is_of_springs(output)) continue;
    step = step % 4 + 1;
    if (output.kind == Output::Kind::gauge) sum.terms.push_back({3, output});
    out.push_back({name, {{{step, output}}}});
  }
  out.push_back({"gauges", sum});
  if (!moves) return out;
  for (const char* part : {"kinetic", "total"}) {
    if (remembers && is_of_springs(Output::energy(part))) continue;
    out.push_back({std::string("energy, ") + part, {{{2, Output::energy(part)}, {4, Output::energy(part)}}}});
  }
  return out;
}

std::vector<TimedOutput> outputs_of(const Block& block, bool at_ends, bool moves) {
  std::vector<TimedOutput> out;
  for (auto& [name, one] : named_outputs(block, at_ends, moves)) out.push_back(std::move(one));
  return out;
}

std::vector<Asked> parameters_of(const Block& block, bool moves) {
  std::vector<Asked> out = test::parameters_of(block);
  if (moves)
    out.push_back({"velocity",
                   Parameter::initial_velocity(block.body, shape_motion(block.world.mesh(block.body))),
                   &Knobs::velocity});
  return out;
}

TrajectoryQuery query_of(const Block& block, bool at_ends = true, bool moves = true) {
  TrajectoryQuery query;
  query.steps = kSteps;
  query.outputs = outputs_of(block, at_ends, moves);
  for (const Asked& a : parameters_of(block, moves)) query.parameters.push_back(a.parameter);
  return query;
}

void check_list(const Knobs& knobs, const Kind& kind, const SchemePtr& scheme) {
  const bool at_ends = scheme->evaluated_at() == 1, moves = scheme->has_inertia();
  Block block = build_block(knobs, kind, tight(scheme));
  TrajectoryQuery query = query_of(block, at_ends, moves);
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
  for (std::size_t j = 0; j < query.outputs.size(); ++j)
    CHECK_THAT(adjoint.values[j], WithinAbs(tangent.values[j], 1e-14 + 1e-12 * std::abs(tangent.values[j])));
  std::vector<std::string> names;
  for (const auto& [name, output] : named_outputs(block, at_ends, moves)) names.push_back(name);
  // Next to inertia in a short step rows are soft sooner.
  check_all(knobs, names, parameters_of(block, moves), {adjoint, tangent}, 1e-4, [&](const Knobs& moved) {
    Block other = build_block(moved, kind, tight(scheme));
    TrajectoryQuery there;
    there.steps = kSteps;
    there.outputs = outputs_of(other, at_ends, moves);
    return value(other.world.trajectory_gradients(there)).values;
  });
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
    // Cables must be met at the end of a step.
    const bool pulled = scheme->evaluated_at() == 1;
    check_list(knobs,
               {isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure, 0, pulled, true},
               scheme);
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

TEST_CASE("damping looks back over an increment, and gradients with it", "[gradients]") {
  for (const SchemePtr& scheme :
       {isochor::implicit_euler(), isochor::implicit_midpoint(), isochor::generalized_alpha(0.6)}) {
    for (const auto element : {isochor::Element::tet4_edge_smoothed, isochor::Element::tet10}) {
      CAPTURE(std::string(scheme->name()), name_of(element));
      Knobs knobs = moving(0.45);
      knobs.viscosity = 40;
      knobs.drag = 3;
      check_list(knobs, {element, VolumeSpace::node, isochor::CavityControl::pressure, 0, false}, scheme);
    }
  }
}

TEST_CASE("a viscoelastic material remembers, and gradients with it", "[gradients][memory]") {
  for (const auto element : kAllElements) {
    for (const double poisson : {0.3, 0.5}) {
      if (poisson < 0.5 && element != isochor::Element::tet4) continue;  // minutes otherwise
      CAPTURE(name_of(element), poisson);
      Knobs knobs = moving(poisson);
      knobs.ratio = 0.4;
      check_list(knobs, {element, VolumeSpace::node, isochor::CavityControl::pressure}, isochor::bdf2());
    }
  }
}

TEST_CASE("the same with other schemes, and in statics of seconds", "[gradients][memory]") {
  for (const SchemePtr& scheme :
       {isochor::implicit_euler(), isochor::generalized_alpha(0.6), isochor::newmark(), isochor::statics()}) {
    CAPTURE(std::string(scheme->name()));
    Knobs knobs = moving(0.45);
    knobs.ratio = 0.4;
    if (!scheme->has_inertia()) knobs.velocity = 0;
    check_list(knobs,
               {isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure, 0, true, true},
               scheme);
  }
}

namespace {

// The least number of steps to make again, by trying every place for the next state to keep.
Index fewest_again(Index steps, Index free, std::map<std::pair<Index, Index>, Index>& known) {
  if (steps <= 1) return 0;
  if (free == 0) return steps * (steps - 1) / 2;
  const auto [found, is_new] = known.try_emplace({steps, free}, std::numeric_limits<Index>::max());
  if (!is_new) return found->second;
  Index best = std::numeric_limits<Index>::max();
  for (Index m = 1; m < steps; ++m)
    best = std::min(best, m + fewest_again(steps - m, free - 1, known) + fewest_again(m, free, known));
  return known[{steps, free}] = best;
}

Index by_plan(Index steps, Index free) {
  if (steps <= 1) return 0;
  if (free == 0) return steps * (steps - 1) / 2;
  const Index m = isochor::steps_to_keep(steps, free);
  REQUIRE(m >= 1);
  REQUIRE(m < steps);
  return m + by_plan(steps - m, free - 1) + by_plan(m, free);
}

}  // namespace

TEST_CASE("as few steps are made again as so many states allow", "[gradients]") {
  std::map<std::pair<Index, Index>, Index> known;
  for (Index steps = 1; steps <= 70; ++steps) {
    for (Index free = 0; free <= 9; ++free) {
      CAPTURE(steps, free);
      CHECK(by_plan(steps, free) == fewest_again(steps, free, known));
    }
  }
}

TEST_CASE("states that are made again change no gradient, and are as few as said", "[gradients]") {
  const Kind kind{isochor::Element::tet4, VolumeSpace::node, isochor::CavityControl::pressure};
  const std::vector<double> steps{0.05, 0.03, 0.05, 0.04, 0.03, 0.05, 0.04, 0.03, 0.05};
  const auto count = static_cast<Index>(steps.size());
  std::map<std::pair<Index, Index>, Index> known;
  for (const auto mode : {GradientQuery::Mode::adjoint, GradientQuery::Mode::tangent}) {
    std::vector<Gradients> all;
    for (const Index kept : {0, 1, 2, 3, 8, 20}) {
      CAPTURE(kept);
      Block block = build_block(moving(0.5), kind, tight(isochor::bdf2()));
      TrajectoryQuery query = query_of(block);
      query.steps = steps;
      query.mode = mode;
      query.kept_states = kept;
      const Gradients g = value(block.world.trajectory_gradients(query));
      if (mode == GradientQuery::Mode::adjoint) {
        const Index most = kept == 0 ? count - 1 : std::min(kept, count - 1);
        CHECK(g.kept_states == most);
        // The way itself is gone once in any case.
        CHECK(g.steps_again == fewest_again(count, most, known) - (count - 1));
      } else {
        CHECK(g.kept_states == 0);
        CHECK(g.steps_again == 0);
      }
      // Positions and velocities at least.
      CHECK(g.state_bytes >= 48 * block.world.positions(block.body).size());
      all.push_back(g);
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
  TrajectoryQuery query = query_of(block);
  (void)value(block.world.trajectory_gradients(query));
  for (const double h : kSteps) CHECK(plain.world.step(h).status == isochor::StepStatus::converged);
  CHECK(block.world.state_hash() == plain.world.state_hash());
  CHECK(block.world.time() == plain.world.time());

  // Outputs of its end are what the world says there.
  const auto cell = static_cast<Index>(block.world.mesh(block.body).cell_count() / 2);
  const isochor::Energies e = plain.world.energies();
  Block again = build_block(moving(0.3), kind, tight(isochor::generalized_alpha(0.8)));
  const auto at_end = static_cast<Index>(kSteps.size());
  TrajectoryQuery ends;
  ends.steps = kSteps;
  ends.outputs = {{{{at_end, Output::reaction(again.clamp, {1, 0, 0})}}},
                  {{{at_end, Output::stress(again.body, cell, "von_mises")}}},
                  {{{at_end, Output::energy("kinetic")}}},
                  {{{at_end, Output::energy("total")}}}};
  const std::vector<double> told = value(again.world.trajectory_gradients(ends)).values;
  const std::vector<double> wanted{
      plain.world.reaction(plain.clamp)[0].x,
      plain.world.fields(plain.body).cell_von_mises[static_cast<std::size_t>(cell)], e.kinetic, e.total()};
  for (std::size_t j = 0; j < wanted.size(); ++j) {
    CAPTURE(j);
    CHECK(wanted[j] != 0);
    CHECK_THAT(told[j], WithinAbs(wanted[j], 1e-9 * std::abs(wanted[j])));
  }
}

TEST_CASE("stiffnesses of cells add up to that of the body", "[gradients]") {
  const Kind kind{isochor::Element::tet4_edge_smoothed, VolumeSpace::node, isochor::CavityControl::pressure};
  Block block = build_block(moving(0.45), kind, tight(isochor::bdf2()));
  TrajectoryQuery query = query_of(block);
  query.parameters = {Parameter::cell_stiffness(block.body), Parameter::stiffness(block.body)};
  const Gradients g = value(block.world.trajectory_gradients(query));
  CHECK(g.adjoint);
  for (std::size_t j = 0; j < query.outputs.size(); ++j) {
    double sum = 0, size = 0;
    for (const double v : g.by[j][0]) sum += v, size += std::abs(v);
    // A pressure that is given stays as it is.
    if (named_outputs(block, true, true)[j].first != "pressure") CHECK(size > 0);
    CHECK_THAT(sum, WithinAbs(g.of(j, 1), 1e-11 * size));
  }
}

// A mass on a spring is x'' = -w^2 x; here a bar that is stretched by its own inertia, as small as to be
// linear.
TEST_CASE("a body that flies moves with its velocity and falls with gravity", "[gradients]") {
  for (const auto& scheme : {isochor::bdf2(), isochor::newmark(), isochor::implicit_midpoint()}) {
    isochor::WorldOptions options = dynamic_options();
    options.scheme = scheme;
    World world = make_world(options);
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
    TrajectoryQuery query = query_of(block);
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
  CHECK_THAT(refused([](TrajectoryQuery& q) {
               q.outputs[0].terms[0] = {0, Output::elastic_energy()};
             }),
             ContainsSubstring("outputs[0]: all but functions of positions"));
  CHECK_THAT(refused([](TrajectoryQuery& q) { q.outputs[0].terms[0].output = Output::energy("heat"); }),
             ContainsSubstring("outputs[0]: there is no energy \"heat\""));
  CHECK_THAT(refused([&](TrajectoryQuery& q) {
               q.parameters = {Parameter::initial_velocity(block.body, {{1, 0, 0}})};
             }),
             ContainsSubstring("parameters[0]: initial_velocity: motion has 1 vectors"));
  CHECK_THAT(refused([&](TrajectoryQuery& q) {
               q.parameters = {Parameter::cell_stiffness(block.body)};
               q.mode = GradientQuery::Mode::tangent;
             }),
             ContainsSubstring("adjoint"));

  // What of a memory is not followed.
  Knobs fading = moving(0.3);
  fading.ratio = 0.4;
  Block faded = build_block(fading, kind, tight(isochor::implicit_euler()));
  TrajectoryQuery of_memory = query_of(faded);
  of_memory.outputs.push_back({{{1, Output::elastic_energy()}}});
  CHECK_THAT(refusal(faded.world.trajectory_gradients(of_memory)),
             ContainsSubstring("elastic energies of materials that remember"));
  of_memory.outputs.pop_back();
  of_memory.parameters = {Parameter::cell_stiffness(faded.body)};
  CHECK_THAT(refusal(faded.world.trajectory_gradients(of_memory)),
             ContainsSubstring("parameters[0]: factors on the stiffness"));

  // What lags behind.
  Block rubbed = build_block(moving(0.3), kind, tight(isochor::implicit_euler()));
  isochor::ContactDef floor;
  floor.body = rubbed.body;
  floor.surfaces = {"z0"};
  floor.obstacle.position = {0, 0, -0.01};
  floor.friction = 0.3;
  value(rubbed.world.add(isochor::contact(floor)));
  CHECK_THAT(refusal(rubbed.world.trajectory_gradients(query_of(rubbed))),
             ContainsSubstring("friction") && ContainsSubstring("leave it out"));

  GradientQuery still;
  still.outputs = {Output::node(block.body, 0, {1, 0, 0})};
  still.parameters = {Parameter::initial_velocity(block.body, {})};
  Block balanced = make_block({}, kind);
  still.outputs[0].body = still.parameters[0].body = balanced.body;
  CHECK_THAT(refusal(balanced.world.gradients(still)), ContainsSubstring("no velocity to begin with"));
}
