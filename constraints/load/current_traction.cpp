#include "constraints/load/current_traction.h"

#include <algorithm>
#include <cmath>

#include "constraints/stencil/amount_row.h"

namespace isochor {

namespace {

// The function of a face is -c(held) . x with c_a the integral of N_a t over its area as it is held, so that
// with the amount as multiplier its forces are amount * c. Such a load has no potential: what the area adds
// is held where the iteration began.
class CurrentTractionPool final : public StencilPool, public LaggedStencils {
 public:
  CurrentTractionPool(std::string name, const LoadedFaces& loaded, bool couples)
      : name_(std::move(name)),
        rule_(varying_face_rule(loaded.per)),
        traction_(loaded.traction),
        couples_(couples) {
    for (std::size_t f = 0; f < loaded.count(); ++f)
      nodes_.push(std::span(loaded.faces).subspan(f * loaded.per, loaded.per));
    finish_topology();
  }
  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.functions = 1}; }
  StencilFacets facets() const override { return {.lagged = this}; }
  bool couples() const override { return couples_; }

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override {
    const std::span<const Vec3> held = request.lag.x.empty() ? request.rest : request.lag.x;
    const std::size_t n = static_cast<std::size_t>(rule_.nodes);
    for (Index s = request.begin; s < request.end; ++s) {
      const auto nodes = nodes_[s];
      std::array<Vec3, 6> c{};
      visit(s, held,
            [&](double w, const double* N, const double*, const double*, const Vec3& t, const Vec3& u,
                const Vec3& v) {
              const double area = w * norm(cross(u, v));
              for (std::size_t a = 0; a < n; ++a) c[a] -= (area * N[a]) * t;
            });
      write_held_function(request, slots, *this, s, c.data(),
                          [&](std::size_t a) { return request.rest[at(nodes[a])]; });
    }
  }

  void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const override {
    const std::size_t n = static_cast<std::size_t>(rule_.nodes);
    for (Index s = request.begin; s < request.end; ++s) {
      const double amount = request.function_multiplier[at(s)];
      Mat3* block = slots.block.data() + slots.block_offset[at(s)];
      visit(s, request.x,
            [&](double w, const double* N, const double* N_u, const double* N_v, const Vec3& t, const Vec3& u,
                const Vec3& v) {
              const Vec3 normal = direction(cross(u, v));
              // d|u x v| = du . (v x n) + dv . (n x u).
              const Vec3 by_u = cross(v, normal), by_v = cross(normal, u);
              for (std::size_t a = 0; a < n; ++a) {
                for (std::size_t b = 0; b < n; ++b)
                  add_outer(block[a * n + b], -amount * w * N[a], t, N_u[b] * by_u + N_v[b] * by_v);
              }
            });
    }
  }

 private:
  // Calls f(weight, N, N_u, N_v, traction, tangents) at the points of a face.
  template <class F>
  void visit(Index s, std::span<const Vec3> x, F f) const {
    const auto nodes = nodes_[s];
    const std::size_t n = nodes.size(), first = at(nodes_.offset[at(s)]);
    for (std::size_t q = 0; q < static_cast<std::size_t>(rule_.points); ++q) {
      const double *N = rule_.N.data() + q * n, *N_u = rule_.N_u.data() + q * n,
                   *N_v = rule_.N_v.data() + q * n;
      Vec3 t{}, u{}, v{};
      for (std::size_t a = 0; a < n; ++a) {
        t += N[a] * traction_[first + a];
        u += N_u[a] * x[at(nodes[a])];
        v += N_v[a] * x[at(nodes[a])];
      }
      f(rule_.weight[q], N, N_u, N_v, t, u, v);
    }
  }

  std::string name_;
  const FaceRule& rule_;
  std::vector<Vec3> traction_;  // parallel to nodes_.item [Pa]
  bool couples_;
};

}  // namespace

Result<std::vector<double>> node_factors(const Mesh& mesh, const std::string& field) {
  if (field.empty()) return std::vector<double>(at(mesh.node_count()), 1.0);
  std::string known;
  for (const MeshField& f : mesh.fields) {
    known += (known.empty() ? "\"" : ", \"") + f.name + "\"";
    if (f.name != field) continue;
    if (f.components == 1) return f.values;
    return Error{"field \"" + field + "\" has " + std::to_string(f.components) +
                 " components; factors on a load have one"};
  }
  return Error{"field \"" + field + "\" is none of the nodes of the mesh; they have " +
               (known.empty() ? "none" : known)};
}

std::vector<std::pair<Index, Vec3>> rest_area_forces(const LoadedFaces& faces, std::span<const Vec3> rest) {
  const FaceRule& rule = varying_face_rule(faces.per);
  const std::size_t n = faces.per;
  std::vector<std::pair<Index, Vec3>> out;
  for (std::size_t f = 0; f < faces.count(); ++f) {
    const Index* nodes = faces.faces.data() + f * n;
    std::vector<Vec3> force(n);
    for (std::size_t q = 0; q < static_cast<std::size_t>(rule.points); ++q) {
      Vec3 t{}, u{}, v{};
      for (std::size_t a = 0; a < n; ++a) {
        t += rule.N[q * n + a] * faces.traction[f * n + a];
        u += rule.N_u[q * n + a] * rest[at(nodes[a])];
        v += rule.N_v[q * n + a] * rest[at(nodes[a])];
      }
      const double area = rule.weight[q] * norm(cross(u, v));
      for (std::size_t a = 0; a < n; ++a) force[a] += (area * rule.N[q * n + a]) * t;
    }
    for (std::size_t a = 0; a < n; ++a) out.emplace_back(nodes[a], force[a]);
  }
  return out;
}

void add_current_traction(Builder& builder, const std::string& name, const LoadedFaces& faces, bool lagged,
                          const std::shared_ptr<const Amount>& amount) {
  // Where supports hold all of a face, nobody asks how its forces change.
  const bool free = std::any_of(faces.faces.begin(), faces.faces.end(),
                                [&](Index node) { return builder.given_directions(node) < 3; });
  auto pool = std::make_shared<CurrentTractionPool>(name, faces, free && !lagged);
  add_given(builder, name, std::move(pool), amount);
}

}  // namespace isochor
