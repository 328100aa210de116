#include "isochor/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>

#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "engine/solve/newton/newton.h"
#include "engine/step/time_scheme.h"
#include "engine/world/recovery.h"
#include "engine/world/world_impl.h"

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
  if (!std::isfinite(options.force_tolerance) || !std::isfinite(options.row_tolerance)) {
    return Error{"world: tolerances must be finite; the defaults are 1e-9 and 1e-10"};
  }
  if (!(options.smallest_fraction > 0 && options.smallest_fraction <= 1)) {
    return Error{"world: smallest_fraction = " + number(options.smallest_fraction) +
                 "; it must be positive and at most 1"};
  }
  if (!(options.time_error >= 0) || !std::isfinite(options.time_error)) {
    return Error{"world: time_error = " + number(options.time_error) +
                 "; it must be zero (no control) or positive"};
  }
  if (options.sweeps < 1 || options.sweeps > 100000) {
    return Error{"world: sweeps = " + std::to_string(options.sweeps) + "; give 1 to 100000"};
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
  if (options.solver != Solver::automatic && !make_linear_solver(kind)) {
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
  const auto result = compile_once();
  for (const std::string& warning : builder.warnings()) {
    if (options.log) options.log(warning);
  }
  if (result) return {};
  // A builder is used up by a failed attempt; the reason stays. Wrong units make supports miss their nodes
  // and probes their cells, so whoever did not hear of them does so here.
  compile_error = result.error() + (options.log ? "" : builder.doubtful_units());
  return Error{compile_error};
}

Result<void> World::Impl::compile_once() {
  builder.set_quasi_static(!options.scheme->has_inertia());
  for (const EffectPtr& e : sources) {
    if (auto r = e->declare(builder); !r) return r;
  }
  if (options.consistent_mass && options.scheme->has_inertia()) builder.use_consistent_mass();
  if (auto r = builder.build_solids(); !r) return r;
  for (std::size_t e = 0; e < sources.size(); ++e) {
    builder.set_owner(static_cast<Index>(e));
    auto instance = sources[e]->build(builder);
    if (!instance) return Error{instance.error()};
    instances.push_back(std::move(instance).value());
  }
  held_by = builder.held_directions(sources.size());
  auto parts = builder.finish(!options.scheme->has_inertia());
  if (!parts) return Error{parts.error()};
  if (auto r = make_method(std::move(parts).value()); !r) return r;
  tell_idle_rows();
  allocate();
  return {};
}

// Rows that supports leave nothing to do, by the effect that they are of.
void World::Impl::tell_idle_rows() {
  std::map<std::string, std::pair<Index, Index>> of_pool;  // idle rows, all rows
  const auto& pools = system->parts().row_pools;
  for (Index p = 0; p < static_cast<Index>(pools.size()); ++p) {
    const RowPool& pool = *pools[at(p)];
    if (pool.law != RowLaw::compliant) continue;
    const auto first = system->first_row(p);
    const auto idle = std::count_if(system->idle_rows().begin(), system->idle_rows().end(),
                                    [&](Index r) { return r >= first && r < first + pool.rows(); });
    auto& [count, all] = of_pool[std::string(pool.name())];
    count += static_cast<Index>(idle);
    all += pool.rows();
  }
  for (const auto& [name, counts] : of_pool) {
    if (counts.first == 0) continue;
    builder.warn("\"" + name + "\": " + std::to_string(counts.first) + " of its " +
                 std::to_string(counts.second) + (counts.first == 1 ? " rows has" : " rows have") +
                 " no free coordinate, as supports hold all nodes that enter; what supports do there is not "
                 "held against it");
    if (options.log) options.log(builder.warnings().back());
  }
}

void World::Impl::allocate() {
  const std::size_t n = at(system->nodes());
  const auto& parts = system->parts();
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
  admission.emplace(builder.bodies(), parts);
  momentum.resize(n);
  if (system->has_bounds() || system->has_barrier())
    for (auto& values : row_values) values.resize(at(system->rows()));
  // Last increment's length and suggestion for the next, then velocities before it.
  const std::size_t control = controls_error() ? 2 + 3 * n : 0;
  state.extra.assign(at(system->memory()) + options.scheme->memory(n) + control, 0.0);
  if (controls_error()) state_before = state;
  if (options.scheme->has_inertia()) ahead = state;
  memory_before.resize(at(system->memory()));
  if (system->has_followers()) first_stencils = parts.stencil_pools;
  for (Index p = 0; p < static_cast<Index>(parts.row_pools.size()); ++p) {
    const RowPool& pool = *parts.row_pools[at(p)];
    if (pool.memory() == 0) continue;
    pool.start(
        std::span(state.extra).subspan(at(system->first_memory(p)), static_cast<std::size_t>(pool.memory())));
  }
  // Gravity acts on the mass that inertia has: with a lumped mass, free fall stays rigid. Statics has no
  // inertia and takes the consistent distribution, which is more accurate for Tet10.
  const bool lumped = options.scheme->has_inertia() && !options.consistent_mass;
  // Points without a body have lumped mass always.
  if (options.scheme->has_inertia()) weight = parts.mass;
  for (const BodyData& body : builder.bodies()) {
    if (lumped) break;
    std::fill_n(weight.begin() + body.first_node, body.mesh.nodes.size(), 0.0);
    for (const RegionData& region : body.regions) {
      add_nodal_volume(*body.reference, parts.rest, body.global_cells, region.cells, region.density, weight);
    }
  }
  if (std::any_of(parts.row_pools.begin(), parts.row_pools.end(),
                  [](const auto& p) { return p->looks_back() && p->rows() > 0; })) {
    no_past.assign(options.scheme->memory(n), 0);
    row_work.resize(2 * at(system->rows()));
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

SaddleProblem World::Impl::problem_at(double t) {
  evaluate_data(t);
  SaddleProblem problem;
  problem.force = force;
  problem.target = target;
  problem.prescribed = prescribed;
  problem.position = position;
  problem.t0 = state.t;
  problem.t1 = t;
  problem.memory = std::span<const double>(state.extra).first(at(system->memory()));
  problem.increment = {0, state.x, state.t, t};
  return problem;
}

SaddleOptions World::Impl::saddle_options(const Allowance& allowance) const {
  SaddleOptions saddle;
  saddle.max_iterations = allowance.iterations;
  if (allowance.keep_unfinished) saddle.budget = allowance.iterations;
  saddle.max_factorizations = allowance.factorizations;
  saddle.patient_iterations =
      allowance.patient_iterations > 0 ? allowance.patient_iterations : allowance.iterations;
  saddle.patient_factorizations =
      allowance.patient_factorizations > 0 ? allowance.patient_factorizations : allowance.factorizations;
  saddle.definiteness = options.definiteness;
  saddle.force_tolerance = options.force_tolerance;
  saddle.row_tolerance = options.row_tolerance;
  return saddle;
}

Result<void> World::Impl::replace_stencils(std::vector<std::shared_ptr<const StencilPool>> pools) {
  SystemParts parts = system->parts();
  parts.stencil_pools = std::move(pools);
  const StageSeconds spent = newton->seconds();
  if (auto r = make_method(std::move(parts), true); !r) return r;
  newton->add_seconds(spent);
  return {};
}

World::Impl::Surroundings World::Impl::look_around(std::span<const Vec3> x, bool solved) {
  Surroundings found;
  if (!system->has_followers()) return found;
  auto pools = system->parts().stencil_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    if (!pools[p]->follows()) continue;
    FollowRequest request{{}, state.x, x, solved, parallel.get()};
    if (!solved) {
      request.memory = std::span<const double>(state.extra)
                           .subspan(at(system->first_stencil_memory(static_cast<Index>(p))),
                                    static_cast<std::size_t>(pools[p]->memory()));
    }
    FollowAnswer answer = pools[p]->followed(request);
    found.crossed += answer.crossed;
    found.passing += answer.passing;
    if (!answer.pool) continue;
    found.changed = true;
    pools[p] = std::move(answer.pool);
  }
  if (!found.changed) return found;
  if (auto r = replace_stencils(std::move(pools)); !r) found.error = r.error();
  return found;
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

bool World::Impl::amounts_fit(std::span<const double> all) const {
  for (const auto& instance : instances) {
    if (instance->amount() && !Amount::take(all)) return false;
  }
  return all.empty();
}

void World::Impl::begin_amounts(double t0, double t1) {
  const bool quasi_static = !options.scheme->has_inertia();
  for (const auto& instance : instances) {
    // In dynamics a new value holds from the next step on; statics ramps to it.
    if (Amount* a = instance->amount()) a->begin(quasi_static ? t0 : t1, t1);
  }
}

void World::stop_when(std::function<bool()> asked) {
  impl_->stop_asked = std::move(asked);
}

void World::on_progress(std::function<void(const ProgressInfo&)> callback) {
  impl_->progress = std::move(callback);
}

}  // namespace isochor
