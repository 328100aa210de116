#include <cmath>

#include "constraints/stencil/point_pool.h"
#include "engine/base/text.h"
#include "isochor/effects/support.h"

namespace isochor {

namespace {

// amount * displacement, and a rotation by amount * angle about an axis (Rodrigues).
class RigidMotion final : public Motion {
 public:
  RigidMotion(const DirichletDef& def, std::shared_ptr<Amount> amount)
      : displacement_(def.displacement),
        point_(def.axis_point),
        axis_(def.angle != 0 ? (1 / norm(def.axis)) * def.axis : Vec3{}),
        angle_(def.angle),
        amount_(std::move(amount)) {}

  Vec3 displacement(double t, const Vec3& rest) const override {
    const double a = amount_->value(t);
    Vec3 u = a * displacement_;
    if (angle_ != 0) {
      const Vec3 r = rest - point_;
      const double s = std::sin(a * angle_), half = std::sin(0.5 * a * angle_);
      const Vec3 k = cross(axis_, r);
      u += s * k + (2 * half * half) * cross(axis_, k);
    }
    return u;
  }
  bool never_moves() const override { return angle_ == 0 && norm(displacement_) == 0; }
  double turn(double t0, double t1) const override {
    return angle_ == 0 ? 0 : std::abs(angle_ * (amount_->value(t1) - amount_->value(t0)));
  }

 private:
  Vec3 displacement_, point_, axis_;
  double angle_;
  std::shared_ptr<Amount> amount_;
};

// What the definition says until a host sets a pose, which then counts alone.
class LiveMotion final : public Motion {
 public:
  LiveMotion(std::shared_ptr<const Motion> said, std::shared_ptr<const LivePose> pose)
      : said_(std::move(said)), pose_(std::move(pose)) {}
  Vec3 displacement(double t, const Vec3& rest) const override {
    if (said_ && !pose_->held()) return said_->displacement(t, rest);
    return carried(pose_->track(), t, rest) - rest;
  }
  bool never_moves() const override {
    if (pose_->set_by_host()) return false;
    return said_ ? said_->never_moves() : pose_->track().keys.size() < 2;
  }
  double turn(double t0, double t1) const override {
    return said_ && !pose_->held() ? said_->turn(t0, t1) : turned(pose_->track(), t0, t1);
  }

 private:
  std::shared_ptr<const Motion> said_;  // null: the track of the pose
  std::shared_ptr<const LivePose> pose_;
};

// Rows of held points: d . (x - X) = d . u(t, X), by multipliers or by springs.
class HeldRows final : public RowPool, public TurningRows {
 public:
  HeldRows(std::string name, std::shared_ptr<const Motion> motion)
      : name_(std::move(name)), motion_(std::move(motion)) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override {
    for (std::size_t r = 0; r < value.size(); ++r) {
      value[r] = dot(direction[r], motion_->displacement(t, point[r]));
    }
  }
  RowFacets facets() const override { return {.turning = this}; }
  double turn(double t0, double t1) const override { return motion_->turn(t0, t1); }
  std::vector<Vec3> direction, point;  // of each row; rest positions [m]
  std::vector<PointInBody> where;      // of each row

 private:
  std::string name_;
  std::shared_ptr<const Motion> motion_;
};

class DirichletInstance final : public EffectInstance {
 public:
  DirichletInstance(std::shared_ptr<Amount> amount, std::shared_ptr<LivePose> pose)
      : amount_(std::move(amount)), pose_(std::move(pose)) {}
  Amount* amount() override { return amount_.get(); }
  LivePose* pose() override { return pose_.get(); }
  std::array<Vec3, 2> reaction(const GaugeContext& c) const override {
    std::array<Vec3, 2> sum{};
    if (!rows) return sum;
    const std::size_t first = at(c.system.first_row(row_pool));
    for (std::size_t r = 0; r < rows->direction.size(); ++r) {
      const Vec3 force = -c.state.lambda[first + r] * rows->direction[r];
      sum[0] += force;
      sum[1] += cross(rows->where[r].at(c.state.x), force);
    }
    return sum;
  }
  // Supports by rows report their force as a gauge, too.
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    if (!rows) return;
    const Vec3 force = reaction(c)[0];
    for (int k = 0; k < 3; ++k) {
      out.push_back(
          {std::string(rows->name()), "dirichlet", std::string("force_") + "xyz"[k], "N", force[k]});
    }
  }
  std::shared_ptr<const HeldRows> rows;
  Index row_pool = -1;

 private:
  std::shared_ptr<Amount> amount_;
  std::shared_ptr<LivePose> pose_;
};

class DirichletEffect final : public EffectSource {
 public:
  explicit DirichletEffect(DirichletDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    for (const Vec3& d : def_.directions) {
      if (!(norm(d) > 0) || !std::isfinite(norm(d))) {
        return Error{who() + "a direction has no length; give vectors such as (0, 1, 0)"};
      }
    }
    if (!std::isfinite(norm(def_.displacement)) || !std::isfinite(def_.angle) ||
        !std::isfinite(norm(def_.axis_point))) {
      return Error{who() + "displacement, angle and axis must be finite numbers"};
    }
    if (def_.angle != 0 && !(norm(def_.axis) > 0)) {
      return Error{who() + "angle is given without an axis; give axis = (0, 0, 1) or another direction"};
    }
    return check_treatment();
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    std::vector<Index> list;
    if (def_.points.empty() || !selects_nothing()) {
      auto nodes = builder.select(def_.where, def_.name);
      if (!nodes) return nodes.failure();
      list = std::move(nodes).value();
    }
    auto amount = std::make_shared<Amount>(def_.amount);
    auto pose = std::make_shared<LivePose>(def_.bone);
    std::shared_ptr<const Motion> said;
    if (!has_bone()) said = std::make_shared<RigidMotion>(def_, amount);
    const std::shared_ptr<const Motion> motion = std::make_shared<LiveMotion>(said, pose);
    std::vector<Vec3> directions = def_.directions;
    if (directions.empty()) directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    auto instance = std::make_unique<DirichletInstance>(has_bone() ? nullptr : amount, pose);
    if (def_.treatment != SupportTreatment::eliminated) {
      if (auto r = add_rows(builder, list, directions, motion, *instance); !r) return r.failure();
      return std::unique_ptr<EffectInstance>(std::move(instance));
    }
    for (const Index node : list) {
      for (const Vec3& d : directions) {
        if (auto r = builder.prescribe(node, (1 / norm(d)) * d, motion, def_.name); !r) return r.failure();
      }
    }
    return std::unique_ptr<EffectInstance>(std::move(instance));
  }

 private:
  std::string who() const { return "dirichlet \"" + def_.name + "\": "; }
  bool has_bone() const { return !def_.bone.keys.empty(); }
  bool selects_nothing() const {
    const Selection& s = def_.where;
    return s.surfaces.empty() && s.regions.empty() && s.node_sets.empty() && s.nodes.empty() &&
           s.boxes.empty() && s.nearest.empty() && !s.everything;
  }

  Result<void> check_treatment() const {
    if (has_bone()) {
      if (auto r = check_poses(def_.bone); !r) return Error{who() + "bone: " + r.error()};
      if (def_.angle != 0 || norm(def_.displacement) != 0) {
        return Error{who() + "a bone and a displacement or rotation are given; keep one of them"};
      }
    }
    const bool springs = def_.treatment == SupportTreatment::stiffness;
    if (springs != (def_.stiffness != 0) || !(def_.stiffness >= 0) || !std::isfinite(def_.stiffness)) {
      return Error{who() + "stiffness = " + number(def_.stiffness) + " N/m with " +
                   (springs ? "treatment \"stiffness\"; give a positive number"
                            : "an exact treatment; leave it out, or take treatment \"stiffness\"")};
    }
    if (def_.treatment == SupportTreatment::eliminated && !def_.points.empty()) {
      return Error{who() +
                   "points inside elements cannot be eliminated; take treatment \"multiplier\" or "
                   "\"stiffness\", or select nodes"};
    }
    return {};
  }

  // Orthonormal directions that span what was asked; the other columns of the frame are not used.
  static PointPool::Frame frame_of(const std::vector<Vec3>& directions, int& count) {
    PointPool::Frame frame = PointPool::kAxes;
    count = 0;
    for (const Vec3& asked : directions) {
      Vec3 d = (1 / norm(asked)) * asked;
      for (int k = 0; k < count; ++k)
        d -= dot(d, frame[static_cast<std::size_t>(k)]) * frame[static_cast<std::size_t>(k)];
      if (count < 3 && norm(d) > 1e-6) frame[static_cast<std::size_t>(count++)] = (1 / norm(d)) * d;
    }
    return frame;
  }

  Result<void> add_rows(Builder& builder, const std::vector<Index>& nodes,
                        const std::vector<Vec3>& directions, const std::shared_ptr<const Motion>& motion,
                        DirichletInstance& instance) const {
    if (!builder.has_body(def_.where.body)) return Error{who() + builder.no_body(def_.where.body)};
    const BodyData& body = builder.body(def_.where.body);
    std::vector<PointInBody> points;
    for (const Index node : nodes) {
      const bool hard = def_.treatment == SupportTreatment::multiplier;
      if (hard && builder.given_directions(node) > 0) {
        return Error{
            who() + "node " + std::to_string(node - body.first_node) +
            " is held by an eliminated support already, a multiplier on top has nothing to move; take it "
            "out of one of the two, or use treatment \"stiffness\""};
      }
      points.push_back({{node}, {1.0}});
    }
    for (const Vec3& X : def_.points) {
      auto point = embed(body, builder.rest(), X, "dirichlet \"" + def_.name + "\"");
      if (!point) return point.failure();
      points.push_back(std::move(point).value());
    }
    int count = 0;
    const PointPool::Frame frame = frame_of(directions, count);
    auto pool = std::make_shared<PointPool>(def_.name, true);
    auto rows = std::make_shared<HeldRows>(def_.name, motion);
    const double length = builder.length();
    const double compliance = def_.stiffness > 0 ? static_cast<double>(points.size()) / def_.stiffness : 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      pool->add(points[p], frame);
      for (int k = 0; k < count; ++k) {
        add_point_row(*rows, static_cast<Index>(p), k, compliance, 1 / (stiffest(body) * length), length);
        rows->direction.push_back(frame[static_cast<std::size_t>(k)]);
        rows->point.push_back(points[p].at(builder.rest()));
        rows->where.push_back(points[p]);
      }
    }
    // Springs are condensed by default: their stiffness goes into the matrix, no unknowns are added.
    pool->finish();
    rows->stencil_pool = builder.add_stencils(pool);
    instance.rows = rows;
    instance.row_pool = builder.add_rows(rows);
    return {};
  }

  DirichletDef def_;
};

}  // namespace

EffectPtr dirichlet(DirichletDef def) {
  return std::make_shared<DirichletEffect>(std::move(def));
}

}  // namespace isochor
