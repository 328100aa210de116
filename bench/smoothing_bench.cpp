// Which smoothing of linear tets is worth having: patches around nodes, edges or faces, against none. Linear
// elasticity at nu = 0.5 with stabilized nodal volume rows, a slender cantilever under its weight.
//
//   isochor_bench_smoothing [--divisions 2]
//
// For each flavor: the tip against beam theory (Timoshenko), non-zeros of the stiffness, and the least energy
// that any deformation keeps of its unsmoothed one (a spurious mode keeps none). Answers only, no seconds.
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include "engine/elements/reference_element.h"
#include "isochor/generate.h"
#include "options.h"

namespace {

using namespace isochor;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kMu = 1, kStabilization = 1;

struct Tets {
  Mesh mesh;
  SolidData data;
};

Tets beam(int divisions, double length) {
  Tets t;
  auto mesh = box_mesh({{0, 0, 0},
                        {length, 1, 1},
                        {static_cast<int>(length) * divisions, divisions, divisions},
                        CellType::tet4});
  if (!mesh) std::exit(2);
  t.mesh = std::move(mesh).value();
  std::vector<Index> cells(at(t.mesh.cell_count()));
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<Index>(c);
  auto data = solid_data(tet4_element(), t.mesh.nodes, t.mesh.cells, cells, VolumeFunctions::constant);
  if (!data) std::exit(2);
  t.data = std::move(data).value();
  return t;
}

// Sum over patches of V mu |sym grad - 1/3 tr|^2, the gradient the mean over the patch: every tet gives each
// of its parts (1 for the tet, 4 nodes or faces, 6 edges) the same share.
Matrix stiffness(const Tets& t, int part_nodes) {
  const auto n = 3 * t.mesh.node_count();
  std::map<std::vector<Index>, std::vector<Index>> patches;
  for (Index c = 0; c < t.mesh.cell_count(); ++c) {
    const auto nodes = t.data.nodes[c];
    for (int mask = 1; mask < 16; ++mask) {
      std::vector<Index> part;
      for (std::size_t a = 0; a < 4; ++a) {
        if (mask >> a & 1) part.push_back(nodes[a]);
      }
      if (static_cast<int>(part.size()) != part_nodes) continue;
      std::sort(part.begin(), part.end());
      patches[part].push_back(c);
    }
  }
  const double parts = part_nodes == 4 ? 1 : part_nodes == 2 ? 6 : 4;
  Matrix K = Matrix::Zero(n, n);
  for (const auto& [part, cells] : patches) {
    double volume = 0;
    std::map<Index, Vec3> gradient;
    for (const Index c : cells) {
      const double share = t.data.weight[at(c)] / parts;
      volume += share;
      for (std::size_t a = 0; a < 4; ++a) {
        gradient[t.data.nodes[c][a]] += share * t.data.gradient[4 * at(c) + a];
      }
    }
    for (const auto& [i, gi] : gradient) {
      for (const auto& [j, gj] : gradient) {
        const double w = kMu / volume, d = dot(gi, gj);
        for (int p = 0; p < 3; ++p) {
          for (int q = 0; q < 3; ++q)
            K(3 * i + p, 3 * j + q) += w * ((p == q ? d : 0) + gi[q] * gj[p] - 2.0 / 3 * gi[p] * gj[q]);
        }
      }
    }
  }
  return K;
}

// Nodal rows (v_e - V_e)/4 and the compliance of their stabilization.
void rows(const Tets& t, Matrix& G, Matrix& C) {
  const auto n = t.mesh.node_count();
  G = Matrix::Zero(n, 3 * n);
  C = Matrix::Zero(n, n);
  for (Index c = 0; c < t.mesh.cell_count(); ++c) {
    const double V = t.data.weight[at(c)];
    for (std::size_t k = 0; k < 4; ++k) {
      const Index row = t.data.nodes[c][k];
      for (std::size_t a = 0; a < 4; ++a) {
        const Vec3& g = t.data.gradient[4 * at(c) + a];
        for (int p = 0; p < 3; ++p) G(row, 3 * t.data.nodes[c][a] + p) += V / 4 * g[p];
        C(row, t.data.nodes[c][a]) += kStabilization / kMu * (V / 20 * (a == k ? 2 : 1) - V / 16);
      }
    }
  }
}

// Largest downward displacement of the end under unit weight, the other end clamped.
double tip(const Tets& t, const Matrix& K, double length) {
  const auto n = t.mesh.node_count();
  Matrix G, C;
  rows(t, G, C);
  std::vector<Index> free;
  for (Index i = 0; i < n; ++i) {
    for (int p = 0; p < 3; ++p) {
      if (t.mesh.nodes[at(i)].x > 1e-9) free.push_back(3 * i + p);
    }
  }
  const auto f = static_cast<Index>(free.size());
  Matrix A = Matrix::Zero(f + n, f + n);
  Vector b = Vector::Zero(f + n);
  Vector weight = Vector::Zero(n);
  for (Index c = 0; c < t.mesh.cell_count(); ++c) {
    for (const Index i : t.data.nodes[c]) weight(i) += t.data.weight[at(c)] / 4;
  }
  for (Index i = 0; i < f; ++i) {
    for (Index j = 0; j < f; ++j) A(i, j) = K(free[at(i)], free[at(j)]);
    for (Index r = 0; r < n; ++r) A(i, f + r) = A(f + r, i) = G(r, free[at(i)]);
    if (free[at(i)] % 3 == 1) b(i) = -weight(free[at(i)] / 3);
  }
  A.bottomRightCorner(n, n) = -C;
  const Vector u = A.partialPivLu().solve(b);
  double sum = 0, count = 0;
  for (Index i = 0; i < f; ++i) {
    if (free[at(i)] % 3 != 1 || t.mesh.nodes[at(free[at(i)] / 3)].x < length - 1e-9) continue;
    sum += u(i);
    count += 1;
  }
  return sum / count;
}

// Least and number of vanishing energies against the unsmoothed, over all deformations.
void spectrum(const Matrix& smoothed, const Matrix& plain, double& least, int& vanishing) {
  Eigen::SelfAdjointEigenSolver<Matrix> eigen(plain);
  const Vector& d = eigen.eigenvalues();
  // All but the motions that cost nothing unsmoothed (six rigid ones and those of the deviator).
  Index first = 0;
  while (d(first) < 1e-9 * d(d.size() - 1)) ++first;
  const auto m = d.size() - first;
  Matrix basis = eigen.eigenvectors().rightCols(m);
  for (Index k = 0; k < m; ++k) basis.col(k) /= std::sqrt(d(first + k));
  const Vector ratio =
      Eigen::SelfAdjointEigenSolver<Matrix>(basis.transpose() * smoothed * basis, Eigen::EigenvaluesOnly)
          .eigenvalues();
  least = std::max(0.0, ratio(0));
  vanishing = static_cast<int>((ratio.array() < 1e-9).count());
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {}, {"--divisions"});
  int divisions = 2;
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], "--divisions") == 0) divisions = std::max(1, std::atoi(argv[i + 1]));
  }
  const double length = 10;
  const Tets slender = beam(divisions, length), stout = beam(divisions + 1, 2);
  // E = 3 mu, unit weight, I = 1/12, shear area 5/6: q L^4 / 8EI + q L^2 / 2GA.
  const double beam_theory =
      -(std::pow(length, 4) / (8 * 3 * kMu / 12) + length * length / (2 * kMu * 5 / 6));
  std::printf("Cantilever 1 x 1 x %g of %d tets, %d unknowns, nu = 0.5\n", length, slender.mesh.cell_count(),
              4 * slender.mesh.node_count());
  std::printf("%-16s %10s %14s %14s %16s\n", "smoothing", "tip", "non-zeros of K", "least energy",
              "spurious modes");
  const Matrix plain = stiffness(stout, 4);
  for (const auto& [name, part] : {std::pair("none", 4), {"faces", 3}, {"edges", 2}, {"nodes", 1}}) {
    const Matrix K = stiffness(slender, part);
    const auto blocks = (K.array() != 0).count();
    double least = 0;
    int vanishing = 0;
    spectrum(stiffness(stout, part), plain, least, vanishing);
    std::printf("%-16s %+9.1f%% %14ld %14.3f %16d\n", name, 100 * (tip(slender, K, length) / beam_theory - 1),
                static_cast<long>(blocks), least, vanishing);
  }
  return 0;
}
