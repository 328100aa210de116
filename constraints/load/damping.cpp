#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "isochor/effects/load.h"

namespace isochor {

namespace {

constexpr std::size_t kPacked[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

// Kelvin-Voigt viscosity by the potential of one increment: viscosity/h |E - E_before|^2 [Pa] with Green's
// strain E, so that rigid motions cost nothing. Its second Piola-Kirchhoff stress is 2 viscosity (E -
// E_before)/h. Without an increment (statics, results) all is zero.
class ViscousPool final : public StencilPool, public DissipativeStencils {
 public:
  ViscousPool(std::string name, const SolidPool& solid, double viscosity)
      : name_(std::move(name)), solid_(solid), viscosity_(viscosity) {
    nodes_ = solid.nodes();
    finish_topology();
  }
  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.energy = true}; }
  StencilFacets facets() const override { return {.dissipative = this}; }

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override {
    for (Index s = request.begin; s < request.end; ++s) {
      const std::size_t n = nodes_[s].size(), first = at(nodes_.offset[at(s)]);
      Mat3* blocks = request.want == Want::hessian ? slots.hessian.data() + hessian_offset()[at(s)] : nullptr;
      slots.energy[at(s)] = 0;
      if (request.want != Want::value) std::fill_n(slots.gradient.data() + first, n, Vec3{});
      if (blocks) std::fill_n(blocks, n * (n + 1) / 2, Mat3{});
      if (request.increment.h <= 0) continue;
      for (int q = 0; q < solid_.data().points; ++q) add_point(request, slots, s, q, blocks);
    }
  }

 private:
  // Green's strain, packed 00, 11, 22, 01, 02, 12, from displacements: exact zero at rest.
  void strain(Index s, int q, std::span<const Vec3> x, std::span<const Vec3> rest, double F[9],
              double E[6]) const {
    double volume_strain;
    solid_.deformation_gradient(s, q, x, rest, F, volume_strain);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i; j < 3; ++j) {
        E[kPacked[i][j]] =
            0.5 * (F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j] - (i == j ? 1.0 : 0.0));
      }
    }
  }

  void add_point(const StencilRequest& request, const StencilSlots& slots, Index s, int q,
                 Mat3* blocks) const {
    double F[9], F0[9], E[6], E0[6], S[6];
    strain(s, q, request.increment.before, request.rest, F0, E0);
    strain(s, q, request.x, request.rest, F, E);
    const double w = solid_.data().weight[at(s * solid_.data().points + q)];
    const double c = viscosity_ / request.increment.h;
    double squares = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const double d = E[i] - E0[i];
      squares += (i < 3 ? 1 : 2) * d * d;
      S[i] = 2 * c * d;
    }
    slots.energy[at(s)] += w * c * squares;
    if (request.want == Want::value) return;
    const std::size_t n = nodes_[s].size(), first = at(nodes_.offset[at(s)]);
    const Vec3* B = solid_.data().gradient.data() + static_cast<std::size_t>(solid_.data().points) * first +
                    static_cast<std::size_t>(q) * n;
    const auto times_F = [&](const Vec3& v) {
      return Vec3{F[0] * v.x + F[1] * v.y + F[2] * v.z, F[3] * v.x + F[4] * v.y + F[5] * v.z,
                  F[6] * v.x + F[7] * v.y + F[8] * v.z};
    };
    const auto times_S = [&](const Vec3& v) {
      return Vec3{S[0] * v.x + S[3] * v.y + S[4] * v.z, S[3] * v.x + S[1] * v.y + S[5] * v.z,
                  S[4] * v.x + S[5] * v.y + S[2] * v.z};
    };
    for (std::size_t a = 0; a < n; ++a) slots.gradient[first + a] += w * times_F(times_S(B[a]));
    if (!blocks) return;
    // The part with S is the only one that can be negative.
    if (request.definiteness != Definiteness::exact) make_definite(request.definiteness, S);
    Mat3 FFt;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        FFt(i, j) = F[3 * i] * F[3 * j] + F[3 * i + 1] * F[3 * j + 1] + F[3 * i + 2] * F[3 * j + 2];
      }
    }
    for (std::size_t a = 0; a < n; ++a) {
      const Vec3 fa = times_F(B[a]), sa = times_S(B[a]);
      for (std::size_t b = 0; b <= a; ++b) {
        const Vec3 fb = times_F(B[b]);
        const double shared = c * dot(B[a], B[b]), initial = dot(sa, B[b]);
        Mat3& block = blocks[a * (a + 1) / 2 + b];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) block(i, j) += w * (c * fb[i] * fa[j] + shared * FFt(i, j));
          block(i, i) += w * initial;
        }
      }
    }
  }

  static void make_definite(Definiteness policy, double S[6]) {
    Lanes s[6], values[3], Q[9];
    for (int i = 0; i < 6; ++i) s[i] = broadcast(S[i]);
    symmetric_eigen3(s, values, Q);
    for (int i = 0; i < 6; ++i) S[i] = 0;
    for (int k = 0; k < 3; ++k) {
      const double v =
          policy == Definiteness::absolute ? std::abs(values[k][0]) : std::max(values[k][0], 0.0);
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = i; j < 3; ++j) S[kPacked[i][j]] += v * Q[3 * i + k][0] * Q[3 * j + k][0];
      }
    }
  }

  std::string name_;
  const SolidPool& solid_;  // of the same system
  double viscosity_;
};

// Drag in proportion to mass: rate m/(2 h) |x - x_before|^2 at every node.
class DragPool final : public StencilPool, public DissipativeStencils {
 public:
  DragPool(std::string name, const std::vector<std::pair<Index, double>>& mass, double rate)
      : name_(std::move(name)) {
    for (const auto& [node, m] : mass) {
      const Index list[] = {node};
      nodes_.push(list);
      factor_.push_back(rate * m);
    }
    finish_topology();
  }
  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.energy = true}; }
  StencilFacets facets() const override { return {.dissipative = this}; }

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override {
    const double h = request.increment.h;
    for (Index s = request.begin; s < request.end; ++s) {
      const auto node = at(nodes_[s][0]);
      const double c = h > 0 ? factor_[at(s)] / h : 0;
      const Vec3 d = h > 0 ? request.x[node] - request.increment.before[node] : Vec3{};
      slots.energy[at(s)] = 0.5 * c * dot(d, d);
      if (request.want == Want::value) continue;
      slots.gradient[at(s)] = c * d;
      if (request.want != Want::hessian) continue;
      Mat3& block = slots.hessian[static_cast<std::size_t>(hessian_offset()[at(s)])];
      block = {};
      for (int i = 0; i < 3; ++i) block(i, i) = c;
    }
  }

 private:
  std::string name_;
  std::vector<double> factor_;
};

class DampingInstance final : public EffectInstance {};

class DampingEffect final : public EffectSource {
 public:
  explicit DampingEffect(DampingDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    for (const auto& [key, value, unit] :
         {std::tuple{"viscosity", def_.viscosity, "Pa s"}, {"mass_rate", def_.mass_rate, "1/s"}}) {
      if (value >= 0 && std::isfinite(value)) continue;
      return Error{"damping \"" + def_.name + "\": " + key + " = " + number(value) + " " + unit +
                   "; it must be zero (off) or positive, or motion would feed on it"};
    }
    if (def_.viscosity == 0 && def_.mass_rate == 0) {
      return Error{"damping \"" + def_.name +
                   "\": viscosity and mass_rate are both zero; give one of them or remove the damping"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto regions = builder.regions(def_.body, def_.regions, def_.name);
    if (!regions) return regions.failure();
    const BodyData& body = builder.body(def_.body);
    for (const std::size_t r : regions.value()) {
      const RegionData& region = body.regions[r];
      const std::string who = def_.name + (body.regions.size() > 1 ? "/" + region.name : "");
      if (def_.viscosity > 0) {
        builder.add_stencils(
            std::make_shared<ViscousPool>(who, builder.solid(region.elastic_pool), def_.viscosity));
      }
      if (def_.mass_rate == 0) continue;
      std::vector<double> mass(builder.rest().size(), 0);
      add_lumped_mass(*body.reference, builder.rest(), body.global_cells, region.cells, region.density, mass);
      std::vector<std::pair<Index, double>> nodes;
      for (std::size_t i = 0; i < mass.size(); ++i) {
        if (mass[i] > 0) nodes.emplace_back(static_cast<Index>(i), mass[i]);
      }
      builder.add_stencils(std::make_shared<DragPool>(who + " drag", nodes, def_.mass_rate));
    }
    return std::unique_ptr<EffectInstance>(std::make_unique<DampingInstance>());
  }

 private:
  DampingDef def_;
};

}  // namespace

EffectPtr damping(DampingDef def) {
  return std::make_shared<DampingEffect>(std::move(def));
}

}  // namespace isochor
