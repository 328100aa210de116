// Fibers that only pull, added to a material of any kind. Their energy is a function of E = H : C - 1 with
// the structure tensor H = d 1 + (1 - 3 d) a a^T of unit trace, so that H : C is the mean squared stretch of
// the fibers, or of E = J^(-2/3) H : C - 1.
//   exponential: k1/(b k2) (exp(k2 E^b) - 1) (Holzapfel, Gasser & Ogden 2000 with b = 2; with dispersion
//                Gasser, Ogden & Holzapfel 2006);
//   toe:         by the stretch s = sqrt(1 + E), see FiberLaw (Weiss, Maker & Govindjee 1996).
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/elements/fiber_law.h"
#include "engine/elements/material_model.h"
#include "isochor/materials.h"
#include "materials/wrapped_model.h"

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
  FiberLaw law = FiberLaw::exponential;
  double exponent = 2;
  bool isochoric = false;
  double straight_modulus = 0, straight_stretch = 0;
  std::vector<Structure> H;  // one for all, or one an element
  const Structure& at_element(Index e) const { return H[H.size() == 1 ? 0 : at(e)]; }
};

// E and what its derivatives at the F of one lane are made of. The arrays are filled where they are asked
// for: d and g by isochoric families only.
struct FiberStrain {
  double E = 0;
  double J = 1, a = 1, q = 1;  // of isochoric families: J, J^(-2/3), H : C
  double FH[9], h[9];
  double d[9];  // dE/dF
  double g[9];  // dJ/dF
};

class FiberMaterial final : public Material {
 public:
  FiberMaterial(std::string_view name, std::shared_ptr<const Material> matrix, std::vector<Family> families)
      : name_(name), matrix_(std::move(matrix)), families_(std::move(families)) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_, matrix_, families_); }
  bool remembers() const override { return matrix_->remembers(); }
  void keep(const PointBatch& points, double* kept) const override { matrix_->keep(points, kept); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    matrix_->evaluate(want, points, r);
    add(want, points, r);
    if (want == Want::hessian) add_hessian(Definiteness::exact, points, r);
  }
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    matrix_->spectrum(points, svd, out);
  }
  void add_anisotropic(Definiteness policy, const PointBatch& points, ResponseBatch& r) const override {
    matrix_->add_anisotropic(policy, points, r);
    add_hessian(policy, points, r);
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
  static FiberStrain strain(const Family& family, const PointBatch& points, int l) {
    FiberStrain e;
    const Structure& H = family.at_element(points.element[l]);
    const double h[9] = {H[0], H[3], H[4], H[3], H[1], H[5], H[4], H[5], H[2]};
    std::copy_n(h, 9, e.h);
    // By C - 1: H has unit trace, and E is exactly zero at rest.
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        e.FH[3 * i + j] =
            points.F[3 * i][l] * h[j] + points.F[3 * i + 1][l] * h[3 + j] + points.F[3 * i + 2][l] * h[6 + j];
        const double C = points.F[i][l] * points.F[j][l] + points.F[3 + i][l] * points.F[3 + j][l] +
                         points.F[6 + i][l] * points.F[6 + j][l];
        e.E += h[3 * i + j] * (C - (i == j ? 1.0 : 0.0));
      }
    }
    if (!family.isochoric) return e;
    for (int i = 0; i < 9; ++i) {
      const int row = i / 3, col = i % 3, r1 = 3 * ((row + 1) % 3), r2 = 3 * ((row + 2) % 3);
      const int c1 = (col + 1) % 3, c2 = (col + 2) % 3;
      e.g[i] = points.F[r1 + c1][l] * points.F[r2 + c2][l] - points.F[r1 + c2][l] * points.F[r2 + c1][l];
    }
    e.J = points.F[0][l] * e.g[0] + points.F[1][l] * e.g[1] + points.F[2][l] * e.g[2];
    const double root = std::cbrt(e.J);
    e.a = 1 / (root * root);
    e.q = 1 + e.E;
    e.E = e.a * e.E + (e.a - 1);
    for (int i = 0; i < 9; ++i) e.d[i] = e.a * (2 * e.FH[i] - 2 * e.q / (3 * e.J) * e.g[i]);
    return e;
  }

  void add(Want want, const PointBatch& points, ResponseBatch& r) const {
    for (const Family& f : families_) {
      for (int l = 0; l < kLanes; ++l) {
        const FiberStrain strain_of_lane = strain(f, points, l);
        const FiberResponse e = strain_of_lane.J > 0 ? respond(f, strain_of_lane.E) : kNoFiber;
        r.psi[l] += e.psi;
        if (want == Want::value) continue;
        if (f.isochoric) {
          for (int i = 0; i < 9; ++i) r.P[i][l] += e.first * strain_of_lane.d[i];
        } else {
          for (int i = 0; i < 9; ++i) r.P[i][l] += 2 * e.first * strain_of_lane.FH[i];
        }
      }
    }
  }

  // f'' dE dE^T + f' d2E of one lane, lower triangle packed.
  static void hessian(const Family& f, const FiberStrain& s, const FiberResponse& e, const PointBatch& points,
                      int l, double A[45]) {
    int k = 0;
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j <= i; ++j, ++k) {
        double second = i / 3 == j / 3 ? 2 * s.h[3 * (i % 3) + j % 3] : 0.0;
        if (f.isochoric) {
          second -= 4 / (3 * s.J) * (s.FH[i] * s.g[j] + s.g[i] * s.FH[j]);
          second += 10 * s.q / (9 * s.J * s.J) * s.g[i] * s.g[j];
          const int row = i / 3, col = i % 3, row2 = j / 3, col2 = j % 3;
          if (row != row2 && col != col2) {
            const bool even = ((row + 1) % 3 == row2) == ((col + 1) % 3 == col2);
            const double F = points.F[3 * (3 - row - row2) + (3 - col - col2)][l];
            second -= 2 * s.q / (3 * s.J) * (even ? F : -F);
          }
          second *= s.a;
        }
        const double di = f.isochoric ? s.d[i] : 2 * s.FH[i], dj = f.isochoric ? s.d[j] : 2 * s.FH[j];
        A[k] = e.second * di * dj + e.first * second;
      }
    }
  }

  // Of the whole F: semidefinite as it is where f'' >= 0.
  static void add_full(const FiberStrain& s, const FiberResponse& e, int l, ResponseBatch& r) {
    int k = 0;
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j <= i; ++j, ++k) {
        r.A[k][l] += 4 * e.second * s.FH[i] * s.FH[j];
        if (i / 3 == j / 3) r.A[k][l] += 2 * e.first * s.h[3 * (i % 3) + j % 3];
      }
    }
  }

  static void make_definite(Definiteness policy, double A[45]) {
    Eigen::Matrix<double, 9, 9> full;
    for (int i = 0, k = 0; i < 9; ++i) {
      for (int j = 0; j <= i; ++j, ++k) full(i, j) = full(j, i) = A[k];
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(full);
    Eigen::Matrix<double, 9, 1> values = eigen.eigenvalues();
    for (double& v : values) v = v < 0 ? (policy == Definiteness::absolute ? -v : 0) : v;
    full = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
    for (int i = 0, k = 0; i < 9; ++i) {
      for (int j = 0; j <= i; ++j, ++k) A[k] = full(i, j);
    }
  }

  void add_hessian(Definiteness policy, const PointBatch& points, ResponseBatch& r) const {
    for (const Family& f : families_) {
      for (int l = 0; l < kLanes; ++l) {
        const FiberStrain s = strain(f, points, l);
        if (!(s.J > 0)) continue;
        const FiberResponse e = respond(f, s.E);
        if (e.first == 0) continue;
        if (!f.isochoric && (policy == Definiteness::exact || e.second >= 0)) {
          add_full(s, e, l, r);
          continue;
        }
        double A[45];
        hessian(f, s, e, points, l, A);
        if (policy != Definiteness::exact) make_definite(policy, A);
        for (int k = 0; k < 45; ++k) r.A[k][l] += A[k];
      }
    }
  }

  std::string_view name_;
  std::shared_ptr<const Material> matrix_;
  std::vector<Family> families_;
};

class FiberModel final : public WrappedModel {
 public:
  FiberModel(MaterialPtr matrix, std::vector<Family> families, std::size_t cells)
      : WrappedModel(std::move(matrix)),
        name_(std::string(base().name()).append(" with fibers")),
        families_(std::move(families)),
        cells_(cells) {}
  std::string_view name() const override { return name_; }
  std::shared_ptr<const Material> distortional() const override {
    return std::make_shared<FiberMaterial>(name_, base().distortional(), families_);
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    auto complete = base().complete();
    if (!complete) return complete;
    return std::shared_ptr<const Material>(
        std::make_shared<FiberMaterial>(name_, complete.value(), families_));
  }
  bool defined_inverted() const override {
    return base().defined_inverted() &&
           std::none_of(families_.begin(), families_.end(), [](const Family& f) { return f.isochoric; });
  }
  std::size_t field_cells() const override { return cells_ > 0 ? cells_ : base().field_cells(); }

 private:
  std::string name_;
  std::vector<Family> families_;
  std::size_t cells_;  // of direction fields; 0: none
};

}  // namespace

Result<MaterialPtr> with_fibers(MaterialPtr matrix, const std::vector<FiberFamily>& families) {
  if (!matrix) return Error{"fibers: the material that holds them is empty"};
  if (families.empty()) return Error{"fibers: there is no family; give one or use the material as it is"};
  std::vector<Family> list;
  std::size_t cells = matrix->field_cells();
  for (std::size_t i = 0; i < families.size(); ++i) {
    const FiberFamily& f = families[i];
    const std::string who = "fibers[" + std::to_string(i) + "]: ";
    if (auto r = check_fibers(who, f); !r) return r.failure();
    Family family{f.k1, f.k2, f.law, f.exponent, f.isochoric, f.straight_modulus, f.straight_stretch, {}};
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
