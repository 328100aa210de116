#include "isochor/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "engine/builder.h"
#include "engine/newton.h"
#include "engine/recovery.h"
#include "engine/time_scheme.h"
#include "engine/world_impl.h"

namespace isochor {

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World> World::create(WorldOptions options, std::uint64_t abi) {
  if (abi != kWorldAbi) {
    return Error{"this program was built against headers of world version " + std::to_string(abi) +
                 ", the library has version " + std::to_string(kWorldAbi) + "; rebuild the program"};
  }
  if (!options.scheme)
    return Error{
        "world: no time scheme; set WorldOptions::scheme to implicit_euler(), statics() or another of "
        "isochor/schemes.h "
        "(generalized_alpha takes a spectral radius from 0 to 1)"};
  if (!(options.force_tolerance > 0) || !(options.row_tolerance > 0)) {
    return Error{"world: tolerances must be positive; the defaults are 1e-9 and 1e-10"};
  }
  if (options.max_iterations < 1) return Error{"world: max_iterations must be at least 1"};
  if (options.threads < 0 || options.threads > 1024) {
    return Error{"world: threads = " + std::to_string(options.threads) +
                 "; give 0 (all) or a number up to 1024"};
  }
  const Vec3& g = options.gravity;
  if (!std::isfinite(g.x) || !std::isfinite(g.y) || !std::isfinite(g.z)) {
    return Error{"world: gravity must be finite numbers"};
  }
  const auto kind = static_cast<SolverKind>(options.solver);
  if (options.solver != Solver::automatic && !make_linear_solver(kind, 1)) {
    return Error{
        "world: the linear solver asked for is not part of this build; `isochor version` lists those that "
        "are"};
  }
  auto impl = std::make_unique<Impl>();
  impl->options = std::move(options);
  impl->parallel = std::make_unique<TbbParallel>(impl->options.threads);
  return World(std::move(impl));
}

Result<BodyId> World::add_body(BodyDef body) {
  Impl& w = *impl_;
  if (w.compiled()) return Error{"body \"" + body.name + "\": bodies are added before the first step"};
  if (auto r = w.builder.add_body(body); !r) return Error{r.error()};
  return static_cast<BodyId>(w.builder.body_count() - 1);
}

Result<EffectId> World::add(EffectPtr effect) {
  Impl& w = *impl_;
  if (!effect) return Error{"world: an empty effect was added"};
  if (w.compiled())
    return Error{"effect \"" + effect->name() + "\": effects are added before the first step"};
  if (auto r = effect->check(); !r) return Error{r.error()};
  w.sources.push_back(std::move(effect));
  return static_cast<EffectId>(static_cast<Index>(w.sources.size()) - 1);
}

Result<void> World::Impl::compile() {
  if (compiled()) return {};
  if (!compile_error.empty()) return Error{compile_error};
  auto result = compile_once();
  // A builder is used up by a failed attempt; the reason stays.
  if (!result) compile_error = result.error();
  return result;
}

Result<void> World::Impl::compile_once() {
  for (const EffectPtr& e : sources) {
    if (auto r = e->declare(builder); !r) return r;
  }
  if (auto r = builder.build_solids(); !r) return r;
  for (std::size_t e = 0; e < sources.size(); ++e) {
    builder.set_owner(static_cast<Index>(e));
    auto instance = sources[e]->build(builder);
    if (!instance) return Error{instance.error()};
    instances.push_back(std::move(instance).value());
  }
  held_by = builder.held_directions(sources.size());
  for (const std::string& warning : builder.warnings()) {
    if (options.log) options.log(warning);
  }
  auto parts = builder.finish(!options.scheme->has_inertia());
  if (!parts) return Error{parts.error()};
  auto compiled_system = System::compile(std::move(parts).value());
  if (!compiled_system) return Error{compiled_system.error()};
  system = std::move(compiled_system).value();
  auto solver = make_linear_solver(static_cast<SolverKind>(options.solver), system->kkt().size);
  if (!solver) return Error{"world: this build has no linear solver"};
  newton = std::make_unique<Newton>(system, *parallel, std::move(solver));
  newton->cancelled = [this] { return cancel_requested.load(std::memory_order_relaxed); };
  allocate();
  return {};
}

void World::Impl::allocate() {
  const std::size_t n = at(system->nodes());
  const auto& parts = system->parts();
  state.layout = system->layout();
  state.x = parts.rest;
  state.v.assign(n, Vec3{});
  state.lambda.assign(at(system->rows()), 0.0);
  x_trial.resize(n);
  predicted.resize(n);
  force.resize(n);
  weight.assign(n, 0);
  lambda_trial.resize(at(system->rows()));
  target.resize(at(system->rows()));
  prescribed.resize(at(system->prescribed_rows()));
  position.resize(system->free_bases().size());
  reactions.assign(n, Vec3{});
  state.extra.assign(at(system->memory()) + options.scheme->memory(n), 0.0);
  memory_before.resize(at(system->memory()));
  for (Index p = 0; p < static_cast<Index>(parts.row_pools.size()); ++p) {
    const RowPool& pool = *parts.row_pools[at(p)];
    if (pool.memory() == 0) continue;
    pool.start(
        std::span(state.extra).subspan(at(system->first_memory(p)), static_cast<std::size_t>(pool.memory())));
  }
  // Gravity acts on the mass that inertia has: with a lumped mass, free fall stays rigid. Statics has no
  // inertia and takes the consistent distribution, which is more accurate for Tet10.
  if (options.scheme->has_inertia()) weight = parts.mass;
  for (const BodyData& body : builder.bodies()) {
    if (options.scheme->has_inertia()) break;
    for (const RegionData& region : body.regions) {
      add_nodal_volume(*body.reference, parts.rest, body.global_cells, region.cells, region.density, weight);
    }
  }
  evaluate_data(0);
}

void World::Impl::evaluate_data(double t) {
  const SystemParts& parts = system->parts();
  const Vec3 g = evaluate(options.gravity_curve, t) * options.gravity;
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = weight[i] * g;
  for (const auto& load : parts.loads) load->add(t, force);
  for (std::size_t p = 0; p < parts.row_pools.size(); ++p) {
    const RowPool& pool = *parts.row_pools[p];
    auto& all = pool.law == RowLaw::compliant ? target : prescribed;
    pool.update(t, std::span(all).subspan(at(system->first_row(static_cast<Index>(p))), at(pool.rows())));
  }
  std::size_t first = 0;
  for (const auto& p : parts.prescribers) {
    p->target(t, std::span(position).subspan(first, p->nodes.size()));
    first += p->nodes.size();
  }
}

// What pools keep from one step to the next, from the positions and multipliers that the step arrived at.
void World::Impl::accept_memory(const StencilIncrement& increment) {
  if (system->memory() == 0) return;
  std::copy_n(state.extra.begin(), memory_before.size(), memory_before.begin());
  for (Index p = 0; p < static_cast<Index>(system->parts().row_pools.size()); ++p) {
    const RowPool& pool = *system->parts().row_pools[at(p)];
    if (pool.memory() == 0) continue;
    const auto first = at(system->first_memory(p)), count = static_cast<std::size_t>(pool.memory());
    pool.accept({increment.t0, increment.t1, std::span<const double>(memory_before).subspan(first, count)},
                std::span<const double>(lambda_trial).subspan(at(system->first_row(p)), at(pool.rows())),
                std::span(state.extra).subspan(first, count));
  }
  const Assembly& assembly = newton->assembly();
  for (Index p = 0; p < static_cast<Index>(system->parts().stencil_pools.size()); ++p) {
    const StencilPool& pool = *system->parts().stencil_pools[at(p)];
    if (pool.memory() == 0) continue;
    const auto first = at(system->first_stencil_memory(p)), count = static_cast<std::size_t>(pool.memory());
    StencilRequest request = assembly.request(p, Want::value, x_trial);
    request.increment = increment;
    request.memory = std::span<const double>(memory_before).subspan(first, count);
    pool.accept(request, std::span(state.extra).subspan(first, count));
  }
}

// Nodes of the trial positions that passed through something since the increment began; where asked, they are
// put where they met it.
Index World::Impl::count_passing(const StencilIncrement& increment, bool stop) {
  if (!system->has_barrier()) return 0;
  Index count = 0;
  for (const auto& pool : system->parts().stencil_pools) {
    if (!pool->has_barrier()) continue;
    count += pool->passing(increment, x_trial, stop ? std::span<Vec3>(x_trial) : std::span<Vec3>());
  }
  return count;
}

SaddleReport World::Impl::attempt(double h, int max_iterations, int max_factorizations) {
  const double t_new = state.t + h;
  evaluate_data(t_new);
  SaddleProblem problem;
  problem.mass_scale = options.scheme->begin(state, scheme_memory(), h, predicted);
  problem.predicted = predicted;
  problem.force = force;
  problem.target = target;
  problem.prescribed = prescribed;
  problem.position = position;
  problem.t0 = state.t;
  problem.t1 = t_new;
  problem.memory = std::span<const double>(state.extra).first(at(system->memory()));
  problem.increment = {problem.mass_scale > 0 ? h : 0, state.x, state.t, t_new};
  SaddleOptions newton_options;
  newton_options.max_iterations = max_iterations;
  newton_options.max_factorizations = max_factorizations;
  newton_options.definiteness = options.definiteness;
  newton_options.force_tolerance = options.force_tolerance;
  newton_options.row_tolerance = options.row_tolerance;
  newton->progress = nullptr;
  if (progress) {
    newton->progress = [this, t_new](int iteration, double f, double r) {
      progress(ProgressInfo{t_new, t_new, iteration, f, r});
    };
  }
  // Inertia's guess first; where it fails (it may turn elements over) the old positions are a safe start.
  const bool dynamic = problem.mass_scale > 0;
  std::copy(state.lambda.begin(), state.lambda.end(), lambda_trial.begin());
  const auto& start = dynamic ? predicted : state.x;
  std::copy(start.begin(), start.end(), x_trial.begin());
  count_passing(problem.increment, true);
  SaddleReport report = newton->solve(problem, newton_options, x_trial, lambda_trial);
  if (report.status == SaddleStatus::converged && count_passing(problem.increment, false) > 0) {
    report.status = SaddleStatus::passed_through;
  }
  const bool stuck = report.status != SaddleStatus::converged && report.status != SaddleStatus::cancelled &&
                     report.status != SaddleStatus::out_of_memory;
  if (dynamic && stuck) {
    std::copy(state.lambda.begin(), state.lambda.end(), lambda_trial.begin());
    std::copy(state.x.begin(), state.x.end(), x_trial.begin());
    SaddleReport second = newton->solve(problem, newton_options, x_trial, lambda_trial);
    if (second.status == SaddleStatus::converged && count_passing(problem.increment, false) > 0) {
      second.status = SaddleStatus::passed_through;
    }
    second.iterations += report.iterations;
    second.factorizations += report.factorizations;
    second.trials += report.trials;
    second.corrections += report.corrections;
    second.projected += report.projected;
    second.shifted += report.shifted;
    report = std::move(second);
  }
  if (report.status == SaddleStatus::converged) {
    accept_memory(problem.increment);
    options.scheme->finish(h, x_trial, predicted, state, scheme_memory());
    std::copy(lambda_trial.begin(), lambda_trial.end(), state.lambda.begin());
    std::copy(newton->residual().begin(), newton->residual().end(), reactions.begin());
  }
  return report;
}

namespace {

void accumulate(StepReport& total, const SaddleReport& r) {
  total.iterations += r.iterations;
  total.factorizations += r.factorizations;
  total.trials += r.trials;
  total.corrections += r.corrections;
  total.projected += r.projected;
  total.shifted += r.shifted;
  total.negative_pivots = r.negative_pivots;
  total.force_residual = r.force_residual;
  total.row_residual = r.row_residual;
  total.linear_residual = std::max(total.linear_residual, r.linear_residual);
}

std::string failure_text(const SaddleReport& r, double t) {
  std::string text =
      "no equilibrium found at t = " + std::to_string(t) + ": " + std::string(to_string(r.status));
  if (!r.message.empty()) text += " (" + r.message + ")";
  return text;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

StepReport World::Impl::invalid(std::string reason) const {
  StepReport report;
  report.status = StepStatus::invalid;
  report.reason = std::move(reason);
  report.time = state.t;
  return report;
}

void World::Impl::finish_report(StepReport& report, const StageSeconds& before, double total) const {
  const StageSeconds& now = newton->seconds();
  report.seconds = {now.analyze - before.analyze,
                    now.evaluate - before.evaluate,
                    now.gather - before.gather,
                    now.factor - before.factor,
                    now.solve - before.solve,
                    now.line_search - before.line_search,
                    total};
  report.expected_negative_pivots = system->rows();
  report.time = state.t;
}

StepReport World::step(double h) {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return w.invalid(r.error());
  if (!(h > 0) || !std::isfinite(h))
    return w.invalid("step: h = " + std::to_string(h) + "; it must be positive and finite");
  const auto start = std::chrono::steady_clock::now();
  const StageSeconds before = w.newton->seconds();
  w.cancel_requested = false;
  w.amounts_before.clear();
  w.save_amounts(w.amounts_before);
  w.begin_amounts(w.state.t, w.state.t + h);
  StepReport report;
  const double t_target = w.state.t + h;
  const SaddleReport r = w.attempt(h, w.options.max_iterations, 10 * w.options.max_iterations);
  accumulate(report, r);
  report.substeps = 1;
  if (r.status == SaddleStatus::cancelled) {
    report.status = StepStatus::cancelled;
    report.reason = "cancelled by the host";
  } else if (r.status != SaddleStatus::converged) {
    report.status = StepStatus::rejected;
    report.rejected_substeps = 1;
    report.reason = failure_text(r, t_target);
  }
  if (report.status != StepStatus::converged) w.load_amounts(w.amounts_before);
  w.finish_report(report, before, seconds_since(start));
  return report;
}

StepReport World::advance(double h) {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return w.invalid(r.error());
  if (!(h > 0) || !std::isfinite(h)) {
    return w.invalid("advance: h = " + std::to_string(h) + "; it must be positive and finite");
  }
  const auto start = std::chrono::steady_clock::now();
  const StageSeconds before = w.newton->seconds();
  w.cancel_requested = false;
  const double t0 = w.state.t, t_end = t0 + h;
  w.begin_amounts(t0, t_end);
  StepReport report;
  constexpr int patience = 25, patience_for_factors = 35;
  double increment = h;
  int successes = 1;
  while (w.state.t < t_end - 1e-12 * h) {
    // The last increment lands on the end exactly.
    const double remaining = t_end - w.state.t;
    const double dt = increment > 0.999 * remaining ? remaining : increment;
    // What converges at all does so in a dozen iterations; while the increment can still be cut, more are
    // wasted.
    const bool last_chance = 0.5 * dt < w.options.smallest_fraction * h;
    const SaddleReport r =
        last_chance ? w.attempt(dt, w.options.max_iterations, 2 * w.options.max_iterations)
                    : w.attempt(dt, std::min(w.options.max_iterations, patience), patience_for_factors);
    accumulate(report, r);
    if (r.status == SaddleStatus::converged) {
      ++report.substeps;
      // Behind a failure the increment grows again only after two successes in a row.
      if (++successes >= 2) increment = std::min(2 * dt, h);
      continue;
    }
    successes = 0;
    if (r.status == SaddleStatus::cancelled) {
      report.status = StepStatus::cancelled;
      report.reason = "cancelled by the host";
      break;
    }
    ++report.rejected_substeps;
    increment = 0.5 * dt;
    const bool hopeless = r.status == SaddleStatus::out_of_memory || r.status == SaddleStatus::not_finite;
    if (increment < w.options.smallest_fraction * h || hopeless) {
      report.status = StepStatus::rejected;
      report.reason = failure_text(r, w.state.t + dt);
      if (r.status == SaddleStatus::singular) {
        report.reason +=
            ": rows without compliance may repeat each other or lack stabilization, or a part is not held";
      } else if (!hopeless) {
        report.reason += "; increments shrank to " + std::to_string(increment / h) +
                         " of the step, the last equilibrium is at t = " + std::to_string(w.state.t) +
                         ": probably there is none beyond (a limit point, or a load that nothing can carry)";
      }
      break;
    }
  }
  if (report.status == StepStatus::converged) w.state.t = t_end;
  w.finish_report(report, before, seconds_since(start));
  return report;
}

void World::cancel() {
  impl_->cancel_requested = true;
}

Result<void> World::compile() {
  return impl_->compile();
}

Result<void> World::set_amount(EffectId effect, double amount) {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  const auto i = static_cast<std::size_t>(effect);
  if (i >= w.instances.size()) {
    return Error{"set_amount: there is no effect number " + std::to_string(static_cast<Index>(effect))};
  }
  Amount* a = w.instances[i]->amount();
  if (!a) return Error{"set_amount: effect \"" + w.sources[i]->name() + "\" has no amount to set"};
  if (!std::isfinite(amount)) {
    return Error{"set_amount: effect \"" + w.sources[i]->name() + "\": the amount must be a finite number"};
  }
  a->set(amount);
  return {};
}

void World::Impl::save_amounts(std::vector<double>& all) const {
  for (const auto& instance : instances) {
    if (const Amount* a = instance->amount()) a->save(all);
  }
}

void World::Impl::load_amounts(std::span<const double> all) {
  for (const auto& instance : instances) {
    if (Amount* a = instance->amount()) a->load(all);
  }
}

void World::Impl::begin_amounts(double t0, double t1) {
  const bool quasi_static = !options.scheme->has_inertia();
  for (const auto& instance : instances) {
    // In dynamics a new value holds from the next step on; statics ramps to it.
    if (Amount* a = instance->amount()) a->begin(quasi_static ? t0 : t1, t1);
  }
}

void World::on_progress(std::function<void(const ProgressInfo&)> callback) {
  impl_->progress = std::move(callback);
}

}  // namespace isochor
