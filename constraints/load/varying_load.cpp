#include "constraints/load/varying_load.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/stencil/amount_row.h"
#include "engine/base/text.h"
#include "engine/mesh/words.h"

namespace isochor {

namespace {

// The function of a face is -c(held) . x with c_a the integral of N_a times the load over its area as it is
// held, so that with the amount as multiplier its forces are amount * c. Such a load has no potential: what
// the area and its normal add is held where the iteration began.
class VaryingLoadPool final : public StencilPool, public LaggedStencils, public MovingStencils {
 public:
  VaryingLoadPool(std::string name, LoadedFaces loaded, bool couples)
      : name_(std::move(name)),
        rule_(varying_face_rule(loaded.per)),
        loaded_(std::move(loaded)),
        couples_(couples) {
    for (std::size_t f = 0; f < loaded_.count(); ++f)
      nodes_.push(std::span(loaded_.faces).subspan(f * loaded_.per, loaded_.per));
    finish_topology();
  }
  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.functions = 1}; }
  StencilFacets facets() const override {
    return {.lagged = this, .moving = loaded_.varies_in_time() ? this : nullptr};
  }
  bool moves(double t0, double t1) const override { return loaded_.varies_in_time() && t0 != t1; }
  bool couples() const override { return couples_; }

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override {
    const std::span<const Vec3> held = request.lag.x.empty() ? request.rest : request.lag.x;
    const std::size_t n = loaded_.per;
    for (Index s = request.begin; s < request.end; ++s) {
      const auto nodes = nodes_[s];
      std::array<Vec3, 6> c{};
      visit(s, held, request.increment.t1, [&](const Point& p) {
        if (loaded_.traction) {
          const double area = p.weight * norm(cross(p.u, p.v));
          for (std::size_t a = 0; a < n; ++a) c[a] -= (area * p.N[a]) * p.traction;
        } else {
          const Vec3 push = (p.weight * p.pressure) * cross(p.u, p.v);
          for (std::size_t a = 0; a < n; ++a) c[a] += p.N[a] * push;
        }
      });
      // A formula that has no value now: outside the domain.
      const bool inside = std::all_of(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(n),
                                      [](const Vec3& v) { return finite(v); });
      if (!inside) c = {};
      write_held_function(request, slots, *this, s, c.data(),
                          [&](std::size_t a) { return request.rest[at(nodes[a])]; });
      if (!inside) slots.energy[at(s)] = std::numeric_limits<double>::infinity();
    }
  }

  void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const override {
    for (Index s = request.begin; s < request.end; ++s) {
      const double amount = request.function_multiplier[at(s)];
      Mat3* block = slots.block.data() + slots.block_offset[at(s)];
      visit(s, request.x, request.increment.t1, [&](const Point& p) {
        if (loaded_.traction)
          add_area_change(p, amount, block);
        else
          add_normal_change(p, amount, block);
      });
    }
  }

 private:
  // A point of a face.
  struct Point {
    double weight = 0;
    const double *N = nullptr, *N_u = nullptr, *N_v = nullptr;
    Vec3 traction{};  // of a traction
    double pressure = 0;
    Vec3 u{}, v{};  // tangents
  };

  // d|u x v| = du . (v x n) + dv . (n x u).
  void add_area_change(const Point& p, double amount, Mat3* block) const {
    const std::size_t n = loaded_.per;
    const Vec3 normal = direction(cross(p.u, p.v)), by_u = cross(p.v, normal), by_v = cross(normal, p.u);
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b)
        add_outer(block[a * n + b], -amount * p.weight * p.N[a], p.traction,
                  p.N_u[b] * by_u + p.N_v[b] * by_v);
    }
  }
  // d(u x v) = u x dv - v x du.
  void add_normal_change(const Point& p, double amount, Mat3* block) const {
    const std::size_t n = loaded_.per;
    const double push = amount * p.weight * p.pressure;
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        add_cross(block[a * n + b], push * p.N[a] * p.N_v[b], p.u);
        add_cross(block[a * n + b], -push * p.N[a] * p.N_u[b], p.v);
      }
    }
  }

  template <class F>
  void visit(Index s, std::span<const Vec3> x, double time, F f) const {
    const auto nodes = nodes_[s];
    const std::size_t n = nodes.size(), first = at(nodes_.offset[at(s)]);
    std::array<double, 6> factor{};
    for (std::size_t a = 0; a < n; ++a) factor[a] = loaded_.factor_at(first + a, time);
    for (std::size_t q = 0; q < static_cast<std::size_t>(rule_.points); ++q) {
      Point p;
      p.weight = rule_.weight[q];
      p.N = rule_.N.data() + q * n;
      p.N_u = rule_.N_u.data() + q * n;
      p.N_v = rule_.N_v.data() + q * n;
      for (std::size_t a = 0; a < n; ++a) {
        if (loaded_.traction) p.traction += p.N[a] * (factor[a] * *loaded_.traction);
        p.pressure += p.N[a] * factor[a];
        p.u += p.N_u[a] * x[at(nodes[a])];
        p.v += p.N_v[a] * x[at(nodes[a])];
      }
      f(p);
    }
  }

  std::string name_;
  const FaceRule& rule_;
  LoadedFaces loaded_;
  bool couples_;
};

// Factors of the nodes of a mesh, from a field of it with one component; empty name: all 1.
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

}  // namespace

Result<LoadedFaces> loaded_faces(const Builder& builder, const BodyData& body,
                                 const std::vector<Index>& faces, const std::string& field,
                                 const std::string& profile) {
  auto factors = node_factors(body.mesh, field);
  if (!factors) return factors.failure();
  LoadedFaces loaded;
  loaded.faces = faces;
  loaded.per = static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type));
  for (const Index node : faces) loaded.factor.push_back(factors.value()[at(node - body.first_node)]);
  if (profile.empty()) return loaded;
  auto formula = Expression::parse(profile);
  if (!formula) return Error{"profile = " + mesh_files::quoted(profile) + ": " + formula.error()};
  loaded.profile = std::move(formula).value();
  for (const Index node : faces) {
    const Vec3& X = builder.rest()[at(node)];
    loaded.place.push_back(X);
    if (std::isfinite((*loaded.profile)(X, 0))) continue;
    return Error{"profile = " + mesh_files::quoted(profile) + " is no finite number at (" + number(X.x) +
                 ", " + number(X.y) + ", " + number(X.z) +
                 ") m and time 0; write it so that it has a value at every node"};
  }
  return loaded;
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
        t += rule.N[q * n + a] * (faces.factor_at(f * n + a, 0) * *faces.traction);
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

RestAreaForces::RestAreaForces(const LoadedFaces& faces, std::span<const Vec3> rest) {
  const FaceRule& rule = varying_face_rule(faces.per);
  const std::size_t n = faces.per;
  for (std::size_t f = 0; f < faces.count(); ++f) {
    const Index* nodes = faces.faces.data() + f * n;
    std::vector<double> area(n * n, 0.0);
    for (std::size_t q = 0; q < static_cast<std::size_t>(rule.points); ++q) {
      Vec3 u{}, v{};
      for (std::size_t a = 0; a < n; ++a) {
        u += rule.N_u[q * n + a] * rest[at(nodes[a])];
        v += rule.N_v[q * n + a] * rest[at(nodes[a])];
      }
      const double w = rule.weight[q] * norm(cross(u, v));
      for (std::size_t a = 0; a < n; ++a) {
        for (std::size_t b = 0; b < n; ++b) area[a * n + b] += w * rule.N[q * n + a] * rule.N[q * n + b];
      }
    }
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) shares.push_back({nodes[a], f * n + b, area[a * n + b]});
    }
  }
}

void add_varying_load(Builder& builder, const std::string& name, LoadedFaces faces, bool lagged,
                      const std::shared_ptr<const Amount>& amount) {
  // Where supports hold all of a face, nobody asks how its forces change.
  const bool free = std::any_of(faces.faces.begin(), faces.faces.end(),
                                [&](Index node) { return builder.given_directions(node) < 3; });
  auto pool = std::make_shared<VaryingLoadPool>(name, std::move(faces), free && !lagged);
  add_given(builder, name, std::move(pool), amount);
}

}  // namespace isochor
