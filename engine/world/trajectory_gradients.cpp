// What each increment of a way adds to the gradients: outline in trajectory.h.
#include <algorithm>
#include <cmath>

#include "engine/world/trajectory.h"

namespace isochor {

namespace {

Lists3 zeros(std::size_t lists, std::size_t nodes) {
  return Lists3(lists, std::vector<Vec3>(nodes));
}

void add_to(std::vector<Vec3>& sum, double factor, std::span<const Vec3> other) {
  for (std::size_t i = 0; factor != 0 && i < sum.size(); ++i) sum[i] += factor * other[i];
}

}  // namespace

// --- Outputs and parameters --------------------------------------------------------------------------------

Result<void> World::Impl::Trajectory::watch(Equilibrium& eq, Index n) const {
  for (std::size_t j = 0; j < query_.outputs.size(); ++j) {
    for (const TimedOutput::Term& term : query_.outputs[j].terms) {
      if (term.step != n) continue;
      if (auto r = eq.watch(term.output); !r) return in_list("outputs", j, r.failure());
    }
  }
  return {};
}

// What each output has of the state that the world is at, zero where it has nothing.
Result<std::vector<OutputSeed>> World::Impl::Trajectory::seeds_of(Equilibrium& eq, Index n,
                                                                  Gradients& out) const {
  std::vector<OutputSeed> seeds;
  for (std::size_t j = 0; j < query_.outputs.size(); ++j) {
    OutputSeed& sum = seeds.emplace_back(w_.state.x.size(), w_.state.lambda.size());
    for (const TimedOutput::Term& term : query_.outputs[j].terms) {
      if (term.step != n) continue;
      auto seed = eq.seed_of(term.output);
      if (!seed) return in_list("outputs", j, seed.failure());
      sum.add(seed.value());
    }
    out.values[j] += sum.value;
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
    if (!change) return in_list("parameters", k, change.failure());
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

Result<void> World::Impl::Trajectory::gather(const Linearized& here, std::size_t j, const Adjoint& adjoint,
                                             Gradients& out) const {
  for (std::size_t k = 0; k < query_.parameters.size(); ++k) {
    const Parameter& p = query_.parameters[k];
    std::vector<double>& sum = out.by[j][k];
    if (p.kind == Parameter::Kind::cells) {
      auto cells = here.eq.by_cells(here.seeds[j], adjoint, p.body);
      if (!cells) return in_list("parameters", k, cells.failure());
      sum.resize(cells.value().size());
      for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += cells.value()[c];
    } else {
      sum.resize(1);
      sum[0] += here.eq.by_adjoint(here.seeds[j], adjoint, here.change[k]);
    }
  }
  return {};
}

void World::Impl::Trajectory::look_for_edges(Index n, Gradients& out) const {
  if (!w_.system().has_bounds()) return;
  auto found = w_.irregular();
  if (found.note.empty()) return;
  if (out.regular) out.note = "step " + std::to_string(n) + ": " + found.note;
  out.regular = false;
  for (std::string& effect : found.effects) {
    if (std::find(out.undecided.begin(), out.undecided.end(), effect) == out.undecided.end())
      out.undecided.push_back(std::move(effect));
  }
}

// --- Dissipation -------------------------------------------------------------------------------------------

std::vector<Vec3> World::Impl::Trajectory::gradient_of(Index p, const StencilIncrement& increment,
                                                       std::span<const Vec3> x) const {
  const StencilPool& pool = *w_.system().parts().stencil_pools[at(p)];
  const auto functions = static_cast<std::size_t>(pool.functions());
  std::vector<double> energy(at(pool.stencils())), value(energy.size() * functions);
  std::vector<Vec3> gradient(pool.nodes().item.size()), jacobian(gradient.size() * functions);
  StencilSlots slots;
  slots.energy = energy;
  slots.value = value;
  slots.gradient = gradient;
  slots.jacobian = jacobian;
  StencilRequest request = w_.assembly().request(p, Want::gradient, x);
  request.increment = increment;
  pool.evaluate(request, slots);
  return gradient;
}

std::vector<Vec3> World::Impl::Trajectory::dissipation(StencilIncrement increment, std::span<const Vec3> x,
                                                       std::span<const Vec3> before) const {
  increment.before = before;
  std::vector<Vec3> out(x.size());
  for (const auto& dissipative : w_.system().facets().dissipative) {
    const auto& nodes = w_.system().parts().stencil_pools[at(dissipative.pool)]->nodes().item;
    const auto gradient = gradient_of(dissipative.pool, increment, x);
    for (std::size_t i = 0; i < gradient.size(); ++i) out[at(nodes[i])] += gradient[i];
  }
  return out;
}

namespace {

// Steps to both sides; a potential of squares of Green's strain makes their difference exact.
struct Sides {
  double step = 0;
  std::vector<Vec3> up, down;
};

Sides sides_of(std::span<const Vec3> x, std::span<const Vec3> way, double length) {
  constexpr double far = 1e-2;
  double most = 0;
  for (const Vec3& v : way) most = std::max(most, norm(v));
  Sides out{most > 0 ? far * length / most : 0, {x.begin(), x.end()}, {x.begin(), x.end()}};
  add_to(out.up, out.step, way);
  add_to(out.down, -out.step, way);
  return out;
}

std::vector<Vec3> difference(std::vector<Vec3> up, std::span<const Vec3> down, double step) {
  for (std::size_t i = 0; i < up.size(); ++i) up[i] = step > 0 ? (0.5 / step) * (up[i] - down[i]) : Vec3{};
  return up;
}

}  // namespace

std::vector<Vec3> World::Impl::Trajectory::dissipation_along(const Increment& increment,
                                                             std::span<const Vec3> way) const {
  const StencilIncrement& i = increment.inertia.increment;
  const Sides begin = sides_of(i.before, way, w_.system().length());
  return difference(dissipation(i, w_.state.x, begin.up), dissipation(i, w_.state.x, begin.down), begin.step);
}

// Both ends change places: what forces at the beginning do when the end goes along.
std::vector<Vec3> World::Impl::Trajectory::dissipation_back(const Increment& increment,
                                                            std::span<const Vec3> way) const {
  const StencilIncrement& i = increment.inertia.increment;
  const Sides end = sides_of(w_.state.x, way, w_.system().length());
  return difference(dissipation(i, i.before, end.up), dissipation(i, i.before, end.down), end.step);
}

std::vector<World::Impl::Trajectory::Carried> World::Impl::Trajectory::nothing(std::size_t count) const {
  return std::vector<Carried>(
      count, {zeros(lists_, w_.state.x.size()), std::vector<double>(MemoryTerms::numbers(w_.system()))});
}

// --- The two ways ------------------------------------------------------------------------------------------

template <class Visit>
Result<void> World::Impl::Trajectory::in_increment(Index n, Gradients& out, Visit&& visit) {
  Equilibrium eq(w_);
  eq.compared = compared_;
  if (auto r = watch(eq, n); !r) return r;
  Result<std::vector<OutputSeed>> seeds(std::vector<OutputSeed>{});
  // Functions of positions alone, of those at its end.
  if (!ends_there()) {
    stand_at(after_->state, after_->state);
    seeds = seeds_of(eq, n, out);
    if (!seeds) return seeds.failure();
  }
  const Increment increment = stand_in(n);
  eq.inertia = &increment.inertia;
  if (auto r = eq.linearize(true); !r) return in_step(n, r.failure());
  if (ends_there()) seeds = seeds_of(eq, n, out);
  if (!seeds) return seeds.failure();
  const auto change = changes(eq);
  if (!change) return change.failure();
  compared_ = true;
  const MemoryTerms memory(w_.system(), w_.assembly(), increment.inertia.increment, w_.state.x,
                           w_.layout.of_pools(w_.state.extra));
  if (auto r = visit(Linearized{n, increment, eq, seeds.value(), change.value(), memory}); !r) return r;
  look_for_edges(n, out);
  return {};
}

Result<void> World::Impl::Trajectory::step_back(const Linearized& here, std::vector<Carried>& felt,
                                                Gradients& out) const {
  const StepMap& map = here.increment.map;
  for (std::size_t j = 0; j < felt.size(); ++j) {
    OutputSeed& seed = here.seeds[j];
    add_to(felt[j].lists[0], 1, seed.x);
    add_to(felt[j].lists[1], 1, seed.v);
    std::fill(seed.x.begin(), seed.x.end(), Vec3{});
    for (std::size_t k = 0; k < lists_; ++k) add_to(seed.x, map.found[k], felt[j].lists[k]);
    std::vector<double> remembered = here.memory.back(felt[j].memory, seed.x);
    const auto adjoint = here.eq.adjoint_of(seed);
    if (!adjoint) return in_step(here.step, adjoint.failure());
    const std::vector<Vec3>& a = adjoint.value().force;
    if (auto r = gather(here, j, adjoint.value(), out); !r) return r;
    for (std::size_t k = 0; k < query_.parameters.size(); ++k) {
      const std::vector<double>& kept = here.change[k].kept;
      for (std::size_t i = 0; i < kept.size(); ++i) out.by[j][k][0] += felt[j].memory[i] * kept[i];
    }
    here.memory.add_force_back(-1, a, remembered);
    const auto pull = heavy(map.mass_scale, a);
    Lists3 before = zeros(lists_, w_.state.x.size());
    for (std::size_t b = 0; b < lists_; ++b) {
      for (std::size_t k = 0; k < lists_; ++k) add_to(before[b], map.before[k][b], felt[j].lists[k]);
      add_to(before[b], map.predicted[b], pull);
    }
    if (dissipates()) add_to(before[0], -1, dissipation_back(here.increment, a));
    felt[j] = {std::move(before), std::move(remembered)};
  }
  return {};
}

// What the start itself has to do with outputs.
void World::Impl::Trajectory::add_start(std::span<const OutputSeed> seeds, std::vector<Carried>& felt,
                                        Gradients& out) const {
  for (std::size_t j = 0; j < felt.size(); ++j) {
    add_to(felt[j].lists[0], 1, seeds[j].x);
    for (std::size_t k = 0; k < query_.parameters.size(); ++k) {
      const Parameter& p = query_.parameters[k];
      if (p.kind != Parameter::Kind::shape && p.kind != Parameter::Kind::velocity) continue;
      const auto motion = in_scene(p);
      const auto& list = felt[j].lists[p.kind == Parameter::Kind::shape ? 0 : 1];
      for (std::size_t i = 0; i < motion.size(); ++i) out.by[j][k][0] += dot(list[i], motion[i]);
    }
  }
}

Result<void> World::Impl::Trajectory::go_back(Gradients& out) {
  // dJ/dy behind the increment at hand.
  std::vector<Carried> felt = nothing(query_.outputs.size());
  const auto visit = [&](const Linearized& here) { return step_back(here, felt, out); };
  if (auto r = each_backward([&](Index n) { return in_increment(n, out, visit); }); !r) return r;
  Equilibrium eq(w_);
  stand_at(start_->state, start_->state);
  auto seeds = seeds_of(eq, 0, out);
  if (!seeds) return seeds.failure();
  add_start(seeds.value(), felt, out);
  return {};
}

namespace {

// What an output changes by, along a change of positions and multipliers.
double along(const OutputSeed& seed, std::span<const Vec3> x, std::span<const double> lambda) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += dot(seed.x[i], x[i]);
  for (std::size_t r = 0; r < lambda.size(); ++r) sum += seed.multiplier[r] * lambda[r];
  return sum;
}

double product(std::span<const Vec3> a, std::span<const Vec3> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

}  // namespace

Result<void> World::Impl::Trajectory::step_along(const Linearized& here, std::vector<Carried>& moved,
                                                 Gradients& out) const {
  const StepMap& map = here.increment.map;
  const std::size_t nodes = w_.state.x.size();
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const Equations& change = here.change[k];
    std::vector<Vec3> carried(nodes);
    for (std::size_t b = 0; b < lists_; ++b) add_to(carried, map.predicted[b], moved[k].lists[b]);
    std::vector<Vec3> load = heavy(map.mass_scale, carried);
    std::vector<double> row(change.theta);
    for (double& r : row) r = -r;
    add_to(load, -1, change.force);
    if (dissipates()) add_to(load, -1, dissipation_along(here.increment, moved[k].lists[0]));
    here.memory.add_force(-1, moved[k].memory, load);
    if (auto r = here.eq.solve(load, row, here.eq.way_of(change.position)); !r)
      return in_step(here.step, r.failure());
    Lists3 after = zeros(lists_, nodes);
    for (std::size_t a = 0; a < lists_; ++a) {
      for (std::size_t b = 0; b < lists_; ++b) add_to(after[a], map.before[a][b], moved[k].lists[b]);
      add_to(after[a], map.found[a], here.eq.dx);
    }
    std::vector<double> remembered = here.memory.onward(moved[k].memory, here.eq.dx);
    for (std::size_t i = 0; i < change.kept.size(); ++i) remembered[i] += change.kept[i];
    moved[k] = {std::move(after), std::move(remembered)};
    for (std::size_t j = 0; j < out.by.size(); ++j) {
      const OutputSeed& seed = here.seeds[j];
      out.by[j][k][0] += Equilibrium::held(seed, change) + along(seed, moved[k].lists[0], here.eq.dlambda) +
                         product(seed.v, moved[k].lists[1]) - product(seed.through, load);
    }
  }
  return {};
}

Result<void> World::Impl::Trajectory::go_along(Gradients& out) {
  const std::size_t parameters = query_.parameters.size();
  std::vector<Carried> moved = nothing(parameters);  // dy/dp before the increment
  for (std::size_t k = 0; k < parameters; ++k) {
    const bool velocity = query_.parameters[k].kind == Parameter::Kind::velocity;
    moved[k].lists[velocity ? 1 : 0] = in_scene(query_.parameters[k]);
    for (auto& by : out.by) by[k].assign(1, 0.0);
  }
  Equilibrium eq(w_);
  auto seeds = seeds_of(eq, 0, out);
  if (!seeds) return seeds.failure();
  for (std::size_t k = 0; k < parameters; ++k) {
    for (std::size_t j = 0; j < out.by.size(); ++j)
      out.by[j][k][0] += along(seeds.value()[j], moved[k].lists[0], {});
  }
  const auto visit = [&](const Linearized& here) { return step_along(here, moved, out); };
  return each_forward([&](Index n) { return in_increment(n, out, visit); });
}

bool World::Impl::Trajectory::by_adjoint() const {
  const bool cells = std::any_of(query_.parameters.begin(), query_.parameters.end(),
                                 [](const Parameter& p) { return p.kind == Parameter::Kind::cells; });
  return query_.mode == GradientQuery::Mode::adjoint || cells ||
         (query_.mode == GradientQuery::Mode::automatic && query_.outputs.size() <= query_.parameters.size());
}

Result<Gradients> World::Impl::Trajectory::gradients() {
  start_ = now();
  Gradients out;
  out.adjoint = by_adjoint();
  out.values.assign(query_.outputs.size(), 0.0);
  out.by.assign(query_.outputs.size(), std::vector<std::vector<double>>(query_.parameters.size()));
  if (auto r = out.adjoint ? go_back(out) : go_along(out); !r) return r.failure();
  out.kept_states = most_at_once_;
  out.steps_again = steps_made_ - steps();
  const State& s = start_->state;
  out.state_bytes = sizeof(Vec3) * (s.x.size() + s.v.size() + s.forces.size() + s.reactions.size()) +
                    sizeof(double) * (s.lambda.size() + s.extra.size() + start_->amounts.size());
  return out;
}

}  // namespace isochor
