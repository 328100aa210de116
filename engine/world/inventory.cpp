#include "engine/world/inventory.h"

#include <algorithm>

namespace isochor {

namespace {

void add_rows(const SystemParts& parts, const std::vector<Index>& owner_of_pool, Inventory& all) {
  for (std::size_t p = 0; p < parts.row_pools.size(); ++p) {
    const RowPool& pool = *parts.row_pools[p];
    if (pool.law != RowLaw::compliant) continue;
    for (std::size_t r = 0; r < at(pool.rows()); ++r, ++all.rows) {
      const Index owner = pool.owner.empty() ? owner_of_pool[p] : pool.owner[r];
      if (owner < 0) continue;
      auto& rows = all.effects[at(owner)].rows;
      const bool goes_on = !rows.empty() && rows.back().first + rows.back().count == all.rows;
      if (goes_on)
        ++rows.back().count;
      else
        rows.push_back({all.rows, 1});
    }
  }
}

// Rows of several effects share what their pool keeps evenly.
void add_memory(const SystemParts& parts, const SystemFacets& facets, const Owners& owners, Inventory& all) {
  for (const auto& rows : facets.remembering_rows) {
    const auto& owner = parts.row_pools[at(rows.pool)]->owner;
    if (owner.empty()) {
      const Index effect = owners.row_pool[at(rows.pool)];
      if (effect >= 0) all.effects[at(effect)].memory.push_back({rows.first, rows.count});
      continue;
    }
    const std::size_t share = rows.count / owner.size();
    for (std::size_t r = 0; r < owner.size(); ++r)
      all.effects[at(owner[r])].memory.push_back({rows.first + r * share, share});
  }
  for (const auto& stencils : facets.remembering) {
    const Index effect = owners.stencil_pool[at(stencils.pool)];
    if (effect >= 0) all.effects[at(effect)].memory.push_back({stencils.first, stencils.count});
  }
}

// What the materials of a body keep.
void add_memory(const BodyData& body, const SystemFacets& facets, Inventory::Of& of) {
  const auto add = [&](Index pool) {
    for (const auto& stencils : facets.remembering) {
      if (stencils.pool == pool) of.memory.push_back({stencils.first, stencils.count});
    }
  };
  for (const RegionData& region : body.regions) {
    add(region.elastic_pool);
    for (const Index pool : region.memory_pools) add(pool);
  }
}

}  // namespace

Inventory take_inventory(const Description& said, const SystemParts& parts, const SystemFacets& facets) {
  Inventory all;
  const Builder& builder = said.builder;
  all.bodies.resize(builder.bodies().size());
  for (std::size_t b = 0; b < all.bodies.size(); ++b) {
    const BodyData& body = builder.bodies()[b];
    if (!body.present()) continue;
    const auto place = static_cast<Index>(b);
    all.bodies[b] = {true,
                     builder.body_slots().generation(place),
                     {{at(body.first_node), body.mesh.nodes.size()}},
                     {},
                     {}};
    add_memory(body, facets, all.bodies[b]);
  }
  all.effects.resize(said.sources.size());
  for (const Index e : said.order) {
    all.effects[at(e)].present = true;
    all.effects[at(e)].generation = said.places.generation(e);
  }
  const Owners& owners = builder.owners();
  for (std::size_t n = 0; n < owners.point.size(); ++n) {
    if (owners.point[n] >= 0) all.effects[at(owners.point[n])].nodes.push_back({n, 1});
  }
  add_rows(parts, owners.row_pool, all);
  add_memory(parts, facets, owners, all);
  return all;
}

Moving::Moving(const Inventory& before, const Inventory& after) : rows_after_(after.rows) {
  const auto each = [](const std::vector<Inventory::Of>& a, const std::vector<Inventory::Of>& b, auto&& f) {
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      if (a[i].present && b[i].present && a[i].generation == b[i].generation) f(a[i], b[i]);
    }
  };
  each(before.bodies, after.bodies, [&](const auto& a, const auto& b) {
    match(a.nodes, b.nodes, nodes_);
    match(a.memory, b.memory, memory_);
  });
  each(before.effects, after.effects, [&](const auto& a, const auto& b) {
    match(a.nodes, b.nodes, nodes_);
    match(a.rows, b.rows, rows_);
    match(a.memory, b.memory, memory_);
  });
}

// All or nothing: of lists of other lengths nobody knows which is which.
void Moving::match(const std::vector<Stretch>& from, const std::vector<Stretch>& to, std::vector<Way>& ways) {
  std::size_t have = 0, want = 0;
  for (const Stretch& s : from) have += s.count;
  for (const Stretch& s : to) want += s.count;
  if (have != want) return;
  std::size_t f = 0, in_from = 0;
  for (const Stretch& s : to) {
    for (std::size_t done = 0; done < s.count;) {
      while (in_from == from[f].count) {
        ++f;
        in_from = 0;
      }
      const std::size_t count = std::min(s.count - done, from[f].count - in_from);
      ways.push_back({from[f].first + in_from, s.first + done, count});
      in_from += count;
      done += count;
    }
  }
}

template <class T>
void Moving::carry(const std::vector<Way>& ways, std::span<const T> from, std::span<T> to) {
  for (const Way& w : ways)
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(w.from), w.count,
                to.begin() + static_cast<std::ptrdiff_t>(w.to));
}

// Nodes that are new have been where they are, at the velocity that they have.
void Moving::carry_scheme(const State& before, std::span<const double> from, State& state,
                          std::span<double> to, const TimeScheme& scheme) const {
  const SchemeMemory kept = scheme.memory();
  const std::size_t old_nodes = before.x.size(), nodes = state.x.size();
  std::copy_n(from.begin(), kept.before, to.begin());
  for (std::size_t v = 0; v < kept.vectors; ++v) {
    const auto target = to.subspan(kept.before + 3 * nodes * v, 3 * nodes);
    const auto source = from.subspan(kept.before + 3 * old_nodes * v, 3 * old_nodes);
    if (kept.starts[v] != SchemeMemory::Starts::zero) {
      const auto& like = kept.starts[v] == SchemeMemory::Starts::position ? state.x : state.v;
      for (std::size_t i = 0; i < nodes; ++i) {
        for (int k = 0; k < 3; ++k) target[3 * i + static_cast<std::size_t>(k)] = like[i][k];
      }
    }
    for (const Way& w : nodes_)
      std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(3 * w.from), 3 * w.count,
                  target.begin() + static_cast<std::ptrdiff_t>(3 * w.to));
  }
  std::copy_n(from.end() - static_cast<std::ptrdiff_t>(kept.after), kept.after,
              to.end() - static_cast<std::ptrdiff_t>(kept.after));
}

// Of the control of errors: two lengths, then a velocity a node.
void Moving::carry_error(std::span<const double> from, std::span<double> to) const {
  if (from.empty() || to.empty()) return;
  std::copy_n(from.begin(), 2, to.begin());
  for (const Way& w : nodes_)
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(2 + 3 * w.from), 3 * w.count,
                to.begin() + static_cast<std::ptrdiff_t>(2 + 3 * w.to));
}

State Moving::moved(const State& before, const StateLayout& layout, const After& after) const {
  State state;
  const std::size_t n = after.rest.size();
  state.t = before.t;
  state.x.assign(after.rest.begin(), after.rest.end());
  state.v.assign(n, Vec3{});
  state.reactions.assign(n, Vec3{});
  carry<Vec3>(nodes_, before.x, state.x);
  carry<Vec3>(nodes_, before.v, state.v);
  carry<Vec3>(nodes_, before.reactions, state.reactions);
  state.lambda.assign(rows_after_, 0.0);
  carry<double>(rows_, before.lambda, state.lambda);
  if (!before.forces.empty()) {
    state.forces.assign(n, Vec3{});
    carry<Vec3>(nodes_, before.forces, state.forces);
  }
  state.extra.assign(after.layout.size(), 0.0);
  const std::span<const double> from(before.extra);
  const std::span<double> to(state.extra);
  std::copy(after.memory.begin(), after.memory.end(), to.begin());
  carry<double>(memory_, from.first(layout.pools), to.first(after.layout.pools));
  carry_scheme(before, from.subspan(layout.pools, layout.scheme), state,
               to.subspan(after.layout.pools, after.layout.scheme), after.scheme);
  carry_error(from.subspan(layout.pools + layout.scheme),
              to.subspan(after.layout.pools + after.layout.scheme));
  return state;
}

}  // namespace isochor
