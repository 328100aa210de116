#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "constraints/contact/surface/edge_contact.h"
#include "constraints/contact/surface/surface_contact_pool.h"
#include "constraints/stencil/surface_nodes.h"
#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "engine/scene/embedding.h"
#include "isochor/effects/contact.h"

namespace isochor {

namespace {

// The layer that stands for a hard contact: its thickness over the size of a face, and the pressure up to
// which it is linear over the shear modulus of the softer body. In the folds of one body, whose flanks meet
// at angles that faces this size do not follow, one that is thinner or stiffens finds no equilibrium.
struct DefaultLayer {
  double thickness = 0, knee = 0;
};
constexpr DefaultLayer kBetweenBodies{0.001, 4}, kWithinBody{0.02, std::numeric_limits<double>::infinity()};

class SurfaceContactInstance final : public EffectInstance {
 public:
  SurfaceContactInstance(std::shared_ptr<const ContactRows> rows, Index row_pool,
                         std::shared_ptr<const ContactSurface> surface, EdgeContact edges)
      : rows_(std::move(rows)), row_pool_(row_pool), surface_(std::move(surface)), edges_(std::move(edges)) {
    for (const SurfacePoint& p : surface_->points()) {
      for (std::size_t k = 0; k < p.nodes; ++k) {
        auto& area = area_[{p.node[k], p.sheet}];
        area[0] += p.weight[k] * p.area;
        area[1] += std::abs(p.weight[k]) * p.area;
      }
    }
  }

  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    const auto& pool = pool_of(c);
    const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
    const auto memory = memory_of(c);
    const auto& points = pool.setup().surface->points();
    const bool between = !pool.setup().surface->single();  // within a body forces cancel
    ContactTotals sum;
    for (Index s = 0; s < pool.stencils(); ++s) {
      if (!pool.geometry().meets(s)) continue;
      const PatchPoint near = pool.geometry().nearest(s, c.state.x);
      if (!std::isfinite(near.distance)) continue;
      sum.gap = std::min(sum.gap, near.distance - pool.setup().offset);
      const double l = -lambda[at(s)];
      if (!(l > 0)) continue;
      const Vec3 pull = pool.kept_pull(SurfaceFrames{c.state.x, c.state.x}, s, memory);
      const double sign = points[at(s)].side == 0 ? 1 : -1;
      if (between) sum.force += sign * (l * near.normal - pull);
      sum.normal += l;
      sum.depth = std::max(sum.depth, rows_->depth(s, -l) / surface_->size());
      sum.tangential += std::sqrt(dot(pull, pull));
      sum.area += 0.5 * rows_->area[at(s)];
    }
    const ContactTotals edges = edges_.totals(c);
    if (between) sum.force += edges.force;
    sum.normal += edges.normal;
    sum.tangential += edges.tangential;
    sum.gap = std::min(sum.gap, edges.gap);
    SurfaceForces at_nodes;
    surface_forces(c, at_nodes);
    for (std::size_t i = 0; i < at_nodes.area.size(); ++i) {
      if (at_nodes.area[i] > 0) sum.pressure = std::max(sum.pressure, at_nodes.normal[i] / at_nodes.area[i]);
    }
    add_gauges(rows_->name(), sum, out);
  }

  void pressing_points(const GaugeContext& c, std::vector<PressingPoint>& out) const override {
    const auto& pool = pool_of(c);
    const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
    const auto memory = memory_of(c);
    for (Index s = 0; s < pool.stencils(); ++s) {
      if (!pool.geometry().meets(s) || !(lambda[at(s)] < 0)) continue;
      const PatchPoint near = pool.geometry().nearest(s, c.state.x);
      if (!std::isfinite(near.distance)) continue;
      const SurfacePoint& point = pool.setup().surface->points()[at(s)];
      PressingPoint p;
      p.of = point.node[0];
      if (point.nodes == 1) p.node = point.node[0];
      p.partner_of = pool.nodes()[s][point.nodes];
      p.position = point.position(c.state.x);
      p.gap = near.distance - pool.setup().offset;
      p.normal = near.normal;
      p.force = -lambda[at(s)];
      p.friction = -1.0 * pool.kept_pull(SurfaceFrames{c.state.x, c.state.x}, s, memory);
      p.area = 0.5 * rows_->area[at(s)];
      out.push_back(std::move(p));
    }
    edges_.pressing_points(c, out);
  }

  bool surface_forces(const GaugeContext& c, SurfaceForces& f) const override {
    const auto& pool = pool_of(c);
    const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
    const auto memory = memory_of(c);
    const auto& points = pool.setup().surface->points();
    const std::size_t count = c.state.x.size();
    f.normal.assign(count, 0);
    f.tangential.assign(count, Vec3{});
    f.area.assign(count, 0);
    std::vector<double> size(count, 0);
    // Where nothing is close to any sheet of a node, all of them count: there its pressure is zero.
    std::vector<double> all_area(count, 0), all_size(count, 0);
    std::set<std::pair<Index, Index>> counted;
    for (const auto& [place, area] : area_) {
      all_area[at(place.first)] += area[0];
      all_size[at(place.first)] += area[1];
    }
    for (Index s = 0; s < pool.stencils(); ++s) {
      if (!pool.geometry().meets(s)) continue;
      const PatchPoint near = pool.geometry().nearest(s, c.state.x);
      if (!std::isfinite(near.distance)) continue;
      // Of the sheets that something is close to.
      for (std::size_t k = 0; k < points[at(s)].nodes; ++k) {
        const auto place = std::pair(points[at(s)].node[k], points[at(s)].sheet);
        if (!counted.insert(place).second) continue;
        f.area[at(place.first)] += area_.at(place)[0];
        size[at(place.first)] += area_.at(place)[1];
      }
      const double l = -lambda[at(s)];
      if (!(l > 0)) continue;
      const Vec3 pull = pool.kept_pull(SurfaceFrames{c.state.x, c.state.x}, s, memory);
      const auto nodes = pool.nodes()[s];
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double share = pool.geometry().share(s, i, near);
        f.normal[at(nodes[i])] += (i < points[at(s)].nodes ? l : -l) * share;
        f.tangential[at(nodes[i])] -= share * pull;
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (size[i] == 0) {
        f.area[i] = all_area[i];
        size[i] = all_size[i];
      }
      // Corners of faces with six nodes have no area of their own.
      if (!(f.area[i] > 0.2 * size[i])) f.area[i] = 0;
    }
    return true;
  }

 private:
  const SurfaceContactPool& pool_of(const GaugeContext& c) const {
    return static_cast<const SurfaceContactPool&>(*c.system.parts().stencil_pools[at(rows_->stencil_pool)]);
  }
  std::span<const double> memory_of(const GaugeContext& c) const {
    return c.system.stencil_memory(rows_->stencil_pool, std::span<const double>(c.state.extra));
  }

  std::shared_ptr<const ContactRows> rows_;
  Index row_pool_;
  std::shared_ptr<const ContactSurface> surface_;
  EdgeContact edges_;
  std::map<std::pair<Index, Index>, std::array<double, 2>>
      area_;  // by node and sheet at rest: the sum of shares, and that of their sizes [m^2]
};

class SurfaceContactEffect final : public EffectSource {
 public:
  explicit SurfaceContactEffect(SurfaceContactDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    const std::array<ContactNumber, 4> numbers{{{"thickness", def_.thickness, "m"},
                                                {"friction", def_.friction, ""},
                                                {"static_friction", def_.static_friction, ""},
                                                {"stick_stiffness", def_.stick_stiffness, "Pa/m"}}};
    if (auto r = check_numbers(who(), numbers); !r) return r;
    if (auto r = check_static_friction(who(), def_.friction, def_.static_friction); !r) return r;
    if (def_.compliance && !(*def_.compliance > 0 && std::isfinite(*def_.compliance))) {
      return Error{who() + "compliance = " + number(*def_.compliance) +
                   " m/Pa; it must be positive, or left out for a layer that is thin against the faces: "
                   "between two faceted surfaces a hard contact has no unique pressure"};
    }
    return check_resolve_time(who(), def_.resolve_time);
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    const std::string called = "surface contact \"" + def_.name + "\"";
    auto sides = both_sides(builder, called);
    if (!sides) return sides.failure();
    auto setup = std::make_shared<SurfaceContactPool::Setup>();
    setup->surface = std::make_shared<ContactSurface>(sides.value(), builder.rest());
    const ContactSurface& surface = *setup->surface;
    const ContactLayer layer = layer_of(builder, surface);
    std::vector<double> area;
    for (const SurfacePoint& p : surface.points()) area.push_back(p.area);
    const auto rows = pair_rows(builder, def_, def_.name, layer, area, surface.size(), *setup);
    const auto pool = first_pairs(builder, SurfaceContactPool(setup, std::vector<Index>(area.size(), -1)));
    if (auto r = find_overlap(builder, *pool, *rows); !r) return r.failure();
    rows->stencil_pool = builder.add_stencils(pool);
    const Index row_pool = builder.add_rows(rows);
    auto edges = EdgeContact::build(builder, def_, surface, layer);
    if (!edges) return edges.failure();
    return std::unique_ptr<EffectInstance>(
        std::make_unique<SurfaceContactInstance>(rows, row_pool, setup->surface, std::move(edges).value()));
  }

 private:
  std::string who() const { return "surface contact \"" + def_.name + "\": "; }

  ContactLayer layer_of(const Builder& builder, const ContactSurface& surface) const {
    const double softer =
        std::min(stiffest(builder.body(def_.body)), stiffest(builder.body(def_.against.value_or(def_.body))));
    if (def_.compliance) return {*def_.compliance, std::numeric_limits<double>::infinity(), softer};
    const DefaultLayer standard = surface.single() ? kWithinBody : kBetweenBodies;
    return {standard.thickness * surface.size() / softer, standard.knee * softer, softer};
  }
  // A thin body is touched from both sides.
  static SurfaceFaces faces_of(const Builder& builder, BodyId id, std::vector<Index> faces) {
    const BodyData& body = builder.body(id);
    SurfaceFaces side{std::move(faces), static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type))};
    if (!body.thin()) return side;
    side.lower = side.faces.size();
    for (std::size_t f = 0; f < side.lower; f += 3) {
      const Index turned[3] = {side.faces[f], side.faces[f + 2], side.faces[f + 1]};
      side.faces.insert(side.faces.end(), turned, turned + 3);
    }
    return side;
  }
  Result<std::array<SurfaceFaces, 2>> both_sides(const Builder& builder, const std::string& called) const {
    std::array<SurfaceFaces, 2> sides;
    auto first = outward_faces(builder, def_.body, def_.surfaces, called);
    if (!first) return first.failure();
    sides[0] = faces_of(builder, def_.body, std::move(first).value());
    if (!def_.against && builder.body(def_.body).thin()) {
      return Error{who() + "the thin body \"" + builder.body(def_.body).name +
                   "\" cannot touch itself: its two sides are in one place; name another body in `against`"};
    }
    if (!def_.against) {
      if (!def_.against_surfaces.empty())
        return Error{who() + "against_surfaces are named, but not the body in `against` that they belong to"};
      return sides;
    }
    auto second = outward_faces(builder, *def_.against, def_.against_surfaces, called);
    if (!second) return second.failure();
    sides[1] = faces_of(builder, *def_.against, std::move(second).value());
    std::vector<Index> shared = sides[0].faces, other = sides[1].faces, both;
    std::sort(shared.begin(), shared.end());
    std::sort(other.begin(), other.end());
    std::set_intersection(shared.begin(), shared.end(), other.begin(), other.end(), std::back_inserter(both));
    if (both.empty()) return sides;
    return Error{who() + "its two sides have node " +
                 std::to_string(both[0] - builder.body(def_.body).first_node) + " of body \"" +
                 builder.body(def_.body).name +
                 "\" in common; leave `against` out to have surfaces touch each other"};
  }

  Result<void> find_overlap(const Builder& builder, const SurfaceContactPool& pool, ContactRows& rows) const {
    const ContactSurface& surface = *pool.setup().surface;
    std::vector<double> gap(rows.area.size(), pool.setup().open);
    for (Index s = 0; s < pool.stencils(); ++s) {
      if (pool.geometry().meets(s))
        gap[at(s)] = pool.geometry().nearest(s, builder.rest()).distance - def_.thickness;
    }
    // In the groove between two flanks of one body facets are a little below each other.
    const Overlap found =
        take_overlap(gap, surface.single() ? 0.02 * surface.size() : 0, builder.length(), rows);
    if (found.worst < 0 || def_.initial_overlap == InitialOverlap::resolve) return {};
    const SurfacePoint& point = surface.points()[at(found.worst)];
    const BodyData& body = builder.body(point.side == 1 ? *def_.against : def_.body);
    return Error{who() + std::to_string(found.count) +
                 " points of the surfaces are closer than they may be at the start, the deepest by " +
                 number(-found.deepest) + " m at node " + std::to_string(point.node[0] - body.first_node) +
                 " of body \"" + body.name +
                 "\"; move one of the two, or set initial_overlap to resolve to have them pushed apart"};
  }

  SurfaceContactDef def_;
};

}  // namespace

EffectPtr surface_contact(SurfaceContactDef def) {
  return std::make_shared<SurfaceContactEffect>(std::move(def));
}

}  // namespace isochor
