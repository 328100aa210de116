#include "constraints/contact/surface/edge_contact.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"

namespace isochor {

namespace {

Result<void> find_overlap(const Builder& builder, const SurfaceContactDef& def, const EdgeContactPool& pool,
                          ContactRows& rows) {
  const SkinEdges& edges = *pool.setup().edges;
  const double shallow = -1e-9 * builder.length();
  // What a search of one body takes for rounding stays.
  const double groove = def.against ? 0 : -1e-3 * edges.size();
  std::vector<double> overlap(rows.area.size(), 0.0), allowed = overlap;
  Index worst = -1, count = 0;
  for (Index s = 0; s < pool.stencils(); ++s) {
    if (!pool.has_partner(s)) continue;
    const double value = pool.gap(s, builder.rest()).value;
    if (value >= shallow) continue;
    if (value >= groove) {
      allowed[at(s)] = value;
      continue;
    }
    overlap[at(s)] = value;
    ++count;
    if (worst < 0 || value < overlap[at(worst)]) worst = s;
  }
  if (std::any_of(allowed.begin(), allowed.end(), [](double a) { return a < 0; }))
    rows.allowed = std::move(allowed);
  if (count == 0) return {};
  if (def.initial_overlap == InitialOverlap::resolve) {
    rows.overlap = std::move(overlap);
    return {};
  }
  const SkinEdge& edge = edges[worst];
  const BodyData& body = builder.body(edge.side == 1 ? *def.against : def.body);
  return Error{"surface contact \"" + def.name + "\": " + std::to_string(count) +
               " edges are past others that they cross at the start, the deepest by " +
               number(-overlap[at(worst)]) + " m at nodes " + std::to_string(edge.node[0] - body.first_node) +
               " and " + std::to_string(edge.node[1] - body.first_node) + " of body \"" + body.name +
               "\"; move one of the two, or set initial_overlap to resolve to have them pushed apart"};
}

}  // namespace

Result<EdgeContact> EdgeContact::build(Builder& builder, const SurfaceContactDef& def, const Skin& skin,
                                       const ContactLayer& layer) {
  EdgeContact out;
  auto setup = std::make_shared<EdgeContactPool::Setup>();
  auto edges = std::make_shared<SkinEdges>(skin, builder.rest());
  if (edges->count() == 0) return out;
  setup->name = def.name + ", edges";
  setup->edges = edges;
  setup->offset = def.thickness;
  setup->friction = {def.friction, def.static_friction};
  setup->coupled = def.coupling == FrictionCoupling::coupled;
  setup->open = builder.length();
  auto rows = std::make_shared<ContactRows>(setup->name, def.resolve_time);
  for (Index e = 0; e < edges->count(); ++e) {
    const double area = (*edges)[e].area;
    // Both edges of a pair carry half of the force.
    rows->add(layer.modulus, area, builder.length(), 2 * layer.compliance);
    if (std::isfinite(layer.knee)) rows->knee.push_back(0.5 * area * layer.knee);
    setup->stick.push_back(def.stick_stiffness > 0 ? 0.5 * def.stick_stiffness * area
                                                   : 50 * layer.modulus * area / edges->size());
  }
  std::shared_ptr<const StencilPool> pool =
      std::make_shared<EdgeContactPool>(setup, std::vector<Index>(at(edges->count()), -1));
  const std::vector<double> nothing(static_cast<std::size_t>(pool->memory()), 0);
  const FollowAnswer start = pool->followed({nothing, builder.rest(), builder.rest(), false, nullptr});
  if (start.pool) pool = start.pool;
  if (auto r = find_overlap(builder, def, static_cast<const EdgeContactPool&>(*pool), *rows); !r)
    return Error{r.error()};
  rows->largest_overshoot = 0.25 * edges->size();
  rows->stencil_pool = builder.add_stencils(pool);
  out.row_pool_ = builder.add_rows(rows);
  out.rows_ = std::move(rows);
  return out;
}

EdgeContact::Totals EdgeContact::totals(const GaugeContext& c) const {
  Totals sum;
  if (!rows_) return sum;
  const Index place = rows_->stencil_pool;
  const auto& pool = static_cast<const EdgeContactPool&>(*c.system.parts().stencil_pools[at(place)]);
  const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
  const auto memory =
      std::span<const double>(c.state.extra)
          .subspan(at(c.system.first_stencil_memory(place)), static_cast<std::size_t>(pool.memory()));
  for (Index s = 0; s < pool.stencils(); ++s) {
    if (!pool.has_partner(s)) continue;
    const EdgeGap gap = pool.gap(s, c.state.x);
    // Near the ends of edges corners take over.
    if (gap.weight > 0.5) sum.gap = std::min(sum.gap, gap.distance - pool.setup().offset);
    const double l = -lambda[at(s)];
    if (!(l > 0)) continue;
    const Vec3 pull = pool.kept_pull(s, memory, c.state.x);
    const double sign = (*pool.setup().edges)[s].side == 0 ? 1 : -1;
    sum.force += sign * (pool.push(s, -l, c.state.x) - pull);
    sum.normal += l * gap.weight;
    sum.tangential += std::sqrt(dot(pull, pull));
  }
  return sum;
}

}  // namespace isochor
