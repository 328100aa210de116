#include "isochor/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <utility>

#include "engine/base/out_of_memory.h"
#include "engine/base/stopwatch.h"
#include "engine/base/text.h"
#include "engine/step/step_report.h"
#include "engine/step/time_scheme.h"
#include "engine/world/recovery.h"
#include "engine/world/world_impl.h"

namespace isochor {

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World> World::create(WorldOptions options, std::uint64_t abi) {
  return create(std::move(options), {}, abi);
}

Result<World> World::create(WorldOptions options, Host host, std::uint64_t abi) try {
  if (abi != kWorldAbi) {
    return Error{
        "this program was built against other headers than the library, or with other settings of the "
        "compiler (" +
        std::to_string(abi) + ", not " + std::to_string(kWorldAbi) + "); rebuild the program"};
  }
  if (!options.scheme)
    return Error{
        "world: no time scheme; set WorldOptions::scheme to implicit_euler(), statics() or another of "
        "isochor/schemes.h "
        "(generalized_alpha takes a spectral radius from 0 to 1, static_until a positive time and a scheme "
        "of "
        "dynamics other than implicit_midpoint)"};
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
  if (host.threads && host.threads->threads() < 1) {
    return Error{"world: the host's thread pool has " + std::to_string(host.threads->threads()) +
                 " threads; it must have at least one"};
  }
  const Vec3& g = options.gravity;
  if (!std::isfinite(g.x) || !std::isfinite(g.y) || !std::isfinite(g.z)) {
    return Error{"world: gravity must be finite numbers"};
  }
  const auto has_solver = [&] {
    return host.ranks ? host.ranks->linear_solver(options.solver, false) != nullptr
                      : make_linear_solver(options.solver) != nullptr;
  };
  if (host.ranks && !has_solver()) {
    return Error{
        "world: the linear solver asked for does not work across ranks; use automatic, mumps or iterative, "
        "or "
        "run on one process"};
  }
  if (options.solver != Solver::automatic && !has_solver()) {
    return Error{
        "world: the linear solver asked for is not part of this build; `isochor version` lists those that "
        "are"};
  }
  if (host.log) options.log = std::move(host.log);
  std::unique_ptr<Parallel> parallel;
  if (host.threads)
    parallel = std::make_unique<HostParallel>(std::move(host.threads));
  else
    parallel = std::make_unique<TbbParallel>(options.threads);
  return World(std::make_unique<Impl>(std::move(options), std::move(parallel), std::move(host.ranks)));
} catch (const std::bad_alloc&) {
  return no_memory("create");
}

Description& World::Impl::open_draft() {
  if (!scene_made()) return said;
  if (!draft) draft = Description{said.builder.again(), said.places, said.sources, said.order};
  return *draft;
}

Result<BodyId> World::add_body(BodyDef body) try {
  Builder& builder = impl_->open_draft().builder;
  auto place = builder.add_body(body);
  if (!place) return place.failure();
  return WorldNumbers::make<BodyTag>(place.value(), builder.world(),
                                     builder.body_slots().generation(place.value()));
} catch (const std::bad_alloc&) {
  return no_memory("add_body");
}

Result<EffectId> World::add(EffectPtr effect) try {
  if (!effect) return Error{"world: an empty effect was added"};
  if (auto r = effect->check(); !r) return r.failure();
  Description& d = impl_->open_draft();
  d.sources.reserve(at(d.places.size()) + 1);
  d.order.reserve(d.order.size() + 1);
  const Index place = d.places.take();
  d.sources.resize(at(d.places.size()));
  d.sources[at(place)] = std::move(effect);
  d.order.push_back(place);
  return WorldNumbers::make<EffectTag>(place, d.builder.world(), d.places.generation(place));
} catch (const std::bad_alloc&) {
  return no_memory("add");
}

namespace {

// The end of a sentence on an id that leads nowhere; empty where it leads to something.
template <class What>
std::string no_such(const Id<What>& id, const std::string& thing, const Slots& places,
                    const Builder& builder) {
  return why_not(WorldNumbers::look_up(id, places, builder.world()), thing, id.number(), places.taken());
}

}  // namespace

Result<void> World::check(BodyId body) const {
  const Builder& builder = impl_->latest().builder;
  const std::string why = no_such(body, "body", builder.body_slots(), builder);
  if (why.empty()) return {};
  return Error{why};
}

Result<void> World::check(EffectId effect) const {
  const Description& d = impl_->latest();
  const std::string why = no_such(effect, "effect", d.places, d.builder);
  if (why.empty()) return {};
  return Error{why};
}

const BodyData* World::Impl::find_body(BodyId body, const char* call) {
  if (draft) (void)ready();
  const std::string why = no_such(body, "body", said.builder.body_slots(), said.builder);
  if (why.empty()) return &said.builder.body(body);
  tell(std::string(call) + ": " + why);
  return nullptr;
}

void World::Impl::tell(const std::string& refusal) {
  if (options.log)
    options.log(refusal);
  else
    std::fprintf(stderr, "isochor: %s\n", refusal.c_str());
}

Result<void> World::Impl::compile() {
  if (!compile_error.empty()) {
    // Of a first attempt the reason stays. What a change failed for is told once: it was taken back.
    if (!scene_made()) return Error{compile_error};
    return Error{std::exchange(compile_error, {})};
  }
  if (compiled() && !draft) return {};
  try {
    if (scene_made()) {
      if (auto r = mend(); !r || !draft) return r;
    }
    return compile_now();
  } catch (const std::bad_alloc&) {
    if (!scene_made()) used_up = true;
    return no_memory("compile");
  }
}

// What memory did not suffice for, behind a scene that is there: who solves, with the stencils of the state,
// and who makes steps.
Result<void> World::Impl::mend() {
  const bool dropped = !methods.ready();
  if (dropped) methods.remake();
  if (!controller) make_controller();
  return dropped ? put_stencils_back() : Result<void>{};
}

// Those of the state, or none at all.
Result<void> World::Impl::put_stencils_back() try {
  auto restored = controller->stepper().surroundings().restore(pool_memory());
  if (!restored) methods.drop();
  return restored;
} catch (const std::bad_alloc&) {
  methods.drop();
  throw;
}

Result<void> World::Impl::compile_now() {
  if (used_up) {
    said.builder = said.builder.again();
    used_up = false;
  }
  const std::vector<std::string> told = compiled() ? said.builder.warnings() : std::vector<std::string>();
  const auto result = compiled() ? renew() : compile_first();
  if (result) {
    untold.work = std::max(untold.work, compile_report.work);
    untold.seconds += compile_report.seconds;
  }
  for (const std::string& warning : said.builder.warnings()) {
    const bool known = std::find(told.begin(), told.end(), warning) != told.end();
    if (options.log && !known) options.log(warning);
  }
  if (result || compiled()) return result;
  // A builder is used up by a failed attempt; the reason stays. Wrong units make supports miss their nodes
  // and probes their cells, so whoever did not hear of them does so here.
  compile_error = result.error() + (options.log ? "" : said.builder.doubtful_units());
  return Error{compile_error};
}

bool World::Impl::ready() {
  if (compiled() && !draft) return true;
  if (auto r = compile(); !r && scene_made()) {
    if (options.log) options.log(r.error());
    if (compiled()) compile_error = r.error();
  }
  return compiled();
}

namespace {

// Memory goes from the end of one increment to the end of the next.
Result<void> check_memory(const Builder& builder, const TimeScheme& scheme) {
  if (scheme.evaluated_at() == 1 && !scheme.follows_paths()) return {};
  for (const BodyData& body : builder.bodies()) {
    for (const RegionData& region : body.regions) {
      // Paths have no time to flow in; what is kept of stresses needs none.
      const bool refused = scheme.follows_paths() ? !region.memory_pools.empty() : region.remembers;
      if (!body.present() || !refused) continue;
      return Error{
          "body \"" + body.name + "\", region \"" + region.name + "\": the material " +
          std::string(region.material->name()) + " remembers, and the scheme " + std::string(scheme.name()) +
          (scheme.follows_paths() ? " follows a path that has no time; use statics(), or let statics "
                                    "be long-term"
                                  : " balances forces in the middle of a step; use another scheme of "
                                    "dynamics")};
    }
  }
  return {};
}

}  // namespace

Result<BuiltParts> build_parts(Description& said, const WorldOptions& options) {
  Builder& builder = said.builder;
  BuiltParts built;
  builder.set_quasi_static(!options.scheme->has_inertia());
  for (const Index e : said.order) {
    if (auto r = said.sources[at(e)]->declare(builder); !r) return r.failure();
  }
  if (options.consistent_mass && options.scheme->has_inertia()) builder.use_consistent_mass();
  if (auto r = builder.build_solids(); !r) return r.failure();
  if (auto r = check_memory(builder, *options.scheme); !r) return r.failure();
  built.instances.resize(said.sources.size());
  for (const Index e : said.order) {
    builder.set_owner(e);
    auto instance = said.sources[at(e)]->build(builder);
    if (!instance) return instance.failure();
    built.instances[at(e)] = std::move(instance).value();
  }
  builder.set_owner(-1);
  built.held_by = builder.held_directions(said.sources.size());
  auto parts = builder.finish(!options.scheme->has_inertia());
  if (!parts) return parts.failure();
  built.parts = std::move(parts).value();
  return built;
}

Result<void> World::Impl::compile_first() {
  const Stopwatch watch(compile_report.seconds);
  auto built = build_parts(said, options);
  if (!built) return built.failure();
  instances = std::move(built.value().instances);
  held_by = std::move(built.value().held_by);
  if (auto r = methods.choose(std::move(built.value().parts)); !r) return r;
  tell_idle_rows();
  if (system().renews_stencils()) first_stencils = system().parts().stencil_pools;
  begin_state();
  compile_report.work = CompileWork::structure;
  make_controller();
  return {};
}

// Rows that supports leave nothing to do, by the effect that they are of.
void World::Impl::tell_idle_rows() {
  std::map<std::string, std::pair<Index, Index>> of_pool;  // idle rows, all rows
  const auto& pools = system().parts().row_pools;
  for (Index p = 0; p < static_cast<Index>(pools.size()); ++p) {
    const RowPool& pool = *pools[at(p)];
    if (pool.law != RowLaw::compliant) continue;
    const auto first = system().first_row(p);
    const auto idle = std::count_if(system().idle_rows().begin(), system().idle_rows().end(),
                                    [&](Index r) { return r >= first && r < first + pool.rows(); });
    auto& [count, all] = of_pool[std::string(pool.name())];
    count += static_cast<Index>(idle);
    all += pool.rows();
  }
  for (const auto& [name, counts] : of_pool) {
    if (counts.first == 0) continue;
    said.builder.warn(
        "\"" + name + "\": " + std::to_string(counts.first) + " of its " + std::to_string(counts.second) +
        (counts.first == 1 ? " rows has" : " rows have") +
        " no free coordinate, as supports hold all nodes that enter; what supports do there is not "
        "held against it");
    if (options.log) options.log(said.builder.warnings().back());
  }
}

// Gravity acts on the mass that inertia has: with a lumped mass, free fall stays rigid. Statics has no
// inertia and takes the consistent distribution, which is more accurate for Tet10.
std::vector<double> gravity_mass(const Builder& builder, const SystemParts& parts,
                                 const WorldOptions& options) {
  std::vector<double> weight(parts.rest.size(), 0);
  const bool lumped = options.scheme->has_inertia() && !options.consistent_mass;
  // Points without a body have lumped mass always.
  if (options.scheme->has_inertia()) weight = parts.mass;
  for (const BodyData& body : builder.bodies()) {
    if (lumped) break;
    if (!body.present()) continue;
    std::fill_n(weight.begin() + body.first_node, body.mesh.nodes.size(), 0.0);
    for (const RegionData& region : body.regions) {
      add_nodal_volume(*body.reference, parts.rest, body.global_cells, region.cells, region.density, weight);
    }
    const auto lent = builder.lent_mass();
    for (std::size_t i = at(body.first_node);
         i < std::min(at(body.first_node) + body.mesh.nodes.size(), lent.size()); ++i)
      weight[i] += lent[i];
  }
  return weight;
}

// Views of positions stay good where nodes are as many as before; others are left to who keeps them first.
void World::Impl::take_over(State&& next) noexcept {
  const auto keep = [](std::vector<Vec3>& present, std::vector<Vec3>& list) {
    if (present.size() != list.size()) return;
    std::copy(list.begin(), list.end(), present.begin());
    list.swap(present);
  };
  keep(state.x, next.x);
  keep(state.v, next.v);
  state = std::move(next);
}

// The state at rest, and who advances it.
void World::Impl::begin_state() {
  const SystemParts& parts = system().parts();
  const std::size_t n = at(system().nodes());
  State rest;
  rest.x = parts.rest;
  rest.v.assign(n, Vec3{});
  rest.lambda.assign(at(system().rows()), 0.0);
  rest.reactions.assign(n, Vec3{});
  layout.pools = at(system().memory());
  layout.scheme = options.scheme->memory().numbers(n);
  // Last increment's length and suggestion for the next, then velocities before it.
  layout.error = options.time_error > 0 && options.scheme->has_inertia() ? 2 + 3 * n : 0;
  rest.extra.assign(layout.size(), 0.0);
  system().start_memory(std::span(rest.extra).first(layout.pools));
  take_over(std::move(rest));
}

void World::Impl::make_controller() {
  data.emplace(system(), amounts.gravity, state, gravity_mass(said.builder, system().parts(), options));
  controller.emplace(
      StepContext{options, said.builder.bodies(), *parallel, methods, *data, state, layout, first_stencils},
      amounts, interrupt, settled);
  controller->stepper().on_progress(progress);
}

Result<void> World::compile() {
  return impl_->compile();
}

Result<void> World::set_amount(EffectId effect, double amount) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  if (auto r = check(effect); !r) return Error{"set_amount: " + r.error()};
  const auto i = static_cast<std::size_t>(effect);
  const std::string& name = w.said.sources[i]->name();
  Amount* a = w.instances[i]->amount();
  if (!a) return Error{"set_amount: effect \"" + name + "\" has no amount to set"};
  if (!std::isfinite(amount)) {
    return Error{"set_amount: effect \"" + name + "\": the amount must be a finite number"};
  }
  a->set(amount);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("set_amount");
}

template <class Step>
StepReport World::Impl::after_compile(Step&& step) {
  if (auto r = compile(); !r) return invalid_step(r.error(), state.t);
  StepReport report = step();
  report.compiled = std::exchange(untold, {});
  return report;
}

StepReport World::step(double h) {
  return step(h, {});
}

StepReport World::step(double h, const StepBudget& budget) {
  return impl_->after_compile([&] { return impl_->controller->step(h, budget); });
}

StepReport World::advance(double h) {
  return impl_->after_compile([&] { return impl_->controller->advance(h); });
}

StepReport World::follow(double length) {
  return impl_->after_compile([&] { return impl_->controller->follow(length); });
}

void World::cancel() {
  impl_->interrupt.request();
}

std::string World::method() const {
  if (!impl_->ready()) return {};
  return impl_->methods.description();
}

void World::stop_when(std::function<bool()> asked) {
  impl_->interrupt.ask(std::move(asked));
}

void World::on_progress(std::function<void(const ProgressInfo&)> callback) {
  impl_->progress = std::move(callback);
  if (impl_->controller) impl_->controller->stepper().on_progress(impl_->progress);
}

}  // namespace isochor
