#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "constraints/stencil/amount_row.h"
#include "constraints/stencil/mesh_field.h"
#include "engine/base/text.h"
#include "isochor/effects/active.h"

namespace isochor {

namespace {

// w of unit tension, and its derivatives in the stretch.
struct Pull {
  double value, first, second;
};

struct PullLaw {
  MuscleTension tension = MuscleTension::nominal;
  double best = 1, width = 0;

  // The integral of f, or f/s, from 1 to s > 0.
  Pull operator()(double s) const {
    const bool current = tension == MuscleTension::current;
    if (width == 0) return current ? Pull{std::log(s), 1 / s, -1 / (s * s)} : Pull{s - 1, 1, 0};
    const double d = (s - best) / width;
    // Outside of its range the pull is over and the energy is that of the end.
    const double low = best - width, high = best + width;
    const auto within = [&](double v) { return std::min(std::max(v, low), high); };
    const double value = primitive(within(s)) - primitive(within(1));
    if (!(std::abs(d) < 1)) return {value, 0, 0};
    const double f = 1 - d * d, slope = -2 * d / width;
    if (!current) return {value, f, slope};
    return {value, f / s, (slope - f / s) / s};
  }

 private:
  double primitive(double s) const {
    const double d = (s - best) / width;
    if (tension == MuscleTension::nominal) return s - width * d * d * d / 3;
    // f/s = (1 - b^2/w^2)/s + 2 b/w^2 - s/w^2; below zero stretch there is none.
    if (!(s > 0)) s = std::numeric_limits<double>::min();
    const double w2 = width * width;
    const double logarithm = 1 - best * best / w2;
    return (logarithm == 0 ? 0 : logarithm * std::log(s)) + 2 * best * s / w2 - 0.5 * s * s / w2;
  }
};

// One function a stencil of the energy: the integral of w over it [m^3], whose multiplier is the tension. F
// acts on fibers alone, F a = a + sum_a u_a (B_a . a).
class MusclePool final : public StencilPool {
 public:
  // `axis`: unit vectors, one a stencil.
  MusclePool(std::string name, const SolidPool& solid, const std::vector<Vec3>& axis, const PullLaw& law)
      : name_(std::move(name)), points_(solid.data().points), law_(law), axis_(axis) {
    const SolidData& data = solid.data();
    nodes_ = solid.nodes();
    weight_ = data.weight;
    along_.reserve(data.gradient.size());
    for (Index s = 0; s < nodes_.count(); ++s) {
      const std::size_t first = at(points_) * at(nodes_.offset[at(s)]);
      for (std::size_t k = 0; k < at(points_) * nodes_[s].size(); ++k)
        along_.push_back(dot(data.gradient[first + k], axis[at(s)]));
    }
    finish_topology();
  }
  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.functions = 1}; }

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override {
    for (Index s = request.begin; s < request.end; ++s) {
      const std::size_t n = nodes_[s].size(), first = at(nodes_.offset[at(s)]);
      slots.energy[at(s)] = 0;
      slots.value[at(s)] = 0;
      if (request.want != Want::value) {
        std::fill_n(slots.gradient.data() + first, n, Vec3{});
        std::fill_n(slots.jacobian.data() + first, n, Vec3{});
      }
      if (request.want == Want::hessian)
        std::fill_n(slots.hessian.data() + hessian_offset()[at(s)], n * (n + 1) / 2, Mat3{});
      for (int q = 0; q < points_; ++q) add_point(request, slots, s, q);
    }
  }

 private:
  void add_point(const StencilRequest& request, const StencilSlots& slots, Index s, int q) const {
    const auto nodes = nodes_[s];
    const std::size_t n = nodes.size(), first = at(nodes_.offset[at(s)]);
    const double* along = along_.data() + at(points_) * first + at(q) * n;
    const double w = weight_[at(s * points_ + q)];
    Vec3 f = axis_[at(s)];
    const Vec3 u0 = request.x[at(nodes[0])] - request.rest[at(nodes[0])];
    for (std::size_t a = 1; a < n; ++a)
      f += along[a] * (request.x[at(nodes[a])] - request.rest[at(nodes[a])] - u0);
    const double stretch = norm(f);
    // Fibers without length have no direction: the line search stays away.
    if (!(stretch > 0)) {
      slots.energy[at(s)] = std::numeric_limits<double>::infinity();
      return;
    }
    const Pull pull = law_(stretch);
    slots.value[at(s)] += w * pull.value;
    if (request.want == Want::value) return;
    const double tension = request.function_multiplier[at(s)];
    const Vec3 d = (1 / stretch) * f;
    for (std::size_t a = 0; a < n; ++a) {
      const Vec3 j = (w * pull.first * along[a]) * d;
      slots.jacobian[first + a] += j;
      slots.gradient[first + a] += tension * j;
    }
    if (request.want != Want::hessian) return;
    // The eigenvalues in F a: across the fiber twice, and along it.
    double across = tension * pull.first / stretch, lengthwise = tension * pull.second;
    if (request.definiteness == Definiteness::projected)
      across = std::max(across, 0.0), lengthwise = std::max(lengthwise, 0.0);
    else if (request.definiteness == Definiteness::absolute)
      across = std::abs(across), lengthwise = std::abs(lengthwise);
    Mat3 M;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) M(i, j) = w * ((i == j ? across : 0) + (lengthwise - across) * d[i] * d[j]);
    }
    Mat3* blocks = slots.hessian.data() + hessian_offset()[at(s)];
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const double c = along[a] * along[b];
        Mat3& block = blocks[a * (a + 1) / 2 + b];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) block(i, j) += c * M(i, j);
        }
      }
    }
  }

  std::string name_;
  int points_;
  PullLaw law_;
  std::vector<Vec3> axis_;
  std::vector<double> weight_, along_;  // B_a . a, as SolidData::gradient
};

class MuscleInstance final : public EffectInstance {
 public:
  MuscleInstance(std::string name, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    out.push_back({name_, "muscle", "active_stress", "Pa", amount_->value(c.state.t)});
  }

 private:
  std::string name_;
  std::shared_ptr<Amount> amount_;
};

class MuscleEffect final : public EffectSource {
 public:
  explicit MuscleEffect(MuscleDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (!def_.directions.empty() && !def_.field.empty())
      return Error{who() + "directions and a field are given; give one of them"};
    if (def_.directions.empty() && def_.field.empty()) {
      if (auto r = check_direction("direction", def_.direction); !r) return r;
    }
    for (std::size_t c = 0; c < def_.directions.size(); ++c) {
      if (auto r = check_direction("directions[" + std::to_string(c) + "]", def_.directions[c]); !r) return r;
    }
    if (!(def_.width >= 0) || !std::isfinite(def_.width)) {
      return Error{who() + "width = " + number(def_.width) +
                   "; it must be positive, or 0 for a muscle that pulls alike at any length"};
    }
    if (!(def_.optimal_stretch > 0) || !std::isfinite(def_.optimal_stretch)) {
      return Error{who() + "optimal_stretch = " + number(def_.optimal_stretch) +
                   "; the stretch at which the muscle is strongest must be positive"};
    }
    for (const auto& p : def_.amount.points) {
      if (!std::isfinite(p[1])) return Error{who() + "its amount has a value that is no finite number"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto regions = builder.regions(def_.body, def_.regions, def_.name);
    if (!regions) return regions.failure();
    const BodyData& body = builder.body(def_.body);
    std::vector<Vec3> cells = def_.directions;
    if (!def_.field.empty()) {
      auto read = cell_directions(body.mesh, def_.field);
      if (!read) return Error{who() + read.error()};
      cells = std::move(read).value();
    }
    if (!cells.empty()) {
      if (auto r = check_cells(body.mesh, "directions", cells.size()); !r) return Error{who() + r.error()};
    }
    auto amount = std::make_shared<Amount>(def_.amount);
    for (const std::size_t r : regions.value()) {
      const RegionData& region = body.regions[r];
      const std::string name = def_.name + (body.regions.size() > 1 ? "/" + region.name : "");
      auto axis = axes(body, region, builder.solid(region.elastic_pool), cells);
      if (!axis) return Error{who() + axis.error()};
      auto pool = std::make_shared<MusclePool>(name, builder.solid(region.elastic_pool), axis.value(),
                                               PullLaw{def_.tension, def_.optimal_stretch, def_.width});
      add_given(builder, name, std::move(pool), amount);
    }
    return std::unique_ptr<EffectInstance>(std::make_unique<MuscleInstance>(def_.name, std::move(amount)));
  }

 private:
  std::string who() const { return "muscle \"" + def_.name + "\": "; }

  Result<void> check_direction(const std::string& what, const Vec3& d) const {
    const double n = dot(d, d);
    if (n > 0 && std::isfinite(n)) return {};
    return Error{who() + what + " has no length; give three numbers that are not all zero"};
  }

  // Of the stencils of the energy. A patch takes the axis that its cells agree on best, whatever their signs.
  Result<std::vector<Vec3>> axes(const BodyData& body, const RegionData& region, const SolidPool& solid,
                                 const std::vector<Vec3>& cells) const {
    std::vector<Vec3> out(at(solid.stencils()), (1 / norm(def_.direction)) * def_.direction);
    if (cells.empty()) return out;
    for (const Index c : region.cells) {
      const double n = dot(cells[at(c)], cells[at(c)]);
      if (!(n > 0) || !std::isfinite(n))
        return Error{"the direction in cell " + std::to_string(c) + " has no length"};
    }
    const auto unit = [&](Index c) { return (1 / norm(cells[at(c)])) * cells[at(c)]; };
    if (body.element != Element::tet4_edge_smoothed) {
      for (Index s = 0; s < solid.stencils(); ++s) out[at(s)] = unit(solid.data().cell[at(s)]);
      return out;
    }
    auto made = edge_patch_data(rest_of(body), body.mesh.cells, region.cells);
    if (!made) return made.failure();
    const SolidData& patches = made.value();
    for (Index s = 0; s < solid.stencils(); ++s) {
      Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
      for (Index k = patches.patch_cells.offset[at(s)]; k < patches.patch_cells.offset[at(s) + 1]; ++k) {
        const Vec3 d = unit(patches.patch_cells.item[at(k)]);
        const Eigen::Vector3d v(d.x, d.y, d.z);
        mean += patches.patch_share[at(k)] * v * v.transpose();
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(mean);
      const Eigen::Vector3d v = eigen.eigenvectors().col(2);
      out[at(s)] = {v.x(), v.y(), v.z()};
    }
    return out;
  }
  static std::span<const Vec3> rest_of(const BodyData& body) { return body.mesh.nodes; }

  MuscleDef def_;
};

}  // namespace

EffectPtr muscle(MuscleDef def) {
  return std::make_shared<MuscleEffect>(std::move(def));
}

}  // namespace isochor
