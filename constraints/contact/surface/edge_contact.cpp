#include "constraints/contact/surface/edge_contact.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"

namespace isochor {

namespace {

Result<void> find_overlap(const Builder& builder, const SurfaceContactDef& def, const EdgeContactPool& pool,
                          ContactRows& rows) {
  const SurfaceEdges& edges = *pool.setup().edges;
  std::vector<double> gap(rows.area.size(), pool.setup().open);
  for (Index s = 0; s < pool.stencils(); ++s) {
    if (pool.geometry().meets(s)) gap[at(s)] = pool.geometry().gap(s, builder.rest()).value;
  }
  // What a search of one body takes for rounding stays.
  const Overlap found = take_overlap(gap, def.against ? 0 : 1e-3 * edges.size(), builder.length(), rows);
  if (found.worst < 0 || def.initial_overlap == InitialOverlap::resolve) return {};
  const SurfaceEdge& edge = edges[found.worst];
  const BodyData& body = builder.body(edge.side == 1 ? *def.against : def.body);
  return Error{"surface contact \"" + def.name + "\": " + std::to_string(found.count) +
               " edges are past others that they cross at the start, the deepest by " +
               number(-found.deepest) + " m at nodes " + std::to_string(edge.node[0] - body.first_node) +
               " and " + std::to_string(edge.node[1] - body.first_node) + " of body \"" + body.name +
               "\"; move one of the two, or set initial_overlap to resolve to have them pushed apart"};
}

}  // namespace

Result<EdgeContact> EdgeContact::build(Builder& builder, const SurfaceContactDef& def,
                                       const ContactSurface& surface, const ContactLayer& layer) {
  EdgeContact out;
  auto setup = std::make_shared<EdgeContactPool::Setup>();
  auto edges = std::make_shared<SurfaceEdges>(surface, builder.rest());
  if (edges->count() == 0) return out;
  setup->edges = edges;
  std::vector<double> area(at(edges->count()));
  for (Index e = 0; e < edges->count(); ++e) area[at(e)] = (*edges)[e].area;
  const auto rows = pair_rows(builder, def, def.name + ", edges", layer, area, edges->size(), *setup);
  const auto pool = first_pairs(builder, EdgeContactPool(setup, std::vector<Index>(area.size(), -1)));
  if (auto r = find_overlap(builder, def, *pool, *rows); !r) return r.failure();
  rows->stencil_pool = builder.add_stencils(pool);
  out.row_pool_ = builder.add_rows(rows);
  out.rows_ = rows;
  return out;
}

void EdgeContact::pressing_points(const GaugeContext& c, std::vector<PressingPoint>& out) const {
  if (!rows_) return;
  const Index place = rows_->stencil_pool;
  const auto& pool = static_cast<const EdgeContactPool&>(*c.system.parts().stencil_pools[at(place)]);
  const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
  const auto memory = c.system.stencil_memory(place, std::span<const double>(c.state.extra));
  for (Index s = 0; s < pool.stencils(); ++s) {
    if (!pool.geometry().meets(s) || !(lambda[at(s)] < 0)) continue;
    const EdgeGap gap = pool.geometry().gap(s, c.state.x);
    const Vec3 push = pool.geometry().push(s, lambda[at(s)], c.state.x);
    PressingPoint p;
    const auto nodes = pool.nodes()[s];
    p.of = nodes[0];
    p.partner_of = nodes[kEdgeNodes];
    p.position = (1 - gap.place[0]) * c.state.x[at(nodes[0])] + gap.place[0] * c.state.x[at(nodes[1])];
    p.gap = gap.distance - pool.setup().offset;
    p.force = norm(push);
    p.normal = direction(push);
    p.friction = -1.0 * pool.kept_pull(SurfaceFrames{c.state.x, c.state.x}, s, memory);
    out.push_back(std::move(p));
  }
}

ContactTotals EdgeContact::totals(const GaugeContext& c) const {
  ContactTotals sum;
  if (!rows_) return sum;
  const Index place = rows_->stencil_pool;
  const auto& pool = static_cast<const EdgeContactPool&>(*c.system.parts().stencil_pools[at(place)]);
  const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
  const auto memory = c.system.stencil_memory(place, std::span<const double>(c.state.extra));
  for (Index s = 0; s < pool.stencils(); ++s) {
    if (!pool.geometry().meets(s)) continue;
    const EdgeGap gap = pool.geometry().gap(s, c.state.x);
    // Near the ends of edges corners take over.
    if (gap.weight > 0.5) sum.gap = std::min(sum.gap, gap.distance - pool.setup().offset);
    const double l = -lambda[at(s)];
    if (!(l > 0)) continue;
    const Vec3 pull = pool.kept_pull(SurfaceFrames{c.state.x, c.state.x}, s, memory);
    const double sign = (*pool.setup().edges)[s].side == 0 ? 1 : -1;
    sum.force += sign * (pool.geometry().push(s, -l, c.state.x) - pull);
    sum.normal += l * gap.weight;
    sum.tangential += std::sqrt(dot(pull, pull));
  }
  return sum;
}

}  // namespace isochor
