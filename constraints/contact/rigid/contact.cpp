
#include "isochor/effects/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/contact/contact_effect.h"
#include "constraints/contact/rigid/bouncing_rows.h"
#include "constraints/contact/rigid/contact_pool.h"
#include "constraints/contact/rigid/flush_nodes.h"
#include "constraints/contact/rigid/rigid_body.h"
#include "constraints/stencil/surface_nodes.h"
#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "engine/scene/embedding.h"

namespace isochor {

namespace {

class ContactInstance final : public EffectInstance {
 public:
  ContactInstance(std::shared_ptr<const ContactPool> pool, std::shared_ptr<const ContactRows> rows,
                  Index row_pool, std::shared_ptr<LivePose> pose, std::string touching, std::string partner)
      : pool_(std::move(pool)),
        rows_(std::move(rows)),
        row_pool_(row_pool),
        pose_(std::move(pose)),
        touching_(std::move(touching)),
        partner_(std::move(partner)) {}

  LivePose* pose() override { return pose_.get(); }

  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    const ContactFrame frame = pool_->geometry().frame(c.state.t, c.state.x);
    const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
    const bool rubs = pool_->memory() > 0;
    const auto memory = memory_of(c);
    ContactTotals sum;
    for (Index s = 0; s < pool_->stencils(); ++s) {
      sum.gap = std::min(sum.gap, pool_->geometry().gap(s, frame, c.state.x));
      if (!(lambda[at(s)] < 0)) continue;
      const double area = rows_->area[at(s)];
      sum.normal -= lambda[at(s)];
      sum.area += area;
      sum.depth = std::max(sum.depth, rows_->depth(s, lambda[at(s)]) / std::sqrt(area));
      sum.pressure = std::max(sum.pressure, -lambda[at(s)] / area);
      const Distance d =
          distance_to(pool_->geometry().shape(), pool_->geometry().own_place(s, frame, c.state.x));
      sum.force -= lambda[at(s)] * transposed_times(frame.inverse, d.normal);
      if (!rubs) continue;
      const Vec3 f = pool_->kept_pull(s, memory);
      sum.tangential += std::sqrt(dot(f, f));
      sum.force -= frame.A * f;
    }
    add_gauges(rows_->name(), sum, out);
  }

  void pressing_points(const GaugeContext& c, std::vector<PressingPoint>& out) const override {
    const RigidGeometry& geometry = pool_->geometry();
    const ContactFrame frame = geometry.frame(c.state.t, c.state.x);
    const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
    const auto memory = memory_of(c);
    for (Index s = 0; s < pool_->stencils(); ++s) {
      if (!(lambda[at(s)] < 0)) continue;
      PressingPoint p;
      if (!geometry[s].rider) p.node = p.of = pool_->nodes()[s][0];
      p.name = touching_;
      p.partner = partner_;
      p.position = geometry.position(s, c.state.x);
      p.gap = geometry.gap(s, frame, c.state.x);
      const Distance d = distance_to(geometry.shape(), geometry.own_place(s, frame, c.state.x));
      const Vec3 slope = transposed_times(frame.inverse, d.normal);
      p.normal = direction(slope);
      p.force = -lambda[at(s)] * norm(slope);
      if (pool_->memory() > 0) p.friction = -1.0 * (frame.A * pool_->kept_pull(s, memory));
      p.area = rows_->area[at(s)];
      out.push_back(std::move(p));
    }
  }

  bool surface_forces(const GaugeContext& c, SurfaceForces& f) const override {
    const std::size_t nodes = c.state.x.size();
    f.normal.assign(nodes, 0);
    f.tangential.assign(nodes, Vec3{});
    f.area.assign(nodes, 0);
    const ContactFrame frame = pool_->geometry().frame(c.state.t, c.state.x);
    const auto lambda = std::span(c.state.lambda).subspan(at(c.system.first_row(row_pool_)));
    const auto memory = memory_of(c);
    for (Index s = 0; s < pool_->stencils(); ++s) {
      if (pool_->geometry()[s].rider) continue;  // a point of a rigid body is no node of a surface
      const std::size_t node = at(pool_->nodes()[s][0]);
      f.area[node] = rows_->area[at(s)];
      if (!(lambda[at(s)] < 0)) continue;
      f.normal[node] = -lambda[at(s)];
      f.tangential[node] = -1.0 * (frame.A * pool_->kept_pull(s, memory));
    }
    return true;
  }

 private:
  std::span<const double> memory_of(const GaugeContext& c) const {
    return c.system.stencil_memory(rows_->stencil_pool, std::span<const double>(c.state.extra));
  }

  std::shared_ptr<const ContactPool> pool_;
  std::shared_ptr<const ContactRows> rows_;
  Index row_pool_;
  std::shared_ptr<LivePose> pose_;  // null: a free rigid body
  std::string touching_, partner_;  // names of rigid bodies; the partner may be the obstacle of the contact
};

class ContactEffect final : public EffectSource {
 public:
  explicit ContactEffect(ContactDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (auto r = check_obstacle(def_.obstacle); !r) return Error{who() + r.error()};
    const std::array<ContactNumber, 4> numbers{{{"compliance", def_.compliance, "m/Pa"},
                                                {"friction", def_.friction, ""},
                                                {"static_friction", def_.static_friction, ""},
                                                {"stick_stiffness", def_.stick_stiffness, "Pa/m"}}};
    if (auto r = check_numbers(who(), numbers); !r) return r;
    if (auto r = check_static_friction(who(), def_.friction, def_.static_friction); !r) return r;
    if (!(def_.restitution >= 0 && def_.restitution <= 1)) {
      return Error{who() + "restitution = " + number(def_.restitution) +
                   "; it must be between 0 and 1, what more would add energy in every impact"};
    }
    if (!(def_.restitution_speed >= 0 && std::isfinite(def_.restitution_speed))) {
      return Error{who() + "restitution_speed = " + number(def_.restitution_speed) +
                   " m/s; it must be zero or positive"};
    }
    if (def_.restitution > 0 && def_.compliance > 0) {
      return Error{who() + "restitution = " + number(def_.restitution) +
                   " with compliance = " + number(def_.compliance) +
                   " m/Pa; a soft layer bounces by its own elasticity: leave one of them 0"};
    }
    return check_resolve_time(who(), def_.resolve_time);
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    const std::string called = "contact \"" + def_.name + "\"";
    std::optional<ControlPoints> points;
    Obstacle shape = def_.obstacle;
    if (!def_.against.empty()) {
      auto rigid = find_rigid(builder, def_.against, called);
      if (!rigid) return rigid.failure();
      points = rigid.value().points;
      shape = rigid.value().shape;
    }
    std::shared_ptr<LivePose> pose;  // of an obstacle
    if (!points) pose = std::make_shared<LivePose>(shape.motion);
    RigidGeometry geometry(shape, points, pose);
    auto touching = def_.rigid.empty() ? add_nodes(builder, geometry, called)
                                       : add_touch_points(builder, geometry, called);
    if (!touching) return touching.failure();
    const auto pool = std::make_shared<ContactPool>(def_.name, std::move(geometry),
                                                    FrictionLaw(def_.friction, def_.static_friction),
                                                    def_.coupling == FrictionCoupling::coupled);
    auto rows = def_.restitution > 0
                    ? std::make_shared<BouncingRows>(def_.name, def_.resolve_time, pool, def_.restitution,
                                                     def_.restitution_speed)
                    : std::make_shared<ContactRows>(def_.name, def_.resolve_time);
    for (const double area : touching.value().area)
      rows->add(touching.value().modulus, area, builder.length(), def_.compliance);
    if (auto r = find_overlap(builder, *pool, *rows); !r) return r.failure();
    rows->stencil_pool = builder.add_stencils(pool);
    const Index row_pool = builder.add_rows(rows);
    return std::unique_ptr<EffectInstance>(
        std::make_unique<ContactInstance>(pool, rows, row_pool, pose, def_.rigid,
                                          def_.against.empty() ? "obstacle of " + def_.name : def_.against));
  }

 private:
  std::string who() const { return "contact \"" + def_.name + "\": "; }

  // The areas that points stand for [m^2], and the shear modulus that their pressures are compared with [Pa].
  struct Touching {
    std::vector<double> area;
    double modulus = 0;
  };

  double stick(double mu, double area) const {
    return def_.stick_stiffness > 0 ? def_.stick_stiffness * area : 100 * mu * std::sqrt(area);
  }

  Result<Touching> add_nodes(const Builder& builder, RigidGeometry& geometry,
                             const std::string& called) const {
    auto faces = surface_faces(builder, def_.body, def_.surfaces, called);
    if (!faces) return faces.failure();
    const BodyData& body = builder.body(def_.body);
    const double mu = stiffest(body);
    const auto per = static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type));
    const std::vector<NodeCells> cells = cells_around(body, builder.rest());
    const std::vector<FlatSide> sides =
        geometry.shape_points() ? std::vector<FlatSide>() : flat_sides(def_.obstacle);
    const ContactFrame frame = geometry.frame(0, builder.rest());
    Touching out{{}, mu};
    for (const auto& [node, area] : surface_nodes(faces.value(), per, builder.rest())) {
      if (builder.given_directions(node) == 3) continue;  // goes where it is told to
      const NodeCells& around = cells[at(node - body.first_node)];
      geometry.add(node, stick(mu, area), around.size,
                   inset_of_flush(def_.obstacle, sides, frame.to_own(builder.rest()[at(node)]),
                                  transposed_times(frame.A, around.inward), around.size));
      out.area.push_back(area);
    }
    if (!out.area.empty()) return out;
    return Error{who() + "all nodes of its surfaces are held by supports; take surfaces that can move"};
  }

  Result<Touching> add_touch_points(Builder& builder, RigidGeometry& geometry,
                                    const std::string& called) const {
    if (def_.rigid == def_.against) return Error{who() + "a rigid body does not touch itself"};
    auto rigid = find_rigid(builder, def_.rigid, called);
    if (!rigid) return rigid.failure();
    double mu = 0;
    for (Index b = 0; b < builder.body_count(); ++b)
      mu = std::max(mu, stiffest(builder.body(static_cast<BodyId>(b))));
    const double extent = smallest_extent(rigid.value().shape);
    const auto touches = touch_points(rigid.value().shape);
    const double area = extent * extent / static_cast<double>(touches.size());
    Touching out{{}, mu};
    for (const TouchPoint& t : touches) {
      geometry.add(rigid.value().points, t.own, t.offset, stick(mu, area));
      out.area.push_back(area);
    }
    return out;
  }

  Result<void> find_overlap(const Builder& builder, const ContactPool& pool, ContactRows& rows) const {
    const ContactFrame frame = pool.geometry().frame(0, builder.rest());
    std::vector<double> gap(rows.area.size());
    for (Index s = 0; s < pool.stencils(); ++s) gap[at(s)] = pool.geometry().gap(s, frame, builder.rest());
    const Overlap found = take_overlap(gap, 0, builder.length(), rows);
    if (found.worst < 0 || def_.initial_overlap == InitialOverlap::resolve) return {};
    const Index worst = pool.nodes()[found.worst][0];
    const std::string what = def_.rigid.empty()
                                 ? " nodes of body \"" + builder.body(def_.body).name +
                                       "\" are inside the obstacle at the start, node " +
                                       std::to_string(worst - builder.body(def_.body).first_node)
                                 : " points of rigid body \"" + def_.rigid +
                                       "\" are inside the obstacle at the start, the deepest";
    return Error{who() + std::to_string(found.count) + what + " by " + number(-found.deepest) +
                 " m; move one of the two, or set initial_overlap to resolve to have them pushed out"};
  }

  ContactDef def_;
};

}  // namespace

EffectPtr contact(ContactDef def) {
  return std::make_shared<ContactEffect>(std::move(def));
}

}  // namespace isochor
