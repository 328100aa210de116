// Gradients of what is seen on a way through time.
//
// Every increment solves R(z; y, p) = 0 for z = (x, lambda) where it is evaluated, from what came before,
// y = (positions, velocities, what the scheme keeps), and goes on to y' = A y + B x: time schemes are linear
// maps of each node (integrators/), with coefficients that follow from the scheme itself (StepMap). Inertia
// in R is s M (x - P y). So, for an output J:
//
//   adjoint   backward: with y_bar' = dJ/dy' of what comes after and of outputs there, solve
//             A(z) a = (B^T y_bar', dJ/dlambda); then dJ/dp -= a . dR/dp and
//             y_bar = A^T y_bar' + P^T (s M a)
//   tangent   forward: solve A(z) dz = -dR/dp + s M P dy; then dy' = A dy + B dx
//
// Each increment is linearized where it was solved, by its own matrix, as World::gradients() does (the
// outline stands there). States of the way are kept, or made again from those that are
// (TrajectoryQuery::kept_states).
#include <algorithm>
#include <cmath>

#include "engine/base/out_of_memory.h"
#include "engine/base/text.h"
#include "engine/step/time_scheme.h"
#include "engine/world/gradient_parts.h"

namespace isochor {

namespace {

// What an increment begins with, or how an output depends on it: positions, velocities and the lists that the
// scheme keeps, one vector a node each.
using Lists3 = std::vector<std::vector<Vec3>>;

Lists3 zeros(std::size_t lists, std::size_t nodes) {
  return Lists3(lists, std::vector<Vec3>(nodes));
}

void add_to(std::vector<Vec3>& sum, double factor, std::span<const Vec3> other) {
  for (std::size_t i = 0; factor != 0 && i < sum.size(); ++i) sum[i] += factor * other[i];
}

// The scheme of one increment as numbers.
struct StepMap {
  double mass_scale = 0;
  std::vector<double> predicted;            // P: by list
  std::vector<std::vector<double>> before;  // A: [list after][list before]
  std::vector<double> found;                // B: by list after
};

// Asks the scheme about a single node whose lists are zero but for one.
StepMap step_map(const TimeScheme& scheme, std::span<const double> memory, double t, double h) {
  const SchemeMemory kept = scheme.memory();
  const std::size_t lists = 2 + kept.vectors;
  StepMap map;
  map.predicted.resize(lists);
  map.found.resize(lists);
  map.before.assign(lists, std::vector<double>(lists));
  std::vector<double> numbers(kept.numbers(1), 0.0);
  const auto take = [&](std::size_t one, double found) {
    State node;
    node.t = t;
    node.x.resize(1);
    node.v.resize(1);
    std::fill(numbers.begin(), numbers.end(), 0.0);
    std::copy_n(memory.begin(), kept.before, numbers.begin());
    std::copy_n(memory.end() - static_cast<std::ptrdiff_t>(kept.after), kept.after,
                numbers.end() - static_cast<std::ptrdiff_t>(kept.after));
    if (one == 0) node.x[0].x = 1;
    if (one == 1) node.v[0].x = 1;
    if (one > 1 && one < lists) numbers[kept.before + 3 * (one - 2)] = 1;
    std::vector<Vec3> predicted(1);
    map.mass_scale = scheme.begin(node, numbers, h, predicted);
    if (one < lists) map.predicted[one] = predicted[0].x;
    const std::vector<Vec3> x{{found, 0, 0}};
    scheme.finish(h, x, predicted, node, numbers);
    std::vector<double> after{node.x[0].x, node.v[0].x};
    for (std::size_t k = 0; k < kept.vectors; ++k) after.push_back(numbers[kept.before + 3 * k]);
    return after;
  };
  for (std::size_t one = 0; one < lists; ++one) {
    const auto after = take(one, 0);
    for (std::size_t k = 0; k < lists; ++k) map.before[k][one] = after[k];
  }
  map.found = take(lists, 1);
  return map;
}

}  // namespace

class World::Impl::Trajectory {
 public:
  Trajectory(World& world, const TrajectoryQuery& query) : world_(world), w_(*world.impl_), query_(query) {}

  Result<void> check();
  Result<void> go();
  Result<Gradients> gradients();
  // To where it ended, or, where it did not, to where it began.
  void leave();

 private:
  // An increment that was made, looked at where it was evaluated.
  struct Increment {
    StepMap map;
    Inertia inertia;
  };
  Index steps() const { return static_cast<Index>(query_.steps.size()); }
  bool ends_there() const { return w_.options.scheme->evaluated_at() == 1; }
  Result<void> check_parameters() const;
  Result<void> check_outputs() const;
  Result<void> looks_back();
  Result<void> make_step(Index n);
  Result<void> remake(Index first);
  void stand_at(const State& state, const State& memory_of);
  Increment stand_in(Index n);
  Result<std::vector<OutputSeed>> seeds_at(Equilibrium& eq, Index n, Gradients& out);
  std::vector<GaugeName> gauges_of(Index n) const;
  Result<void> by_adjoint(Gradients& out);
  Result<void> by_tangent(Gradients& out);
  // What an increment adds to the gradients by the adjoint of output j.
  Result<void> gather(Equilibrium& eq, std::size_t j, const OutputSeed& seed, const Adjoint& adjoint,
                      std::span<const Equations> change, Gradients& out) const;
  Result<std::vector<Equations>> changes(Equilibrium& eq) const;
  std::vector<Vec3> in_scene(const Parameter& p) const;
  std::vector<Vec3> heavy(double factor, std::span<const Vec3> v) const;
  // Rows that are about to touch or to let go, where an increment was evaluated.
  void look_for_edges(Index n, Gradients& out) const;
  // Visits increments from the last to the first, or the other way.
  template <class Visit>
  Result<void> each(bool backward, Visit&& visit);
  Index spacing() const;

  World& world_;
  Impl& w_;
  const TrajectoryQuery& query_;
  std::vector<std::byte> start_, end_;
  std::vector<std::vector<std::byte>> kept_;  // at every spacing() steps, but the first
  std::vector<State> part_;                   // states from part_first_ on
  Index part_first_ = 0;
  std::size_t lists_ = 2;
};

namespace {

// Of messages of the other query.
std::string without_call(const std::string& text) {
  constexpr std::string_view call = "gradients: ";
  return text.starts_with(call) ? text.substr(call.size()) : text;
}

Error trajectory_error(const std::string& text) {
  return Error{"trajectory_gradients: " + without_call(text)};
}

Error in_step(Index n, const std::string& text) {
  return trajectory_error("step " + std::to_string(n) + ": " + without_call(text));
}

}  // namespace

Result<void> World::Impl::Trajectory::check() {
  if (query_.steps.empty()) return trajectory_error("steps is empty; give the length of each increment");
  for (std::size_t k = 0; k < query_.steps.size(); ++k) {
    if (!(query_.steps[k] > 0) || !std::isfinite(query_.steps[k])) {
      return trajectory_error("steps[" + std::to_string(k) + "] = " + number(query_.steps[k]) +
                              " s; give a positive number");
    }
  }
  if (query_.kept_states < 0)
    return trajectory_error("kept_states = " + std::to_string(query_.kept_states) +
                            "; give how many, or 0 for all");
  if (w_.settled) return trajectory_error("the state is unfinished; take a step without a budget first");
  const SystemFacets& facets = w_.system().facets();
  const char* why = nullptr;
  if (!facets.lagged.empty()) why = "friction, or a pressure on faces with a free rim, lags behind";
  if (!facets.impacts.empty()) why = "contact with a rebound lets velocities jump";
  if (!facets.renewed.empty()) why = "contact on surfaces renews its rows";
  if (!facets.remembering_rows.empty())
    why = "gas and liquid in chambers remember what they were filled with";
  if (!facets.remembering.empty()) why = "a material remembers what came before";
  if (why)
    return trajectory_error(std::string(why) +
                            ", which gradients of trajectories do not follow; leave it out");
  if (auto r = check_outputs(); !r) return r;
  if (auto r = check_parameters(); !r) return r;
  lists_ = 2 + w_.options.scheme->memory().vectors;
  return {};
}

Result<void> World::Impl::Trajectory::check_outputs() const {
  for (std::size_t j = 0; j < query_.outputs.size(); ++j) {
    const std::string who = "outputs[" + std::to_string(j) + "]";
    if (query_.outputs[j].terms.empty()) return trajectory_error(who + " has no terms; give one at least");
    for (const TimedOutput::Term& term : query_.outputs[j].terms) {
      if (term.step < 0 || term.step > steps()) {
        return trajectory_error(who + ": step = " + std::to_string(term.step) +
                                "; the trajectory has steps 0 to " + std::to_string(steps()));
      }
      const Output::Kind kind = term.output.kind;
      if (kind == Output::Kind::reaction || kind == Output::Kind::energy)
        return trajectory_error(who +
                                ": reactions and energies are those of equilibria; take positions, "
                                "distances or gauges");
      if (kind != Output::Kind::gauge) continue;
      if (auto r = world_.check(term.output.effect); !r) return trajectory_error(who + ": " + r.error());
      if (!ends_there() || term.step == 0)
        return trajectory_error(who +
                                ": gauges belong to where an increment is evaluated, which the scheme does "
                                "in its middle, or to no increment at step 0; take positions");
    }
  }
  return {};
}

Result<void> World::Impl::Trajectory::check_parameters() const {
  for (std::size_t k = 0; k < query_.parameters.size(); ++k) {
    const Parameter& p = query_.parameters[k];
    if (p.kind == Parameter::Kind::amount || p.kind == Parameter::Kind::constant) {
      if (auto r = world_.check(p.effect); !r)
        return trajectory_error("parameters[" + std::to_string(k) + "]: " + r.error());
    }
    if (p.kind == Parameter::Kind::cells && query_.mode == GradientQuery::Mode::tangent)
      return trajectory_error(
          "cell_stiffness is a number a cell, and tangents would solve as often; ask by "
          "the adjoint");
  }
  return {};
}

// Whether forces depend on where an increment began otherwise than by inertia: damping does.
Result<void> World::Impl::Trajectory::looks_back() {
  if (!w_.options.scheme->has_inertia()) return {};
  Increment first = stand_in(1);
  std::vector<Vec3> before(first.inertia.increment.before.begin(), first.inertia.increment.before.end());
  Equilibrium here(w_, &first.inertia);
  const auto force = [&] {
    return equations_at({w_.system(), w_.assembly(), *w_.data, w_.instances, &first.inertia}, w_.state, {})
        .force;
  };
  const auto as_it_is = force();
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double far = 1e-3 * w_.system().length();
    before[i] += far * Vec3{i % 2 ? 1.0 : -1.0, i % 3 ? 0.5 : -1.0, i % 5 ? 0.25 : -0.5};
  }
  first.inertia.increment.before = before;
  if (force() == as_it_is) return {};
  return trajectory_error(
      "an effect looks back over the increment, as damping does, which gradients of "
      "trajectories do not follow; leave it out");
}

// --- The way -----------------------------------------------------------------------------------------------

Index World::Impl::Trajectory::spacing() const {
  if (query_.kept_states == 0) return steps();
  return std::max<Index>(1, (steps() + query_.kept_states - 1) / query_.kept_states);
}

Result<void> World::Impl::Trajectory::make_step(Index n) {
  const StepReport report = world_.step(query_.steps[at(n - 1)]);
  if (report.status == StepStatus::converged) return {};
  return trajectory_error("steps[" + std::to_string(n - 1) + "] = " + number(query_.steps[at(n - 1)]) +
                          " s: " + report.reason + "; take shorter steps");
}

Result<void> World::Impl::Trajectory::go() {
  start_ = world_.save();
  const Index every = spacing();
  part_ = {w_.state};
  for (Index n = 1; n <= steps(); ++n) {
    if (auto r = make_step(n); !r) return r;
    if (n % every == 0 && n < steps()) {
      kept_.push_back(world_.save());
      part_first_ = n;
      part_.clear();
    }
    part_.push_back(w_.state);
  }
  end_ = world_.save();
  return looks_back();
}

// The states from a kept one to the next.
Result<void> World::Impl::Trajectory::remake(Index first) {
  if (first == part_first_) return {};
  const Index every = spacing();
  const auto& from = first == 0 ? start_ : kept_[at(first / every - 1)];
  if (auto r = world_.load(from); !r) return trajectory_error(r.error());
  part_first_ = first;
  part_ = {w_.state};
  for (Index n = first + 1; n <= std::min(first + every, steps()); ++n) {
    if (auto r = make_step(n); !r) return r;
    part_.push_back(w_.state);
  }
  return {};
}

template <class Visit>
Result<void> World::Impl::Trajectory::each(bool backward, Visit&& visit) {
  const Index every = spacing(), parts = (steps() + every - 1) / every;
  for (Index k = 0; k < parts; ++k) {
    const Index first = every * (backward ? parts - 1 - k : k);
    if (auto r = remake(first); !r) return r;
    const Index count = std::min(every, steps() - first);
    for (Index i = 0; i < count; ++i) {
      if (auto r = visit(first + 1 + (backward ? count - 1 - i : i)); !r) return r;
    }
  }
  return {};
}

// Numbers alone: views of a host stay where they are.
void World::Impl::Trajectory::stand_at(const State& state, const State& memory_of) {
  w_.state.t = state.t;
  std::copy(state.x.begin(), state.x.end(), w_.state.x.begin());
  std::copy(state.v.begin(), state.v.end(), w_.state.v.begin());
  w_.state.lambda = state.lambda;
  w_.state.extra = memory_of.extra;
  w_.state.forces = state.forces;
  w_.state.reactions = state.reactions;
}

// Where increment n was evaluated.
World::Impl::Trajectory::Increment World::Impl::Trajectory::stand_in(Index n) {
  const State &before = part_[at(n - 1 - part_first_)], &after = part_[at(n - part_first_)];
  const TimeScheme& scheme = *w_.options.scheme;
  const double h = query_.steps[at(n - 1)], part = scheme.evaluated_at();
  State past = before;
  const std::span<const double> memory = w_.layout.of_scheme(past.extra);
  Increment out;
  out.map = step_map(scheme, memory, before.t, h);
  out.inertia.predicted.resize(before.x.size());
  out.inertia.mass_scale = scheme.begin(before, memory, h, out.inertia.predicted);
  stand_at(after, before);
  for (std::size_t i = 0; part != 1 && i < before.x.size(); ++i)
    w_.state.x[i] = before.x[i] + part * (after.x[i] - before.x[i]);
  w_.state.t = before.t + part * h;
  const double passed = out.inertia.mass_scale > 0 ? part * h : 0;
  out.inertia.increment = {passed, before.x, before.t, w_.state.t};
  return out;
}

void World::Impl::Trajectory::leave() {
  const auto& to = end_.empty() ? start_ : end_;
  if (!to.empty()) (void)world_.load(to);
}

// --- Outputs and parameters
// ----------------------------------------------------------------------------------

std::vector<GaugeName> World::Impl::Trajectory::gauges_of(Index n) const {
  std::vector<GaugeName> out;
  for (const TimedOutput& o : query_.outputs) {
    for (const TimedOutput::Term& term : o.terms) {
      if (term.step == n && term.output.kind == Output::Kind::gauge)
        out.push_back({static_cast<Index>(term.output.effect), term.output.quantity});
    }
  }
  return out;
}

// What each output has at the end of a step, zero where it has nothing. Leaves the world at that end.
Result<std::vector<OutputSeed>> World::Impl::Trajectory::seeds_at(Equilibrium& eq, Index n, Gradients& out) {
  const State& end = part_[at(n - part_first_)];
  std::vector<OutputSeed> seeds(query_.outputs.size());
  for (std::size_t j = 0; j < seeds.size(); ++j) {
    OutputSeed& sum = seeds[j];
    sum.x.resize(end.x.size());
    sum.through.resize(end.x.size());
    sum.multiplier.resize(end.lambda.size());
    for (const TimedOutput::Term& term : query_.outputs[j].terms) {
      if (term.step != n) continue;
      stand_at(end, end);
      auto seed = eq.seed_of(term.output);
      if (!seed) return trajectory_error("outputs[" + std::to_string(j) + "]: " + without_call(seed.error()));
      out.values[j] += seed.value().value;
      add_to(sum.x, 1, seed.value().x);
      for (std::size_t r = 0; r < sum.multiplier.size(); ++r) sum.multiplier[r] += seed.value().multiplier[r];
      if (seed.value().gauge >= 0 && sum.gauge >= 0)
        return trajectory_error("outputs[" + std::to_string(j) +
                                "]: two gauges at one step; make them outputs of their own and add them up");
      sum.gauge = std::max(sum.gauge, seed.value().gauge);
    }
  }
  return seeds;
}

Result<std::vector<Equations>> World::Impl::Trajectory::changes(Equilibrium& eq) const {
  std::vector<Equations> out;
  for (std::size_t k = 0; k < query_.parameters.size(); ++k) {
    if (query_.parameters[k].kind == Parameter::Kind::cells) {
      out.emplace_back();
      continue;
    }
    auto change = eq.change_by(query_.parameters[k]);
    if (!change)
      return trajectory_error("parameters[" + std::to_string(k) + "]: " + without_call(change.error()));
    out.push_back(std::move(change).value());
  }
  return out;
}

// The motion of a parameter at the start, over all nodes of the scene; zero of those without one.
std::vector<Vec3> World::Impl::Trajectory::in_scene(const Parameter& p) const {
  std::vector<Vec3> out(w_.state.x.size());
  if (p.kind != Parameter::Kind::shape && p.kind != Parameter::Kind::velocity) return out;
  const Index first = w_.said.builder.body(p.body).first_node;
  for (std::size_t i = 0; i < p.motion.size(); ++i) out[at(first) + i] = p.motion[i];
  return out;
}

std::vector<Vec3> World::Impl::Trajectory::heavy(double factor, std::span<const Vec3> v) const {
  std::vector<Vec3> out(v.size());
  if (factor == 0) return out;
  w_.assembly().mass_times(v, out);
  for (Vec3& m : out) m = factor * m;
  return out;
}

Result<void> World::Impl::Trajectory::gather(Equilibrium& eq, std::size_t j, const OutputSeed& seed,
                                             const Adjoint& adjoint, std::span<const Equations> change,
                                             Gradients& out) const {
  for (std::size_t k = 0; k < query_.parameters.size(); ++k) {
    const Parameter& p = query_.parameters[k];
    std::vector<double>& sum = out.by[j][k];
    if (p.kind == Parameter::Kind::cells) {
      auto cells = eq.by_cells(seed, adjoint, p.body);
      if (!cells)
        return trajectory_error("parameters[" + std::to_string(k) + "]: " + without_call(cells.error()));
      sum.resize(cells.value().size());
      for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += cells.value()[c];
    } else {
      sum.resize(1);
      sum[0] += eq.by_adjoint(seed, adjoint, change[k]);
    }
  }
  return {};
}

// --- The two ways
// -----------------------------------------------------------------------------------------------

Result<void> World::Impl::Trajectory::by_adjoint(Gradients& out) {
  const std::size_t nodes = w_.state.x.size(), outputs = query_.outputs.size();
  std::vector<Lists3> felt(outputs, zeros(lists_, nodes));  // dJ/dy behind the increment at hand
  auto done = each(true, [&](Index n) -> Result<void> {
    Increment increment = stand_in(n);
    const StepMap& map = increment.map;
    Equilibrium eq(w_, &increment.inertia);
    eq.gauges = gauges_of(n);
    auto seeds = seeds_at(eq, n, out);
    if (!seeds) return seeds.failure();
    stand_in(n);
    if (auto r = eq.linearize(true); !r) return in_step(n, r.error());
    auto change = changes(eq);
    if (!change) return change.failure();
    for (std::size_t j = 0; j < outputs; ++j) {
      OutputSeed& seed = seeds.value()[j];
      add_to(felt[j][0], 1, seed.x);
      std::fill(seed.x.begin(), seed.x.end(), Vec3{});
      for (std::size_t k = 0; k < lists_; ++k) add_to(seed.x, map.found[k], felt[j][k]);
      const auto adjoint = eq.adjoint_of(seed);
      if (!adjoint) return in_step(n, adjoint.error());
      if (auto r = gather(eq, j, seed, adjoint.value(), change.value(), out); !r) return r;
      const auto pull = heavy(map.mass_scale, adjoint.value().force);
      Lists3 before = zeros(lists_, nodes);
      for (std::size_t b = 0; b < lists_; ++b) {
        for (std::size_t k = 0; k < lists_; ++k) add_to(before[b], map.before[k][b], felt[j][k]);
        add_to(before[b], map.predicted[b], pull);
      }
      felt[j] = std::move(before);
    }
    look_for_edges(n, out);
    return {};
  });
  if (!done) return done;
  Equilibrium eq(w_);
  auto seeds = seeds_at(eq, 0, out);
  if (!seeds) return seeds.failure();
  for (std::size_t j = 0; j < outputs; ++j) {
    add_to(felt[j][0], 1, seeds.value()[j].x);
    for (std::size_t k = 0; k < query_.parameters.size(); ++k) {
      const Parameter& p = query_.parameters[k];
      if (p.kind != Parameter::Kind::shape && p.kind != Parameter::Kind::velocity) continue;
      const auto motion = in_scene(p);
      const auto& list = felt[j][p.kind == Parameter::Kind::shape ? 0 : 1];
      for (std::size_t i = 0; i < motion.size(); ++i) out.by[j][k][0] += dot(list[i], motion[i]);
    }
  }
  return {};
}

Result<void> World::Impl::Trajectory::by_tangent(Gradients& out) {
  const std::size_t nodes = w_.state.x.size(), parameters = query_.parameters.size();
  std::vector<Lists3> moved(parameters, zeros(lists_, nodes));  // dy/dp before the increment at hand
  for (std::size_t k = 0; k < parameters; ++k) {
    const bool velocity = query_.parameters[k].kind == Parameter::Kind::velocity;
    moved[k][velocity ? 1 : 0] = in_scene(query_.parameters[k]);
    for (auto& by : out.by) by[k].assign(1, 0.0);
  }
  const auto see = [&](std::span<const OutputSeed> seeds, std::size_t k, std::span<const Vec3> x,
                       std::span<const double> lambda, const Equations* change) {
    for (std::size_t j = 0; j < seeds.size(); ++j) {
      double sum = change ? Equilibrium::held(seeds[j], *change) : 0;
      for (std::size_t i = 0; i < x.size(); ++i) sum += dot(seeds[j].x[i], x[i]);
      for (std::size_t r = 0; r < lambda.size(); ++r) sum += seeds[j].multiplier[r] * lambda[r];
      out.by[j][k][0] += sum;
    }
  };
  return each(false, [&](Index n) -> Result<void> {
    if (n == 1) {
      Equilibrium start(w_);
      auto seeds = seeds_at(start, 0, out);
      if (!seeds) return seeds.failure();
      for (std::size_t k = 0; k < parameters; ++k) see(seeds.value(), k, moved[k][0], {}, nullptr);
    }
    Increment increment = stand_in(n);
    const StepMap& map = increment.map;
    Equilibrium eq(w_, &increment.inertia);
    eq.gauges = gauges_of(n);
    auto seeds = seeds_at(eq, n, out);
    if (!seeds) return seeds.failure();
    stand_in(n);
    if (auto r = eq.linearize(true); !r) return in_step(n, r.error());
    auto change = changes(eq);
    if (!change) return change.failure();
    for (std::size_t k = 0; k < parameters; ++k) {
      std::vector<Vec3> carried(nodes);
      for (std::size_t b = 0; b < lists_; ++b) add_to(carried, map.predicted[b], moved[k][b]);
      std::vector<Vec3> load = heavy(map.mass_scale, carried);
      std::vector<double> row(change.value()[k].theta);
      for (double& r : row) r = -r;
      add_to(load, -1, change.value()[k].force);
      if (auto r = eq.solve(load, row, eq.way_of(change.value()[k].position)); !r)
        return in_step(n, r.error());
      Lists3 after = zeros(lists_, nodes);
      for (std::size_t a = 0; a < lists_; ++a) {
        for (std::size_t b = 0; b < lists_; ++b) add_to(after[a], map.before[a][b], moved[k][b]);
        add_to(after[a], map.found[a], eq.dx);
      }
      moved[k] = std::move(after);
      see(seeds.value(), k, moved[k][0], eq.dlambda, &change.value()[k]);
    }
    look_for_edges(n, out);
    return {};
  });
}

Result<Gradients> World::Impl::Trajectory::gradients() {
  Gradients out;
  const bool cells = std::any_of(query_.parameters.begin(), query_.parameters.end(),
                                 [](const Parameter& p) { return p.kind == Parameter::Kind::cells; });
  out.adjoint =
      query_.mode == GradientQuery::Mode::adjoint || cells ||
      (query_.mode == GradientQuery::Mode::automatic && query_.outputs.size() <= query_.parameters.size());
  out.values.assign(query_.outputs.size(), 0.0);
  out.by.assign(query_.outputs.size(), std::vector<std::vector<double>>(query_.parameters.size()));
  if (auto r = out.adjoint ? by_adjoint(out) : by_tangent(out); !r) return r.failure();
  return out;
}

Result<Gradients> World::trajectory_gradients(const TrajectoryQuery& query) try {
  if (auto r = impl_->compile(); !r) return r.failure();
  Impl::Trajectory way(*this, query);
  if (auto r = way.check(); !r) return r.failure();
  auto gone = way.go();
  auto out = gone ? way.gradients() : Result<Gradients>(gone.failure());
  way.leave();
  return out;
} catch (const std::bad_alloc&) {
  impl_->methods.drop();
  return Error{out_of_memory("trajectory_gradients")};
}

}  // namespace isochor
