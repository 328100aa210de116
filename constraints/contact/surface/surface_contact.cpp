#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "constraints/contact/contact_rows.h"
#include "constraints/contact/surface/edge_contact.h"
#include "constraints/contact/surface/surface_contact_pool.h"
#include "constraints/stencil/embedding.h"
#include "constraints/stencil/surface_nodes.h"
#include "engine/base/text.h"
#include "engine/scene/builder.h"
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
                         std::shared_ptr<const Skin> skin, EdgeContact edges)
      : rows_(std::move(rows)), row_pool_(row_pool), skin_(std::move(skin)), edges_(std::move(edges)) {
    for (const SkinPoint& p : skin_->points()) {
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
    const auto memory = memory_of(c, pool);
    const auto& points = pool.setup().skin->points();
    Vec3 force{};
    double normal = 0, tangential = 0, area = 0, gap = std::numeric_limits<double>::infinity();
    double depth = 0;
    for (Index s = 0; s < pool.stencils(); ++s) {
      if (!pool.close(s)) continue;
      const PatchPoint near = pool.nearest(s, c.state.x);
      if (!std::isfinite(near.distance)) continue;
      gap = std::min(gap, near.distance - pool.setup().offset);
      const double l = -lambda[at(s)];
      if (!(l > 0)) continue;
      const Vec3 pull = pool.kept_pull(s, memory, c.state.x);
      const double sign = points[at(s)].side == 0 ? 1 : -1;
      if (!pool.setup().skin->single()) force += sign * (l * near.normal - pull);
      normal += l;
      depth = std::max(depth, rows_->depth(s, -l) / skin_->size());
      tangential += std::sqrt(dot(pull, pull));
      area += 0.5 * rows_->area[at(s)];
    }
    const EdgeContact::Totals edges = edges_.totals(c);
    if (!pool.setup().skin->single()) force += edges.force;
    normal += edges.normal;
    tangential += edges.tangential;
    gap = std::min(gap, edges.gap);
    SurfaceForces at_nodes;
    surface_forces(c, at_nodes);
    double pressure = 0;
    for (std::size_t i = 0; i < at_nodes.area.size(); ++i) {
      if (at_nodes.area[i] > 0) pressure = std::max(pressure, at_nodes.normal[i] / at_nodes.area[i]);
    }
    const std::string name(rows_->name());
    const auto put = [&](const char* quantity, const char* unit, double value) {
      out.push_back({name, "contact", quantity, unit, value});
    };
    put("force_x", "N", force.x);
    put("force_y", "N", force.y);
    put("force_z", "N", force.z);
    put("normal_force", "N", normal);
    put("friction_force", "N", tangential);
    put("contact_area", "m2", area);
    put("largest_pressure", "Pa", pressure);
    put("smallest_gap", "m", gap);
    put("depth_over_face", "", depth);
  }

  bool surface_forces(const GaugeContext& c, SurfaceForces& f) const override {
    const auto& pool = pool_of(c);
    const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
    const auto memory = memory_of(c, pool);
    const auto& points = pool.setup().skin->points();
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
      if (!pool.close(s)) continue;
      const PatchPoint near = pool.nearest(s, c.state.x);
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
      const Vec3 pull = pool.kept_pull(s, memory, c.state.x);
      const auto nodes = pool.nodes()[s];
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double share = pool.share(s, i, near);
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
  std::span<const double> memory_of(const GaugeContext& c, const SurfaceContactPool& pool) const {
    return std::span<const double>(c.state.extra)
        .subspan(at(c.system.first_stencil_memory(rows_->stencil_pool)),
                 static_cast<std::size_t>(pool.memory()));
  }

  std::shared_ptr<const ContactRows> rows_;
  Index row_pool_;
  std::shared_ptr<const Skin> skin_;
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
    for (const auto& [key, value, unit] : {std::tuple{"thickness", def_.thickness, " m"},
                                           {"friction", def_.friction, ""},
                                           {"static_friction", def_.static_friction, ""},
                                           {"stick_stiffness", def_.stick_stiffness, " Pa/m"}}) {
      if (value >= 0 && std::isfinite(value)) continue;
      return Error{who() + key + " = " + number(value) + unit + "; it must be zero or positive"};
    }
    if (def_.static_friction > 0 && def_.static_friction < def_.friction) {
      return Error{who() + "static_friction = " + number(def_.static_friction) + " with friction = " +
                   number(def_.friction) + "; it must not be the smaller one, or 0 for the same"};
    }
    if (def_.compliance && !(*def_.compliance > 0 && std::isfinite(*def_.compliance))) {
      return Error{who() + "compliance = " + number(*def_.compliance) +
                   " m/Pa; it must be positive, or left out for a layer that is thin against the faces: "
                   "between two faceted surfaces a hard contact has no unique pressure"};
    }
    if (!(def_.resolve_time > 0)) {
      return Error{who() + "resolve_time = " + number(def_.resolve_time) + " s; it must be positive"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    const std::string called = "surface contact \"" + def_.name + "\"";
    auto sides = both_sides(builder, called);
    if (!sides) return Error{sides.error()};
    auto setup = std::make_shared<SurfaceContactPool::Setup>();
    setup->name = def_.name;
    setup->skin = std::make_shared<Skin>(sides.value(), builder.rest());
    setup->offset = def_.thickness;
    setup->friction = {def_.friction, def_.static_friction};
    setup->coupled = def_.coupling == FrictionCoupling::coupled;
    setup->open = builder.length();
    const std::array<double, 2> mu{stiffest(builder.body(def_.body)),
                                   stiffest(builder.body(def_.against.value_or(def_.body)))};
    const double softer = std::min(mu[0], mu[1]);
    auto rows = std::make_shared<ContactRows>(def_.name, def_.resolve_time);
    const DefaultLayer standard = setup->skin->single() ? kWithinBody : kBetweenBodies;
    const double layer = def_.compliance.value_or(standard.thickness * setup->skin->size() / softer);
    const double knee = def_.compliance ? std::numeric_limits<double>::infinity() : standard.knee * softer;
    for (const SkinPoint& p : setup->skin->points()) {
      // Both sides carry half of the pressure.
      rows->add(softer, p.area, builder.length(), 2 * layer);
      if (std::isfinite(knee)) rows->knee.push_back(0.5 * p.area * knee);
      setup->stick.push_back(def_.stick_stiffness > 0 ? 0.5 * def_.stick_stiffness * p.area
                                                      : 50 * softer * p.area / setup->skin->size());
    }
    std::shared_ptr<const StencilPool> pool =
        std::make_shared<SurfaceContactPool>(setup, std::vector<Index>(setup->skin->points().size(), -1));
    const std::vector<double> nothing(static_cast<std::size_t>(pool->memory()), 0);
    const FollowAnswer start = pool->followed({nothing, builder.rest(), builder.rest(), false, nullptr});
    if (start.pool) pool = start.pool;
    if (auto r = find_overlap(builder, static_cast<const SurfaceContactPool&>(*pool), *rows); !r)
      return Error{r.error()};
    rows->largest_overshoot = 0.25 * setup->skin->size();
    rows->stencil_pool = builder.add_stencils(pool);
    const Index row_pool = builder.add_rows(rows);
    auto edges = EdgeContact::build(builder, def_, *setup->skin, {layer, knee, softer});
    if (!edges) return Error{edges.error()};
    return std::unique_ptr<EffectInstance>(
        std::make_unique<SurfaceContactInstance>(rows, row_pool, setup->skin, std::move(edges).value()));
  }

 private:
  std::string who() const { return "surface contact \"" + def_.name + "\": "; }

  static std::size_t nodes_of_faces(const Builder& builder, BodyId body) {
    return static_cast<std::size_t>(nodes_per_face(builder.body(body).mesh.cell_type));
  }
  Result<std::array<SkinFaces, 2>> both_sides(const Builder& builder, const std::string& called) const {
    std::array<SkinFaces, 2> sides;
    auto first = outward_faces(builder, def_.body, def_.surfaces, called);
    if (!first) return Error{first.error()};
    sides[0] = {std::move(first).value(), nodes_of_faces(builder, def_.body)};
    if (!def_.against) {
      if (!def_.against_surfaces.empty())
        return Error{who() + "against_surfaces are named, but not the body in `against` that they belong to"};
      return sides;
    }
    auto second = outward_faces(builder, *def_.against, def_.against_surfaces, called);
    if (!second) return Error{second.error()};
    sides[1] = {std::move(second).value(), nodes_of_faces(builder, *def_.against)};
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
    Index worst = -1, inside = 0;
    double deepest = -1e-9 * builder.length();
    std::vector<double> overlap(rows.area.size(), 0.0), allowed = overlap;
    // In the groove between two flanks of one body facets are a little below each other.
    const double groove = pool.setup().skin->single() ? 0.02 * pool.setup().skin->size() : 0;
    bool grooved = false;
    for (Index s = 0; s < pool.stencils(); ++s) {
      if (!pool.close(s)) continue;
      const double gap = pool.nearest(s, builder.rest()).distance - def_.thickness;
      if (!std::isfinite(gap)) continue;
      if (gap < 0 && gap >= -groove) {
        allowed[at(s)] = gap;
        grooved = true;
        continue;
      }
      overlap[at(s)] = std::min(gap, 0.0);
      if (gap < -1e-9 * builder.length()) ++inside;
      if (gap >= deepest) continue;
      deepest = gap;
      worst = s;
    }
    if (grooved) rows.allowed = std::move(allowed);
    if (worst < 0) return {};
    if (def_.initial_overlap == InitialOverlap::resolve) {
      rows.overlap = std::move(overlap);
      return {};
    }
    const SkinPoint& point = pool.setup().skin->points()[at(worst)];
    const BodyData& body = builder.body(point.side == 1 ? *def_.against : def_.body);
    return Error{who() + std::to_string(inside) +
                 " points of the surfaces are closer than they may be at the start, the deepest by " +
                 number(-deepest) + " m at node " + std::to_string(point.node[0] - body.first_node) +
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
