#include <algorithm>
#include <cmath>
#include <map>

#include "constraints/load/varying_load.h"
#include "constraints/stencil/amount_row.h"
#include "constraints/stencil/face_pool.h"
#include "constraints/stencil/surface_nodes.h"
#include "engine/base/fingerprint.h"
#include "engine/scene/builder.h"
#include "isochor/effects/load.h"

namespace isochor {

namespace {

// Shape functions of an edge (ends, then its middle) and their derivatives at Gauss points of [0, 1]: what
// the rim adds has degree 1 on straight edges and 5 on curved ones.
struct EdgeRule {
  std::size_t points;
  std::vector<double> weight, N, N_s;  // [q * nodes + a]
};

const EdgeRule& edge_rule(std::size_t nodes) {
  static const EdgeRule straight{1, {1}, {0.5, 0.5}, {-1, 1}};
  static const EdgeRule curved = [] {
    EdgeRule r{3, {5.0 / 18, 8.0 / 18, 5.0 / 18}, {}, {}};
    const double g = std::sqrt(0.15);
    for (const double s : {0.5 - g, 0.5, 0.5 + g}) {
      r.N.insert(r.N.end(), {(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)});
      r.N_s.insert(r.N_s.end(), {4 * s - 3, 4 * s - 1, 4 - 8 * s});
    }
    return r;
  }();
  return nodes == 2 ? straight : curved;
}

// What the rim of an open surface adds to the gradient of the volume under it, so that the sum is the
// integral of N_a n dA: c_a = 1/3 of the integral of N_a (x - origin) x dx along the rim (by Stokes'
// theorem). It has no potential, so it is held where the iteration began: the function of an edge is c(held)
// . x.
class RimPool final : public StencilPool, public LaggedStencils {
 public:
  RimPool(std::string name, const Vec3& origin, bool couples)
      : name_(std::move(name)), origin_(origin), couples_(couples) {}
  // As the faces run along it.
  void add_edge(std::span<const Index> nodes) { nodes_.push(nodes); }
  void finish() { finish_topology(); }

  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.functions = 1}; }
  StencilFacets facets() const override { return {.lagged = this}; }
  bool couples() const override { return couples_; }

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override {
    const std::span<const Vec3> held = request.lag.x.empty() ? request.rest : request.lag.x;
    for (Index e = request.begin; e < request.end; ++e) {
      const std::size_t n = nodes_[e].size();
      std::array<Vec3, 3> c{};
      visit(e, held, [&](double w, const double* N, const double*, const Vec3& y, const Vec3& d) {
        for (std::size_t a = 0; a < n; ++a) c[a] += w * N[a] * cross(y, d);
      });
      write_held_function(request, slots, *this, e, c.data(), [&](std::size_t) { return origin_; });
    }
  }

  void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const override {
    for (Index e = request.begin; e < request.end; ++e) {
      const std::size_t n = nodes_[e].size();
      const double sigma = request.function_multiplier[at(e)];
      Mat3* block = slots.block.data() + slots.block_offset[at(e)];
      visit(e, request.x, [&](double w, const double* N, const double* N_s, const Vec3& y, const Vec3& d) {
        for (std::size_t a = 0; a < n; ++a) {
          for (std::size_t b = 0; b < n; ++b) {
            add_cross(block[a * n + b], sigma * w * N[a] * N_s[b], y);
            add_cross(block[a * n + b], -sigma * w * N[a] * N[b], d);
          }
        }
      });
    }
  }

 private:
  // Calls f(weight, N, N_s, position relative to the origin, tangent) at the points of an edge.
  template <class F>
  void visit(Index e, std::span<const Vec3> x, F f) const {
    const auto nodes = nodes_[e];
    const std::size_t n = nodes.size();
    const EdgeRule& r = edge_rule(n);
    for (std::size_t q = 0; q < r.points; ++q) {
      const double *N = r.N.data() + q * n, *N_s = r.N_s.data() + q * n;
      Vec3 y{}, d{};
      for (std::size_t a = 0; a < n; ++a) {
        const Vec3 p = x[at(nodes[a])] - origin_;
        y += N[a] * p;
        d += N_s[a] * p;
      }
      f(r.weight[q] / 3, N, N_s, y, d);
    }
  }

  std::string name_;
  Vec3 origin_;
  bool couples_;
};

// Edges that the faces run along more often one way than the other, in the direction that is left over;
// curved ones with their middle node.
std::vector<std::vector<Index>> rim_of(std::span<const Index> faces, std::size_t per) {
  struct Edge {
    int open = 0;
    Index middle = -1;
  };
  std::map<std::pair<Index, Index>, Edge> edges;
  const std::size_t corners = per == 4 ? 4 : 3;
  for (std::size_t f = 0; f < faces.size(); f += per) {
    for (std::size_t k = 0; k < corners; ++k) {
      const Index a = faces[f + k], b = faces[f + (k + 1) % corners];
      Edge& edge = edges[std::minmax(a, b)];
      edge.open += a < b ? 1 : -1;
      if (per == 6) edge.middle = faces[f + 3 + k];
    }
  }
  std::vector<std::vector<Index>> rim;
  for (const auto& [ends, edge] : edges) {
    std::vector<Index> nodes = {ends.first, ends.second};
    if (edge.open < 0) std::swap(nodes[0], nodes[1]);
    if (edge.middle >= 0) nodes.push_back(edge.middle);
    rim.insert(rim.end(), at(std::abs(edge.open)), nodes);
  }
  return rim;
}

class PressureInstance final : public EffectInstance {
 public:
  PressureInstance(std::string name, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    out.push_back({name_, "pressure", "pressure", "Pa", amount_->value(c.state.t)});
  }

 private:
  std::string name_;
  std::shared_ptr<Amount> amount_;
};

class PressureEffect final : public EffectSource {
 public:
  explicit PressureEffect(PressureDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    for (const auto& p : def_.amount.points) {
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
        return Error{"pressure \"" + def_.name + "\": its amount has a value that is no finite number"};
    }
    if (def_.surfaces.empty())
      return Error{"pressure \"" + def_.name + "\": no surface named; name the faces that it acts on"};
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto list = outward_faces(builder, def_.body, def_.surfaces, "pressure \"" + def_.name + "\"");
    if (!list) return list.failure();
    const std::vector<Index>& faces = list.value();
    if (!def_.field.empty() || !def_.profile.empty()) return build_varying(builder, faces);
    const auto per = static_cast<std::size_t>(nodes_per_face(builder.body(def_.body).mesh.cell_type));
    Vec3 origin{};
    for (const Index n : faces) origin += (1.0 / static_cast<double>(faces.size())) * builder.rest()[at(n)];
    auto amount = std::make_shared<Amount>(def_.amount);
    auto volume = std::make_shared<EnclosedVolumePool>(def_.name, origin);
    for (std::size_t f = 0; f < faces.size(); f += per)
      volume->add_face(std::span(faces).subspan(f, per), face_rule(per));
    volume->finish();
    add_given(builder, def_.name, volume, amount);
    const auto rim = rim_of(faces, per);
    const bool free_rim = std::any_of(rim.begin(), rim.end(), [&](const std::vector<Index>& edge) {
      return std::any_of(edge.begin(), edge.end(), [&](Index n) { return builder.given_directions(n) < 3; });
    });
    if (!rim.empty()) {
      auto edges = std::make_shared<RimPool>(def_.name + "/rim", origin, free_rim && !def_.lagged);
      for (const auto& edge : rim) edges->add_edge(edge);
      edges->finish();
      add_given(builder, def_.name + "/rim", edges, amount);
    }
    return std::unique_ptr<EffectInstance>(std::make_unique<PressureInstance>(def_.name, std::move(amount)));
  }

 private:
  // No volume stands for it: the forces are integrated face by face, the rim is nothing special.
  Result<std::unique_ptr<EffectInstance>> build_varying(Builder& builder,
                                                        const std::vector<Index>& faces) const {
    auto loaded = loaded_faces(builder, builder.body(def_.body), faces, def_.field, def_.profile);
    if (!loaded) return Error{"pressure \"" + def_.name + "\": " + loaded.error()};
    auto amount = std::make_shared<Amount>(def_.amount);
    add_varying_load(builder, def_.name, std::move(loaded).value(), def_.lagged, amount);
    return std::unique_ptr<EffectInstance>(std::make_unique<PressureInstance>(def_.name, std::move(amount)));
  }

  PressureDef def_;
};

}  // namespace

EffectPtr pressure(PressureDef def) {
  return std::make_shared<PressureEffect>(std::move(def));
}

}  // namespace isochor
