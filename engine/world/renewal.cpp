// A compiled world that changes: its scene is built anew beside the present one, the state moves over, and
// only then the new one takes its place. What fails on the way leaves everything as it was.
//
//   build        parts and live effects of the changed scene
//   move         what the state says of nodes, rows and memory that stay (inventory.h)
//   stencils     those that change with what is close, as the state remembers them
//   methods      go on with other numbers, or with another structure (Methods::renew)
//   take over    amounts and poses that the host has set, the state, and who makes steps
//
// Where memory runs out before methods have gone on, all is as it was. What comes after that takes none, but
// who makes steps, whom the next call makes then (World::Impl::mend).
#include <algorithm>

#include "engine/base/stopwatch.h"
#include "engine/world/inventory.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

// Stencils of the new parts as the numbers tell that their pools keep.
Result<void> restore_stencils(const SystemFacets& facets, std::span<const double> memory,
                              SystemParts& parts) {
  for (const auto& [p, stencils] : facets.renewed) {
    for (const auto& remembering : facets.remembering) {
      if (remembering.pool != p) continue;
      const auto kept = remembering.in(memory);
      // Zeros: no step has been accepted with them.
      if (std::all_of(kept.begin(), kept.end(), [](double v) { return v == 0; })) continue;
      auto restored = stencils->restored(kept);
      if (!restored) return restored.failure();
      parts.stencil_pools[at(p)] = std::move(restored).value();
    }
  }
  return {};
}

// What a host has set of the effects that stay.
void carry_settings(const std::vector<std::unique_ptr<EffectInstance>>& from, const Description& before,
                    const std::vector<std::unique_ptr<EffectInstance>>& to, const Description& after) {
  for (const Index e : after.order) {
    if (!before.places.holds(e) || before.places.generation(e) != after.places.generation(e)) continue;
    std::vector<double> numbers;
    Amount *a = from[at(e)]->amount(), *b = to[at(e)]->amount();
    LivePose *p = from[at(e)]->pose(), *q = to[at(e)]->pose();
    if (a && b) {
      a->save(numbers);
      std::span<const double> in(numbers);
      b->load(in);
    }
    numbers.clear();
    if (p && q) {
      p->save(numbers);
      std::span<const double> in(numbers);
      q->load(in);
    }
  }
}

}  // namespace

Result<void> World::Impl::renew() {
  CompileReport report;
  Description next = std::move(*draft);
  draft.reset();
  {
    const Stopwatch watch(report.seconds);
    auto built = build_parts(next, options);
    if (!built) return built.failure();
    SystemParts& parts = built.value().parts;
    const SystemFacets facets(parts.stencil_pools, parts.row_pools);
    const Moving moving(take_inventory(said, system().parts(), system().facets()),
                        take_inventory(next, parts, facets));
    StateLayout next_layout = layout;
    next_layout.pools = facets.memory;
    next_layout.scheme = options.scheme->memory().numbers(parts.rest.size());
    if (layout.error > 0) next_layout.error = 2 + 3 * parts.rest.size();
    std::vector<double> memory(facets.memory, 0.0);
    for (const auto& rows : facets.remembering_rows) rows.facet->start(rows.in(std::span(memory)));
    const Moving::After after{parts.rest, memory, next_layout, *options.scheme};
    State moved = moving.moved(state, layout, after);
    std::optional<State> moved_settled;
    if (settled) moved_settled = moving.moved(*settled, layout, after);
    auto first = facets.renewed.empty() ? decltype(first_stencils){} : parts.stencil_pools;
    if (auto r =
            restore_stencils(facets, std::span<const double>(moved.extra).first(next_layout.pools), parts);
        !r)
      return r;
    carry_settings(instances, said, built.value().instances, next);
    // Views of bodies that are gone are not to show others.
    const bool other_nodes =
        said.builder.body_slots() != next.builder.body_slots() || state.x.size() != moved.x.size();
    auto new_views = std::make_shared<LeftViews>();
    const auto renewed = methods.renew(std::move(parts));
    if (!renewed) return renewed.failure();

    if (other_nodes) leave_views(std::move(new_views));
    instances = std::move(built.value().instances);
    held_by = std::move(built.value().held_by);
    said = std::move(next);
    first_stencils = std::move(first);
    described.clear();
    layout = next_layout;
    take_over(std::move(moved));
    settled = std::move(moved_settled);
    report.work =
        renewed.value() == Methods::Renewed::numbers ? CompileWork::numbers : CompileWork::structure;
    controller.reset();
    make_controller();
    tell_idle_rows();
  }
  compile_report = report;
  return {};
}

// The changed scene as it would be at the present state; nothing of this world changes.
Result<BuiltParts> World::Impl::build_beside(Description& next) {
  auto built = build_parts(next, options);
  if (!built) return Error{built.error()};
  SystemParts& parts = built.value().parts;
  const SystemFacets facets(parts.stencil_pools, parts.row_pools);
  if (facets.memory != layout.pools)
    return Error{"the scene remembers other things then, so that there is no derivative"};
  if (auto r = restore_stencils(facets, pool_memory(), parts); !r) return Error{r.error()};
  carry_settings(instances, said, built.value().instances, next);
  return built;
}

// The state of `other`, whose scene is this one's and whose tables are shared.
Result<void> World::Impl::compile_like(Impl& other) {
  const Stopwatch watch(compile_report.seconds);
  auto built = build_parts(said, options);
  if (!built) return built.failure();
  SystemParts& parts = built.value().parts;
  const SystemFacets facets(parts.stencil_pools, parts.row_pools);
  if (!facets.renewed.empty()) first_stencils = parts.stencil_pools;
  if (auto r = restore_stencils(facets, other.pool_memory(), parts); !r) return r;
  instances = std::move(built.value().instances);
  held_by = std::move(built.value().held_by);
  if (auto r = methods.choose(std::move(parts), &other.system()); !r) return r;
  begin_state();
  make_controller();
  state = other.state;
  std::vector<double> set;
  other.amounts.save(set);
  amounts.load(set);
  data->evaluate(system(), state.t);
  settled = other.settled;
  compile_report.work = CompileWork::structure;
  return {};
}

}  // namespace isochor
