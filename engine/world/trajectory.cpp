#include "engine/world/trajectory.h"

#include <algorithm>
#include <cmath>

#include "engine/base/out_of_memory.h"
#include "engine/base/text.h"
#include "engine/step/time_scheme.h"
#include "engine/world/revolve.h"

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
  if (!MemoryTerms::follows(w_.system())) why = "a material that softens remembers what came before";
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

namespace {

bool is_of_positions(const Output& o) {
  using enum Output::Kind;
  return o.kind == positions || o.kind == distance || o.kind == square || o.kind == function;
}

bool needs_springs(const Output& o) {
  const std::string& part = o.quantity;
  const bool energy = o.kind == Output::Kind::energy;
  return o.kind == Output::Kind::stress ||
         (energy && (part == "elastic" || part == "potential" || part == "total"));
}

}  // namespace

Result<void> World::Impl::Trajectory::check_outputs() const {
  for (std::size_t j = 0; j < query_.outputs.size(); ++j) {
    const std::string who = "outputs[" + std::to_string(j) + "]";
    if (query_.outputs[j].terms.empty()) return trajectory_error(who + " has no terms; give one at least");
    for (const TimedOutput::Term& term : query_.outputs[j].terms) {
      if (term.step < 0 || term.step > steps()) {
        return trajectory_error(who + ": step = " + std::to_string(term.step) +
                                "; the trajectory has steps 0 to " + std::to_string(steps()));
      }
      if (names_effect(term.output)) {
        if (auto r = world_.check(term.output.effect); !r) return in_list("outputs", j, r.failure());
      }
      // Springs of what flows beside store energy, and carry stress, that outputs do not follow.
      if (MemoryTerms::numbers(w_.system()) > 0 && needs_springs(term.output))
        return trajectory_error(
            who +
            ": stresses and elastic energies of materials that remember are not followed; "
            "take positions, gauges, reactions or forces");
      if (is_of_positions(term.output) || (ends_there() && term.step > 0)) continue;
      return trajectory_error(
          who +
          ": all but functions of positions belongs to where an increment is evaluated, which "
          "the scheme does in its middle, or to no increment at step 0; take positions");
    }
  }
  return {};
}

Result<void> World::Impl::Trajectory::check_parameters() const {
  for (std::size_t k = 0; k < query_.parameters.size(); ++k) {
    const Parameter& p = query_.parameters[k];
    if (names_effect(p)) {
      if (auto r = world_.check(p.effect); !r) return in_list("parameters", k, r.failure());
    }
    const bool stiffness = p.kind == Parameter::Kind::cells || p.kind == Parameter::Kind::stiffness;
    if (stiffness && MemoryTerms::numbers(w_.system()) > 0)
      return trajectory_error("parameters[" + std::to_string(k) +
                              "]: factors on the stiffness of materials that remember are not followed; take "
                              "constants of the material");
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
  ++steps_made_;
  const StepReport report = world_.step(query_.steps[at(n - 1)]);
  if (report.status == StepStatus::converged) return {};
  if (report.reason == out_of_memory("step")) return no_memory("trajectory_gradients");
  const char* remedy = report.status == StepStatus::rejected ? "; take shorter steps" : "";
  return trajectory_error("steps[" + std::to_string(n - 1) + "] = " + number(query_.steps[at(n - 1)]) +
                          " s: " + report.reason + remedy);
}

// --- Forward: on the way -----------------------------------------------------------------------------------

Result<void> World::Impl::Trajectory::each_forward(const OfStep& visit) {
  before_ = now();
  for (Index n = 1; n <= steps(); ++n) {
    if (auto r = make_step(n); !r) return r;
    after_ = now();
    if (auto r = visit(n); !r) return r;
    restore(*after_);
    before_ = std::move(after_);
  }
  end_ = now();
  return {};
}

// --- Backward: states that are kept ------------------------------------------------------------------------

Index World::Impl::Trajectory::most_kept() const {
  const Index all = steps() - 1;
  return query_.kept_states == 0 ? all : std::min(query_.kept_states, all);
}

void World::Impl::Trajectory::keep(Index step) {
  kept_.emplace_back(step, now());
  most_at_once_ = std::max(most_at_once_, static_cast<Index>(kept_.size()));
}

// To the end, with states kept on the way as find_before() would.
Result<void> World::Impl::Trajectory::go() {
  Index next = 0;  // to be kept
  const auto plan = [&](Index from) {
    const Index free = most_kept() - static_cast<Index>(kept_.size()), left = steps() - from;
    next = free > 0 && left > 1 ? from + steps_to_keep(left, free) : 0;
  };
  plan(0);
  for (Index n = 1; n <= steps(); ++n) {
    if (n == steps() && (kept_.empty() ? 0 : kept_.back().first) != n - 1) before_ = now();
    if (auto r = make_step(n); !r) return r;
    if (n != next) continue;
    keep(n);
    plan(n);
  }
  end_ = now();
  return {};
}

// The state that a step begins with, into before_: kept, or made again from the last one that is.
Result<void> World::Impl::Trajectory::find_before(Index step) {
  Index from = kept_.empty() ? 0 : kept_.back().first;
  if (from < step) restore(kept_.empty() ? *start_ : kept_.back().second);
  while (from < step) {
    const Index free = most_kept() - static_cast<Index>(kept_.size());
    const Index to = free > 0 ? from + steps_to_keep(step + 1 - from, free) : step;
    for (Index n = from + 1; n <= to; ++n) {
      if (auto r = make_step(n); !r) return r;
    }
    if (free == 0) {
      before_ = now();
      return {};
    }
    keep(to);
    from = to;
  }
  if (step == 0) {
    before_ = *start_;
    return {};
  }
  before_ = std::move(kept_.back().second);
  kept_.pop_back();
  return {};
}

Result<void> World::Impl::Trajectory::each_backward(const OfStep& visit) {
  if (auto r = go(); !r) return r;
  after_ = *end_;
  for (Index n = steps(); n >= 1; --n) {
    if (!before_) {
      if (auto r = find_before(n - 1); !r) return r;
    }
    if (auto r = visit(n); !r) return r;
    after_ = std::move(before_);
    before_.reset();
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
  const State &before = before_->state, &after = after_->state;
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
    auto out = way->gradients();
    way->leave(out.ok());
    return out;
  } catch (const std::bad_alloc&) {
    if (way) way->leave(false);
    impl_->methods.drop();
    return no_memory("trajectory_gradients");
  }
}

}  // namespace isochor
