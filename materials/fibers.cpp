// psi_f = k1/(2 k2) (exp(k2 E^2) - 1) [Pa] for E = F H : F - 1 > 0, else 0, added to a material of any kind
// (Holzapfel, Gasser & Ogden 2000; with dispersion Gasser, Ogden & Holzapfel 2006). H = d 1 + (1 - 3 d) a a^T
// has unit trace; F H : F is the mean squared stretch of the fibers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "engine/base/text.h"
#include "engine/elements/material_model.h"
#include "isochor/materials.h"

namespace isochor {

namespace {

// Structure tensor, packed 00, 11, 22, 01, 02, 12.
using Structure = std::array<double, 6>;

Structure structure(const Vec3& a, double dispersion) {
  const double n = dot(a, a), k = (1 - 3 * dispersion) / n;
  return {dispersion + k * a.x * a.x,
          dispersion + k * a.y * a.y,
          dispersion + k * a.z * a.z,
          k * a.x * a.y,
          k * a.x * a.z,
          k * a.y * a.z};
}

struct Family {
  double k1 = 0, k2 = 0;
  std::vector<Structure> H;  // one for all, or one an element
  const Structure& at_element(Index e) const { return H[H.size() == 1 ? 0 : at(e)]; }
};

struct FiberResponse {
  double psi, first, second;  // and its derivatives in E
};

FiberResponse respond(const Family& f, double E) {
  if (!(E > 0)) return {0, 0, 0};
  const double x = f.k2 * E * E;
  if (x > 690) return {std::numeric_limits<double>::infinity(), 0, 0};  // beyond the range of numbers
  const double growth = std::exp(x);
  const double psi = f.k2 > 0 ? f.k1 / (2 * f.k2) * std::expm1(x) : 0.5 * f.k1 * E * E;
  return {psi, f.k1 * E * growth, f.k1 * (1 + 2 * x) * growth};
}

class FiberMaterial final : public Material {
 public:
  FiberMaterial(std::string_view name, std::shared_ptr<const Material> matrix, std::vector<Family> families)
      : name_(name), matrix_(std::move(matrix)), families_(std::move(families)) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_, matrix_, families_); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    matrix_->evaluate(want, points, r);
    add(want, points, r);
    if (want == Want::hessian) add_hessian(points, r);
  }
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    matrix_->spectrum(points, svd, out);
  }
  // Fibers only pull, and the more the longer: their Hessian is positive semidefinite as it is.
  void add_anisotropic(Definiteness policy, const PointBatch& points, ResponseBatch& r) const override {
    matrix_->add_anisotropic(policy, points, r);
    add_hessian(points, r);
  }

  std::shared_ptr<const Material> gathered(const Lists& cells,
                                           std::span<const double> weight) const override {
    auto matrix = matrix_->gathered(cells, weight);
    std::vector<Family> families = families_;
    bool field = matrix != nullptr;
    for (Family& f : families) {
      if (f.H.size() == 1) continue;
      field = true;
      std::vector<Structure> mean(at(cells.count()), Structure{});
      for (Index s = 0; s < cells.count(); ++s) {
        for (Index k = cells.offset[at(s)]; k < cells.offset[at(s) + 1]; ++k) {
          for (std::size_t i = 0; i < 6; ++i) mean[at(s)][i] += weight[at(k)] * f.H[at(cells.item[at(k)])][i];
        }
      }
      f.H = std::move(mean);
    }
    if (!field) return nullptr;
    return std::make_shared<FiberMaterial>(name_, matrix ? matrix : matrix_, std::move(families));
  }

 private:
  // FH and E = (F^T F - 1) : H of one lane: H has unit trace, and E is exactly zero at rest.
  static double strain(const Structure& H, const PointBatch& points, int l, double FH[9]) {
    const double h[9] = {H[0], H[3], H[4], H[3], H[1], H[5], H[4], H[5], H[2]};
    double E = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        FH[3 * i + j] =
            points.F[3 * i][l] * h[j] + points.F[3 * i + 1][l] * h[3 + j] + points.F[3 * i + 2][l] * h[6 + j];
        const double C = points.F[i][l] * points.F[j][l] + points.F[3 + i][l] * points.F[3 + j][l] +
                         points.F[6 + i][l] * points.F[6 + j][l];
        E += h[3 * i + j] * (C - (i == j ? 1.0 : 0.0));
      }
    }
    return E;
  }

  void add(Want want, const PointBatch& points, ResponseBatch& r) const {
    for (const Family& f : families_) {
      for (int l = 0; l < kLanes; ++l) {
        double FH[9];
        const FiberResponse e = respond(f, strain(f.at_element(points.element[l]), points, l, FH));
        r.psi[l] += e.psi;
        if (want == Want::value) continue;
        for (int i = 0; i < 9; ++i) r.P[i][l] += 2 * e.first * FH[i];
      }
    }
  }

  void add_hessian(const PointBatch& points, ResponseBatch& r) const {
    for (const Family& f : families_) {
      for (int l = 0; l < kLanes; ++l) {
        const Structure& H = f.at_element(points.element[l]);
        double FH[9];
        const FiberResponse e = respond(f, strain(H, points, l, FH));
        if (e.first == 0) continue;
        const double h[9] = {H[0], H[3], H[4], H[3], H[1], H[5], H[4], H[5], H[2]};
        int k = 0;
        for (int i = 0; i < 9; ++i) {
          for (int j = 0; j <= i; ++j, ++k) {
            r.A[k][l] += 4 * e.second * FH[i] * FH[j];
            if (i / 3 == j / 3) r.A[k][l] += 2 * e.first * h[3 * (i % 3) + j % 3];
          }
        }
      }
    }
  }

  std::string_view name_;
  std::shared_ptr<const Material> matrix_;
  std::vector<Family> families_;
};

class FiberModel final : public MaterialModel {
 public:
  FiberModel(MaterialPtr matrix, std::vector<Family> families, std::size_t cells)
      : matrix_(std::move(matrix)),
        name_(std::string(matrix_->name()).append(" with fibers")),
        families_(std::move(families)),
        cells_(cells) {}
  std::string_view name() const override { return name_; }
  std::shared_ptr<const Material> distortional() const override {
    return std::make_shared<FiberMaterial>(name_, matrix_->distortional(), families_);
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    auto complete = matrix_->complete();
    if (!complete) return complete;
    return std::shared_ptr<const Material>(
        std::make_shared<FiberMaterial>(name_, complete.value(), families_));
  }
  double shear_modulus() const override { return matrix_->shear_modulus(); }
  double inverse_bulk() const override { return matrix_->inverse_bulk(); }
  double poisson() const override { return matrix_->poisson(); }
  double young() const override { return matrix_->young(); }
  bool defined_inverted() const override { return matrix_->defined_inverted(); }
  std::size_t field_cells() const override { return cells_ > 0 ? cells_ : matrix_->field_cells(); }
  double stiffness_factor(Index cell) const override { return matrix_->stiffness_factor(cell); }
  double inverse_bulk_of(Index cell) const override { return matrix_->inverse_bulk_of(cell); }
  double poisson_of(Index cell) const override { return matrix_->poisson_of(cell); }

 private:
  MaterialPtr matrix_;
  std::string name_;
  std::vector<Family> families_;
  std::size_t cells_;  // of direction fields; 0: none
};

std::string text(const Vec3& v) {
  char buffer[100];
  std::snprintf(buffer, sizeof buffer, "(%g, %g, %g)", v.x, v.y, v.z);
  return buffer;
}

Result<void> check_direction(const std::string& who, const Vec3& a) {
  const double n = dot(a, a);
  if (n > 0 && std::isfinite(n)) return {};
  return Error{who + " = " + text(a) + " has no direction; give three numbers that are not all zero"};
}

Result<void> check(const std::string& who, const FiberFamily& f) {
  if (!(f.k1 > 0) || !std::isfinite(f.k1)) {
    return Error{who + "k1 = " + number(f.k1) + " Pa; the stiffness of fibers must be positive"};
  }
  if (!(f.k2 >= 0) || !std::isfinite(f.k2)) {
    return Error{who + "k2 = " + number(f.k2) + "; it must be zero (no stiffening) or positive"};
  }
  if (!(f.dispersion >= 0) || !(f.dispersion <= 1.0 / 3)) {
    return Error{who + "dispersion = " + number(f.dispersion) +
                 "; it must lie between 0 (all fibers parallel) and 1/3 (no direction at all)"};
  }
  if (f.directions.empty()) return check_direction(who + "direction", f.direction);
  for (std::size_t c = 0; c < f.directions.size(); ++c) {
    if (auto r = check_direction(who + "directions[" + std::to_string(c) + "]", f.directions[c]); !r)
      return r;
  }
  return {};
}

}  // namespace

Result<MaterialPtr> with_fibers(MaterialPtr matrix, const std::vector<FiberFamily>& families) {
  if (!matrix) return Error{"fibers: the material that holds them is empty"};
  if (families.empty()) return Error{"fibers: there is no family; give one or use the material as it is"};
  std::vector<Family> list;
  std::size_t cells = matrix->field_cells();
  for (std::size_t i = 0; i < families.size(); ++i) {
    const FiberFamily& f = families[i];
    const std::string who = "fibers[" + std::to_string(i) + "]: ";
    if (auto r = check(who, f); !r) return Error{r.error()};
    Family family{f.k1, f.k2, {}};
    for (const Vec3& a : f.directions) family.H.push_back(structure(a, f.dispersion));
    if (f.directions.empty()) family.H.push_back(structure(f.direction, f.dispersion));
    if (f.directions.size() == 1) family.H.push_back(family.H[0]);  // a field, of a mesh of one cell
    if (!f.directions.empty()) {
      if (cells > 0 && cells != f.directions.size()) {
        return Error{who + "directions has " + std::to_string(f.directions.size()) +
                     " entries, another field of the material " + std::to_string(cells) +
                     "; fields have one entry a cell of the body's mesh"};
      }
      cells = f.directions.size();
    }
    list.push_back(std::move(family));
  }
  return MaterialPtr(std::make_shared<FiberModel>(std::move(matrix), std::move(list), cells));
}

}  // namespace isochor
