#include "isochor/effects/cavity.h"

#include <algorithm>
#include <cmath>

#include "constraints/chamber/chamber_caps.h"
#include "constraints/chamber/chamber_network.h"
#include "constraints/chamber/chamber_surface.h"
#include "constraints/stencil/face_pool.h"
#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "engine/scene/embedding.h"

namespace isochor {

namespace {

class CavityRow final : public RowPool {
 public:
  CavityRow(std::string name, CavityControl control, double rest_volume, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), control_(control), rest_volume_(rest_volume), amount_(std::move(amount)) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override { value[0] = amount_value(t); }

  // Multiplier -p for pressure control, target volume otherwise.
  double amount_value(double t) const {
    const double a = amount_->value(t);
    if (control_ == CavityControl::pressure) return -a;
    return control_ == CavityControl::volume ? a : a * rest_volume_;
  }

 private:
  std::string name_;
  CavityControl control_;
  double rest_volume_;
  std::shared_ptr<Amount> amount_;
};

// The weight of a liquid: its potential energy over density times gravity, as a row whose multiplier is
// given.
class WeightRow final : public RowPool {
 public:
  WeightRow(std::string name, double density_gravity, Curve curve)
      : name_(std::move(name)), weight_(density_gravity), curve_(std::move(curve)) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override { value[0] = weight_ * evaluate(curve_, t); }

 private:
  std::string name_;
  double weight_;  // density times gravity [Pa/m]
  Curve curve_;
};

class CavityInstance final : public EffectInstance {
 public:
  CavityInstance(std::string name, std::shared_ptr<const EnclosedVolumePool> pool,
                 std::shared_ptr<CavityRow> row, Index row_pool, std::shared_ptr<Amount> amount)
      : name_(std::move(name)),
        pool_(std::move(pool)),
        row_(std::move(row)),
        row_pool_(row_pool),
        amount_(std::move(amount)) {}

  // Of a chamber in a network.
  std::shared_ptr<const ChamberNetwork> network;
  Index chamber = 0;

  Amount* amount() override { return amount_.get(); }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    const bool given = !network && row_->law == RowLaw::prescribed;
    const double lambda =
        given ? row_->amount_value(c.state.t) : c.state.lambda[at(c.system.first_row(row_pool_) + chamber)];
    out.push_back({name_, "cavity", "pressure", "Pa", -lambda});
    out.push_back({name_, "cavity", "volume", "m^3", pool_->volume(c.state.x)});
    if (!network) return;
    const auto memory = c.system.row_memory(row_pool_, std::span<const double>(c.state.extra));
    out.push_back({name_, "cavity", "content", "m^3", ChamberNetwork::held(memory, chamber)});
  }
  std::vector<GaugeSource> gauge_sources() const override {
    return {{"pressure", row_pool_, chamber, true, -1}, {"volume", row_pool_, chamber, false, 1}};
  }

 private:
  std::string name_;
  std::shared_ptr<const EnclosedVolumePool> pool_;
  std::shared_ptr<CavityRow> row_;
  Index row_pool_;
  std::shared_ptr<Amount> amount_;
};

class CavityEffect final : public EffectSource {
 public:
  explicit CavityEffect(CavityDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    for (const auto& p : def_.amount.points) {
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
        return Error{who() + "its amount has a value that is no number"};
      if (def_.control == CavityControl::gas && p[1] <= 0) {
        return Error{who() + "gas amount " + number(p[1]) +
                     "; some gas must stay in the chamber, give positive amounts"};
      }
      if (def_.control != CavityControl::pressure && p[1] <= 0) {
        return Error{who() + "volume amount " + number(p[1]) + "; a chamber's volume must stay positive"};
      }
    }
    if (def_.surfaces.empty())
      return Error{who() + "no surface named; name the faces that bound the chamber"};
    return check_content();
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto list = builder.faces(def_.body, def_.surfaces, def_.name);
    if (!list) return list.failure();
    const BodyData& body = builder.body(def_.body);
    const auto per = static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type));
    std::vector<ChamberFace> faces;
    for (std::size_t f = 0; f < list.value().size(); f += per) {
      const auto first = list.value().begin() + static_cast<std::ptrdiff_t>(f);
      faces.emplace_back(first, first + static_cast<std::ptrdiff_t>(per));
    }
    if (auto r = body.thin() ? orient_sheet(body, faces, builder.rest(), who())
                             : orient_faces(body, faces, builder.rest(), who());
        !r)
      return r.failure();
    Vec3 origin{};
    for (const ChamberFace& f : faces)
      origin += (1.0 / static_cast<double>(faces.size())) * builder.rest()[at(f[0])];
    auto loops = boundary_loops(faces, who());
    if (!loops) return loops.failure();
    SymmetryCaps symmetry(builder, builder.length());
    std::vector<const std::vector<Index>*> fans;
    for (const auto& loop : loops.value()) {
      if (auto r = check_opening(builder, body, loop); !r) return r.failure();
      const bool flat = symmetry.planar(loop);
      if (flat || !symmetry.add_loop(loop, per == 6 ? 2 : 1)) fans.push_back(&loop);
    }
    warn_of_lids(builder, faces, loops.value());
    origin = symmetry.place(origin);
    if (!symmetry.fits(origin)) {
      return Error{who() +
                   "an opening runs over symmetry planes that do not meet in one point; model more of the "
                   "body, or close the surface"};
    }
    auto pool = std::make_shared<EnclosedVolumePool>(def_.name, origin);
    for (const ChamberFace& f : faces) pool->add_face(f, face_rule(per));
    for (const auto* loop : fans) add_cap(*pool, *loop, builder.rest(), per == 6);
    symmetry.add_to(*pool, origin);
    pool->finish();
    return finish(builder, pool);
  }

 private:
  std::string who() const { return "cavity \"" + def_.name + "\": "; }
  bool has_law() const { return def_.control == CavityControl::gas || def_.control == CavityControl::liquid; }

  Result<void> check_content() const {
    if (!(def_.polytropic >= 1) || !std::isfinite(def_.polytropic)) {
      return Error{who() + "polytropic = " + number(def_.polytropic) +
                   "; it is 1 for an isothermal gas and 1.4 for air without heat exchange"};
    }
    if (!(def_.ambient > 0) || !std::isfinite(def_.ambient)) {
      return Error{who() + "ambient = " + number(def_.ambient) +
                   " Pa; the absolute pressure outside must be positive, 101325 Pa at sea level"};
    }
    if (!(def_.density >= 0) || !std::isfinite(def_.density) ||
        !std::isfinite(dot(def_.gravity, def_.gravity))) {
      return Error{who() + "density = " + number(def_.density) +
                   " kg/m^3; density and gravity of the liquid must be finite, the density not negative"};
    }
    return {};
  }

  Result<void> check_opening(const Builder& builder, const BodyData& body,
                             const std::vector<Index>& loop) const {
    if (def_.cap_free_openings) return {};
    for (const Index n : loop) {
      if (builder.given_directions(n) > 0) continue;
      const Vec3& X = builder.rest()[at(n)];
      return Error{who() + "it has an opening of " + std::to_string(loop.size()) +
                   " nodes that nothing caps: node " + std::to_string(n - body.first_node + 1) + " at (" +
                   number(X.x) + ", " + number(X.y) + ", " + number(X.z) +
                   ") is free; close the surface, hold the rim with a dirichlet support added before the "
                   "cavity, or set "
                   "cap_free_openings for a membrane that seals it and pulls on its rim. For a load on faces "
                   "that bound no "
                   "chamber take a pressure (it follows them) or a traction"};
    }
    return {};
  }

  // A cap hands the force on it to its rim. Over faces that point one way it is as large as that on them, and
  // what was meant as a load ends as a pinch of the rim.
  void warn_of_lids(Builder& builder, const std::vector<ChamberFace>& faces,
                    const std::vector<std::vector<Index>>& loops) const {
    const auto is_free = [&](const std::vector<Index>& loop) {
      return std::any_of(loop.begin(), loop.end(), [&](Index n) { return builder.given_directions(n) == 0; });
    };
    if (std::none_of(loops.begin(), loops.end(), is_free)) return;
    const auto rest = builder.rest();
    Vec3 sum{};
    double area = 0;
    for (const ChamberFace& f : faces) {
      const std::size_t last = corners_of(f) - 1;
      const Vec3 n = 0.5 * cross(rest[at(f[last - 1])] - rest[at(f[0])],
                                 rest[at(f[last])] - rest[at(f[last == 3 ? 1 : 0])]);
      sum += n;
      area += std::sqrt(dot(n, n));
    }
    const double net = std::sqrt(dot(sum, sum));
    if (net < 0.3 * area) return;
    builder.warn(who() +
                 "its surface is mostly open, and the cap over its free rim cancels the load: of the force "
                 "on the faces, " +
                 number(net) +
                 " m^2 times the pressure, nothing reaches the supports; "
                 "take a pressure (or a traction) for a load on faces that bound no chamber");
  }

  Result<std::unique_ptr<EffectInstance>> finish(Builder& builder,
                                                 const std::shared_ptr<EnclosedVolumePool>& pool) const {
    const double rest_volume = pool->volume(builder.rest());
    const bool needs_chamber = def_.control != CavityControl::pressure || def_.density > 0;
    if (needs_chamber && rest_volume <= 0) {
      return Error{who() + "its surface encloses the body rather than a chamber (signed volume " +
                   number(rest_volume) +
                   " m^3); volume control needs a chamber, use pressure control outside"};
    }
    auto amount = std::make_shared<Amount>(def_.amount);
    const double metric = std::abs(rest_volume) / stiffest(builder.body(def_.body));
    add_weight(builder, *pool);
    if (has_law()) {
      auto network = chamber_network(builder);
      ChamberContent content{
          def_.name, def_.control == CavityControl::gas, def_.polytropic, def_.ambient, rest_volume, amount};
      const Index chamber = network->add_chamber(std::move(content), *pool, metric, builder.owner());
      auto instance =
          std::make_unique<CavityInstance>(def_.name, pool, nullptr, network->row_pool, std::move(amount));
      instance->network = network;
      instance->chamber = chamber;
      return std::unique_ptr<EffectInstance>(std::move(instance));
    }
    auto row = std::make_shared<CavityRow>(def_.name, def_.control, rest_volume, amount);
    row->stencil_pool = builder.add_stencils(pool);
    row->law = def_.control == CavityControl::pressure ? RowLaw::prescribed : RowLaw::compliant;
    push_row(*row, *pool, metric, std::abs(rest_volume));
    const Index row_pool = builder.add_rows(row);
    return std::unique_ptr<EffectInstance>(
        std::make_unique<CavityInstance>(def_.name, pool, row, row_pool, std::move(amount)));
  }

  // One row over all faces.
  static void push_row(RowPool& row, const StencilPool& pool, double metric, double measure) {
    for (Index f = 0; f < pool.stencils(); ++f) {
      row.map.item.push_back(f);
      row.weight.push_back(1);
    }
    row.map.offset.push_back(pool.stencils());
    row.metric.push_back(metric);
    row.measure.push_back(measure);
  }

  // The pressure that the liquid's own weight adds, density gravity . (x - datum): minus the gradient of its
  // potential energy.
  void add_weight(Builder& builder, const EnclosedVolumePool& surface) const {
    const double g = std::sqrt(dot(def_.gravity, def_.gravity));
    if (def_.density == 0 || g == 0) return;
    const Vec3 datum = def_.datum.value_or(middle(builder, surface));
    auto moment = std::make_shared<EnclosedVolumePool>(def_.name + "/weight", surface.origin(),
                                                       (-1 / g) * def_.gravity, datum);
    moment->add_faces(surface);
    moment->finish();
    auto row = std::make_shared<WeightRow>(def_.name + "/weight", def_.density * g, def_.gravity_curve);
    row->stencil_pool = builder.add_stencils(moment);
    row->law = RowLaw::prescribed;
    const double volume = surface.volume(builder.rest()), length = std::cbrt(volume);
    push_row(*row, *moment, volume * length * length / stiffest(builder.body(def_.body)), volume * length);
    builder.add_rows(row);
  }

  // Of the box around the surface.
  static Vec3 middle(const Builder& builder, const EnclosedVolumePool& surface) {
    Vec3 lower = builder.rest()[at(surface.nodes().item.front())], upper = lower;
    for (const Index n : surface.nodes().item) {
      for (int k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], builder.rest()[at(n)][k]);
        upper[k] = std::max(upper[k], builder.rest()[at(n)][k]);
      }
    }
    return 0.5 * (lower + upper);
  }

  CavityDef def_;
};

}  // namespace

EffectPtr cavity(CavityDef def) {
  return std::make_shared<CavityEffect>(std::move(def));
}

}  // namespace isochor
