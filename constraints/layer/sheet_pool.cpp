#include "constraints/layer/sheet_pool.h"

#include <algorithm>

#include "engine/base/text.h"

namespace isochor {

namespace {

double det(const std::array<double, 3>& U) {
  return U[0] * U[1] - U[2] * U[2];
}

// How strains of the sheet follow those of the body: e_sheet = T e + offset, in the order (11, 22, 2 12).
struct StrainMap {
  double T[3][3], offset[3];
  explicit StrainMap(const std::array<double, 3>& U) {
    const double a = U[0], b = U[1], c = U[2];
    const double rows[3][3] = {
        {a * a, c * c, a * c}, {c * c, b * b, b * c}, {2 * a * c, 2 * b * c, a * b + c * c}};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) T[i][j] = rows[i][j];
    // (U U - 1)/2; (a - 1)(a + 1) keeps the digits of small prestretches.
    offset[0] = 0.5 * ((a - 1) * (a + 1) + c * c);
    offset[1] = 0.5 * ((b - 1) * (b + 1) + c * c);
    offset[2] = c * (a + b);
  }
};

}  // namespace

Result<void> check_sheet(const Prestretch& prestretch, const Curve& amount,
                         const std::vector<FiberFamily>& fibers) {
  for (const auto& [what, stretch] : {std::pair("along", prestretch.along), {"across", prestretch.across}}) {
    if (!(stretch > 0) || !std::isfinite(stretch)) {
      return Error{std::string("prestretch.") + what + " = " + number(stretch) +
                   "; a stretch is positive, and 1 where there is none"};
    }
    for (const auto& p : amount.points) {
      if (1 + p[1] * (stretch - 1) > 0) continue;
      return Error{"at amount " + number(p[1]) + " the prestretch " + what + " is " +
                   number(1 + p[1] * (stretch - 1)) + "; 1 + amount (stretch - 1) must stay positive"};
    }
  }
  if (!(dot(prestretch.direction, prestretch.direction) > 0) || !finite(prestretch.direction))
    return Error{"prestretch.direction has no direction; give three numbers that are not all zero"};
  for (std::size_t k = 0; k < fibers.size(); ++k) {
    const std::string who = "fibers[" + std::to_string(k) + "]: ";
    if (auto r = check_fibers(who, fibers[k]); !r) return r;
    if (fibers[k].dispersion == 0 && !fibers[k].isochoric) continue;
    return Error{who +
                 "dispersion and isochoric strains are of solids; a sheet has fibers in its plane, whose "
                 "stretch is its own"};
  }
  return {};
}

SheetPool::SheetPool(const std::string& name, std::size_t nodes_per_face, std::span<const Index> faces,
                     std::span<const Vec3> rest, const Sheet& sheet)
    : MembranePool(name, nodes_per_face, faces, rest, sheet.mu * sheet.thickness, sheet.poisson),
      sheet_(sheet) {
  const std::size_t count = at(stencils()) * points();
  for (std::size_t k = 0; k < count && sheet_.prestretched(); ++k) {
    // Alike in all directions: any will do.
    const bool alike = sheet_.prestretch.along == sheet_.prestretch.across;
    stretched_.push_back(alike ? InPlane{1, 0} : in_plane(k, sheet_.prestretch.direction, "prestretch"));
  }
  for (const FiberFamily& f : sheet_.fibers) {
    std::vector<InPlane>& all = fibers_.emplace_back();
    for (std::size_t k = 0; k < count; ++k)
      all.push_back(in_plane(k, f.directions.empty() ? f.direction : f.directions[k / points()], "fibers"));
  }
}

SheetPool::InPlane SheetPool::in_plane(std::size_t point, const Vec3& along, const std::string& of) {
  const Vec3 d = isochor::direction(along);
  const double u = dot(d, frame(point).t1), v = dot(d, frame(point).t2), n = std::sqrt(u * u + v * v);
  if (n > 1e-6) return {u / n, v / n};
  undirected_ = of;
  return {1, 0};
}

std::array<double, 3> SheetPool::prestretch_at(std::size_t point, double t) const {
  if (stretched_.empty()) return {1, 1, 0};
  const double a = sheet_.amount->value(t);
  const double p = 1 + a * (sheet_.prestretch.along - 1), q = 1 + a * (sheet_.prestretch.across - 1);
  const auto& [c, s] = stretched_[point];
  return {p * c * c + q * s * s, p * s * s + q * c * c, (p - q) * c * s};
}

PlaneResponse SheetPool::plane(std::size_t point, const PlaneStrain& e, double t, bool hessian) const {
  const std::array<double, 3> U = prestretch_at(point, t);
  PlaneResponse outside;
  outside.value = std::numeric_limits<double>::infinity();
  if (!(det(U) > 0) || !(U[0] > 0)) return outside;
  const StrainMap map(U);
  PlaneStrain own;
  own.e11 = map.T[0][0] * e.e11 + map.T[0][1] * e.e22 + map.T[0][2] * e.g + map.offset[0];
  own.e22 = map.T[1][0] * e.e11 + map.T[1][1] * e.e22 + map.T[1][2] * e.g + map.offset[1];
  own.g = map.T[2][0] * e.e11 + map.T[2][1] * e.e22 + map.T[2][2] * e.g + map.offset[2];
  const PlaneResponse w = isotropic(own, hessian);
  const double share = 1 / det(U);
  PlaneResponse r;
  r.value = share * w.value;
  if (!std::isfinite(r.value)) return outside;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) r.S[i] += share * map.T[k][i] * w.S[k];
    for (std::size_t j = 0; hessian && j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t l = 0; l < 3; ++l) r.D[i][j] += share * map.T[k][i] * w.D[k][l] * map.T[l][j];
      }
    }
  }
  add_fibers(point, e, U, share * sheet_.thickness, hessian, r);
  return std::isfinite(r.value) ? r : outside;
}

// The forces and the stiffness of a point, by the chain rule from (e11, e22, 2 e12) to the positions of the
// nodes.
void SheetPool::add_point(const StencilSlots& slots, Index face, std::size_t point, const PlaneStrain& e,
                          const PlaneResponse& w, std::span<Vec3> slope, bool hessian) const {
  const std::size_t n = slope.size();
  const Slope* B = slopes(point, n);
  const double weight = frame(point).weight;
  std::array<std::array<Vec3, 3>, 6> by_node;
  for (std::size_t a = 0; a < n; ++a) {
    by_node[a] = {B[a].u * e.f1, B[a].v * e.f2, B[a].u * e.f2 + B[a].v * e.f1};
    for (std::size_t i = 0; i < 3; ++i) slope[a] += (weight * w.S[i]) * by_node[a][i];
  }
  Mat3* block = hessian ? slots.hessian.data() + hessian_offset()[at(face)] : nullptr;
  for (std::size_t a = 0; hessian && a < n; ++a) {
    for (std::size_t b = 0; b <= a; ++b, ++block) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
          add_outer(*block, weight * w.D[i][j], by_node[a][i], by_node[b][j]);
      }
      const double initial =
          B[a].u * (w.S[0] * B[b].u + w.S[2] * B[b].v) + B[a].v * (w.S[2] * B[b].u + w.S[1] * B[b].v);
      for (int i = 0; i < 3; ++i) (*block)(i, i) += weight * initial;
    }
  }
}

void SheetPool::evaluate(const StencilRequest& request, const StencilSlots& slots) const {
  const bool hessian = request.want == Want::hessian;
  for (Index f = request.begin; f < request.end; ++f) {
    const std::size_t n = nodes_[f].size(), first = at(nodes_.offset[at(f)]);
    Mat3* blocks = hessian ? slots.hessian.data() + hessian_offset()[at(f)] : nullptr;
    if (blocks) std::fill_n(blocks, n * (n + 1) / 2, Mat3{});
    std::array<Vec3, 6> slope{};
    double value = 0;
    for (std::size_t p = 0; p < points(); ++p) {
      const std::size_t point = at(f) * points() + p;
      const PlaneStrain e = strain(f, p, request.x, request.rest);
      const PlaneResponse w = plane(point, e, request.increment.t1, hessian);
      value += frame(point).weight * w.value;
      if (request.want != Want::value && std::isfinite(w.value))
        add_point(slots, f, point, e, w, std::span(slope).first(n), hessian);
    }
    slots.energy[at(f)] = value;
    for (std::size_t a = 0; request.want != Want::value && a < n; ++a) slots.gradient[first + a] = slope[a];
    if (blocks && request.definiteness != Definiteness::exact) raise_negative_eigenvalues(n, blocks);
  }
}

void SheetPool::add_fibers(std::size_t point, const PlaneStrain& e, const std::array<double, 3>& U,
                           double thickness, bool hessian, PlaneResponse& r) const {
  for (std::size_t f = 0; f < fibers_.size(); ++f) {
    const auto& [u, v] = fibers_[f][point];
    const double x = (U[1] * u - U[2] * v) / det(U), y = (U[0] * v - U[2] * u) / det(U);
    // Exactly at rest where nothing is stretched there.
    const double own = stretched_.empty() ? 1 : x * x + y * y;
    // Strains first, which keep the digits of what is nearly at rest.
    const double C = u * u * e.e11 + v * v * e.e22 + u * v * e.g;
    const FiberResponse w = isochor::respond(sheet_.fibers[f], (2 * C + (1 - own)) / own);
    r.value += thickness * w.psi;
    const double by_e[3] = {2 * u * u / own, 2 * v * v / own, 2 * u * v / own};
    for (std::size_t i = 0; i < 3; ++i) {
      r.S[i] += thickness * w.first * by_e[i];
      for (std::size_t j = 0; hessian && j < 3; ++j) r.D[i][j] += thickness * w.second * by_e[i] * by_e[j];
    }
  }
}

std::shared_ptr<const MembranePool> make_sheet(const std::string& name, std::size_t nodes_per_face,
                                               std::span<const Index> faces, std::span<const Vec3> rest,
                                               const Sheet& sheet, std::string& undirected) {
  undirected.clear();
  if (!sheet.prestretched() && sheet.fibers.empty()) {
    return std::make_shared<MembranePool>(name, nodes_per_face, faces, rest, sheet.mu * sheet.thickness,
                                          sheet.poisson);
  }
  auto pool = std::make_shared<SheetPool>(name, nodes_per_face, faces, rest, sheet);
  undirected = pool->undirected();
  return pool;
}

}  // namespace isochor
