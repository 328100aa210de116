#include "engine/world/trajectory.h"

#include <algorithm>
#include <cmath>

#include "engine/base/out_of_memory.h"
#include "engine/base/text.h"
#include "engine/step/time_scheme.h"

namespace isochor {

namespace {

// Of messages of World::gradients().
std::string without_call(const std::string& text) {
  constexpr std::string_view call = "gradients: ";
  return text.starts_with(call) ? text.substr(call.size()) : text;
}

Error renamed(const std::string& where, const Error& error) {
  if (error.kind == ErrorKind::no_memory) return error;
  return {"trajectory_gradients: " + where + without_call(error.message), error.kind};
}

}  // namespace

Error trajectory_error(const std::string& text) {
  return Error{"trajectory_gradients: " + text};
}

Error in_step(Index n, const Error& error) {
  return renamed(std::string("step ").append(std::to_string(n)).append(": "), error);
}

Error in_list(const char* list, std::size_t k, const Error& error) {
  return renamed(std::string(list).append("[").append(std::to_string(k)).append("]: "), error);
}

// --- What is asked -----------------------------------------------------------------------------------------

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
  if (!facets.remembering.empty()) why = "a material remembers what came before";
  if (!facets.remembering_rows.empty())
    why = "gas and liquid in chambers remember what they were filled with";
  if (!facets.renewed.empty()) why = "contact on surfaces renews its rows";
  if (!facets.impacts.empty()) why = "contact with a rebound lets velocities jump";
  if (!facets.lagged.empty()) why = "friction, or a pressure on faces with a free rim, lags behind";
  if (why)
    return trajectory_error(std::string(why) +
                            ", which gradients of trajectories do not follow; leave it out");
  if (auto r = check_pools(); !r) return r;
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
      if (auto r = world_.check(term.output.effect); !r) return in_list("outputs", j, r.failure());
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
      if (auto r = world_.check(p.effect); !r) return in_list("parameters", k, r.failure());
    }
    if (p.kind == Parameter::Kind::cells && query_.mode == GradientQuery::Mode::tangent)
      return trajectory_error(
          "cell_stiffness is a number a cell, and tangents would solve as often; ask by "
          "the adjoint");
  }
  return {};
}

// Whether forces depend on where an increment begins otherwise than by inertia and by what is known to.
Result<void> World::Impl::Trajectory::check_pools() {
  if (!w_.options.scheme->has_inertia()) return {};
  // Pools are asked with the multipliers of the state.
  w_.evaluate_state(Want::gradient);
  const double h = query_.steps.front(), far = 1e-3 * w_.system().length();
  std::vector<Vec3> before = w_.state.x;
  for (std::size_t i = 0; i < before.size(); ++i)
    before[i] += far * Vec3{i % 2 ? 1.0 : -1.0, i % 3 ? 0.5 : -1.0, i % 5 ? 0.25 : -0.5};
  const StencilIncrement here{h, w_.state.x, w_.state.t, w_.state.t + h},
      elsewhere{h, before, w_.state.t, w_.state.t + h};
  const auto& pools = w_.system().parts().stencil_pools;
  for (Index p = 0; p < static_cast<Index>(pools.size()); ++p) {
    if (pools[at(p)]->facets().dissipative) continue;
    if (gradient_of(p, elsewhere, w_.state.x) == gradient_of(p, here, w_.state.x)) continue;
    return trajectory_error(std::string(pools[at(p)]->name())
                                .append(" looks back over the increment, which gradients of trajectories do "
                                        "not follow; leave it out"));
  }
  return {};
}

// --- The way -----------------------------------------------------------------------------------------------

Index World::Impl::Trajectory::spacing() const {
  if (query_.kept_states == 0) return steps();
  return std::max<Index>(1, (steps() + query_.kept_states - 1) / query_.kept_states);
}

World::Impl::Trajectory::Moment World::Impl::Trajectory::now() const {
  Moment out{w_.state, {}};
  w_.amounts.save(out.amounts);
  return out;
}

void World::Impl::Trajectory::restore(Moment moment) noexcept {
  w_.amounts.load(moment.amounts);
  w_.take_over(std::move(moment.state));
  w_.settled.reset();
}

Result<void> World::Impl::Trajectory::make_step(Index n) {
  const StepReport report = world_.step(query_.steps[at(n - 1)]);
  if (report.status == StepStatus::converged) return {};
  if (report.reason == out_of_memory("step")) return no_memory("trajectory_gradients");
  const char* remedy = report.status == StepStatus::rejected ? "; take shorter steps" : "";
  return trajectory_error("steps[" + std::to_string(n - 1) + "] = " + number(query_.steps[at(n - 1)]) +
                          " s: " + report.reason + remedy);
}

Result<void> World::Impl::Trajectory::go() {
  start_ = now();
  const Index every = spacing();
  part_ = {w_.state};
  for (Index n = 1; n <= steps(); ++n) {
    if (auto r = make_step(n); !r) return r;
    if (n % every == 0 && n < steps()) {
      kept_.push_back(now());
      part_first_ = n;
      part_.clear();
    }
    part_.push_back(w_.state);
  }
  end_ = now();
  return {};
}

// The states from a kept one to the next.
Result<void> World::Impl::Trajectory::remake(Index first) {
  if (first == part_first_) return {};
  const Index every = spacing();
  restore(first == 0 ? *start_ : kept_[at(first / every - 1)]);
  part_first_ = first;
  part_ = {w_.state};
  for (Index n = first + 1; n <= std::min(first + every, steps()); ++n) {
    if (auto r = make_step(n); !r) return r;
    part_.push_back(w_.state);
  }
  return {};
}

Result<void> World::Impl::Trajectory::each(Way way, const std::function<Result<void>(Index)>& visit) {
  const Index every = spacing(), parts = (steps() + every - 1) / every;
  for (Index k = 0; k < parts; ++k) {
    const Index first = every * (way == Way::backward ? parts - 1 - k : k);
    if (auto r = remake(first); !r) return r;
    const Index count = std::min(every, steps() - first);
    for (Index i = 0; i < count; ++i) {
      if (auto r = visit(first + 1 + (way == Way::backward ? count - 1 - i : i)); !r) return r;
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
  // Where that is the end, the bits of the end.
  if (part != 1) {
    for (std::size_t i = 0; i < before.x.size(); ++i)
      w_.state.x[i] = before.x[i] + part * (after.x[i] - before.x[i]);
  }
  w_.state.t = before.t + part * h;
  const double passed = out.inertia.mass_scale > 0 ? part * h : 0;
  out.inertia.increment = {passed, before.x, before.t, w_.state.t};
  return out;
}

void World::Impl::Trajectory::leave(bool at_end) noexcept {
  if (at_end)
    restore(std::move(*end_));
  else if (start_)
    restore(std::move(*start_));
}

Result<Gradients> World::trajectory_gradients(const TrajectoryQuery& query) {
  std::optional<Impl::Trajectory> way;
  try {
    if (auto r = impl_->compile(); !r) return r.failure();
    way.emplace(*this, query);
    if (auto r = way->check(); !r) return r.failure();
    auto gone = way->go();
    auto out = gone ? way->gradients() : Result<Gradients>(gone.failure());
    way->leave(out.ok());
    return out;
  } catch (const std::bad_alloc&) {
    if (way) way->leave(false);
    impl_->methods.drop();
    return no_memory("trajectory_gradients");
  }
}

}  // namespace isochor
