#include "studies/pressure_tests.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "engine/base/parallel.h"
#include "engine/mesh/cell_shape.h"
#include "engine/system/assembly.h"
#include "engine/system/system.h"
#include "scenes/explain.h"

namespace isochor::studies {

namespace {

using Matrix = Eigen::MatrixXd;

// The saddle-point matrix of a cube at rest, mu = 1, cut into its blocks.
struct Blocks {
  Matrix stiffness, rows, compliance;  // K, G, C
};

Result<Blocks> blocks(const Formulation& f, int n, double bulk, double stabilization) {
  BodyDef body;
  BoxMeshDef box;
  box.divisions = {n, n, n};
  if (f.hexahedra()) box.cell_type = CellType::hex8;
  auto mesh = box_mesh(box);
  if (!mesh) return mesh.failure();
  body.mesh = std::move(mesh).value();
  body.element = f.element;
  ElasticConstants constants;
  constants.mu = 1;
  constants.bulk = bulk;
  auto material = neo_hookean(constants);
  if (!material) return material.failure();
  body.materials = {{"", std::move(material).value(), 1}};
  VolumeDef rows;
  rows.space = f.space;
  rows.stabilization = stabilization;
  DirichletDef wall;
  wall.where.surfaces = {"x0"};
  auto compiled = compile_parts({{std::move(body)}, {volume(rows), dirichlet(wall)}}, true);
  if (!compiled) return compiled.failure();
  const auto system = compiled.value().system;

  const TbbParallel one(1);
  Assembly assembly(system, one);
  const std::vector<double> lambda(static_cast<std::size_t>(system->rows()), 0.0);
  const std::vector<double> prescribed(static_cast<std::size_t>(system->prescribed_rows()), 0.0);
  assembly.evaluate(Want::hessian, Definiteness::exact, system->parts().rest, lambda, prescribed);
  const SymmetricPattern& pattern = system->kkt();
  std::vector<double> values(static_cast<std::size_t>(pattern.nonzeros()));
  assembly.kkt_values(0, values);
  const Index free = system->free_unknowns(), all = pattern.size;
  // Compliant rows may have been condensed into the stiffness; hard ones cannot be.
  if (std::isinf(bulk) && all - free != system->rows()) return Error{"hard rows are not in the matrix"};
  Blocks b{Matrix::Zero(free, free), Matrix::Zero(all - free, free),
           Matrix::Zero(system->rows(), system->rows())};
  for (const ComplianceEntry& e : system->compliance())
    b.compliance(e.row, e.col) = b.compliance(e.col, e.row) = e.value;
  for (Index c = 0; c < all; ++c) {
    for (std::int64_t k = pattern.column_start[static_cast<std::size_t>(c)];
         k < pattern.column_start[static_cast<std::size_t>(c) + 1]; ++k) {
      const Index r = pattern.row[static_cast<std::size_t>(k)];
      const double v = values[static_cast<std::size_t>(k)];
      if (r < free) {
        b.stiffness(r, c) = b.stiffness(c, r) = v;
      } else if (c < free) {
        b.rows(r - free, c) = v;
      }
    }
  }
  return b;
}

// Neighbors across faces: for every inner face the two cells that share it.
std::vector<std::array<std::size_t, 2>> inner_faces(const Mesh& mesh) {
  const CellShape& shape = cell_shape(mesh.cell_type);
  const auto stride = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  std::map<std::array<Index, 4>, std::size_t> open;
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t c = 0; c * stride < mesh.cells.size(); ++c) {
    for (std::size_t side = 0; side < shape.sides; ++side) {
      std::array<Index, 4> nodes{-1, -1, -1, -1};
      for (std::size_t k = 0; k < shape.side_corners; ++k)
        nodes[k] = mesh.cells[c * stride + shape.side[side][k]];
      std::sort(nodes.begin(), nodes.end());
      const auto [it, first] = open.emplace(nodes, c);
      if (!first) pairs.push_back({it->second, c});
    }
  }
  return pairs;
}

}  // namespace

Probe inf_sup_probe(const Formulation& f, int n) {
  return [&f, n](const SceneDef&, int) -> Result<Numbers> {
    // C = M_p / kappa without stabilization gives the mass matrix of the pressures; hard rows give the rest.
    auto mass = blocks(f, n, 1, 0);
    if (!mass) return mass.failure();
    auto hard = blocks(f, n, std::numeric_limits<double>::infinity(), f.stabilization);
    if (!hard) return hard.failure();
    const Blocks& h = hard.value();
    const Eigen::LLT<Matrix> cholesky(h.stiffness);
    if (cholesky.info() != Eigen::Success) return Error{"the stiffness at rest is not positive definite"};
    const Matrix half = cholesky.matrixL().solve(h.rows.transpose());
    const Matrix schur = half.transpose() * half + h.compliance;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> eigen(schur, mass.value().compliance,
                                                                 Eigen::EigenvaluesOnly);
    if (eigen.info() != Eigen::Success) return Error{"the eigenvalues did not converge"};
    Numbers out;
    const auto beta = [](double v) { return std::sqrt(std::max(0.0, v)); };
    double zero = 0;
    for (Eigen::Index k = 0; k < eigen.eigenvalues().size(); ++k) zero += beta(eigen.eigenvalues()[k]) < 1e-6;
    out["beta"] = zero > 0 ? 0 : beta(eigen.eigenvalues()[0]);
    out["zero modes"] = zero;
    out["rows"] = static_cast<double>(h.rows.rows());
    out["displacements"] = static_cast<double>(h.rows.cols());
    return out;
  };
}

namespace {

// S of hard nodal rows, scaled from both sides with the diagonal of M_p / mu, mu = 1.
Result<Matrix> scaled_schur(double stabilization, int n) {
  const Formulation& f = formulation("tet4_node");
  auto mass = blocks(f, n, 1, 0);
  if (!mass) return mass.failure();
  auto hard = blocks(f, n, std::numeric_limits<double>::infinity(), stabilization);
  if (!hard) return hard.failure();
  const Blocks& h = hard.value();
  const Eigen::LLT<Matrix> cholesky(h.stiffness);
  if (cholesky.info() != Eigen::Success) return Error{"the stiffness at rest is not positive definite"};
  const Matrix half = cholesky.matrixL().solve(h.rows.transpose());
  const Eigen::VectorXd scale = mass.value().compliance.diagonal().cwiseSqrt().cwiseInverse();
  return Matrix(scale.asDiagonal() * (half.transpose() * half + h.compliance) * scale.asDiagonal());
}

int conjugate_gradients(const Matrix& S, int most) {
  Eigen::VectorXd b(S.rows());
  std::uint32_t random = 1;
  for (auto& v : b) {
    random = 1664525u * random + 1013904223u;
    v = static_cast<double>(random) / 4294967296.0 - 0.5;
  }
  Eigen::VectorXd r = b, p = b;
  double rr = r.squaredNorm();
  for (int k = 1; k <= most; ++k) {
    const Eigen::VectorXd q = S * p;
    const double step = rr / p.dot(q);
    r -= step * q;
    const double next = r.squaredNorm();
    if (next <= 1e-18 * b.squaredNorm()) return k;
    p = r + next / rr * p;
    rr = next;
  }
  return most;
}

}  // namespace

Probe dual_probe(double stabilization, int n) {
  return [stabilization, n](const SceneDef&, int) -> Result<Numbers> {
    auto schur = scaled_schur(stabilization, n);
    if (!schur) return schur.failure();
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(schur.value(), Eigen::EigenvaluesOnly);
    if (eigen.info() != Eigen::Success) return Error{"the eigenvalues did not converge"};
    const double least = eigen.eigenvalues().minCoeff(), largest = eigen.eigenvalues().maxCoeff();
    // Zero to rounding: a spurious pressure mode.
    const bool singular = least < 1e-12 * largest;
    Numbers out{{"least", singular ? 0 : least},
                {"largest", largest},
                {"rows", static_cast<double>(schur.value().rows())},
                {"iterations", conjugate_gradients(schur.value(), 1000)}};
    if (!singular) out["condition"] = largest / least;
    return out;
  };
}

Result<Numbers> pressure_roughness(const SceneDef& scene, int threads) {
  auto built = build(scene, {threads});
  if (!built) return built.failure();
  World& world = built.value().world;
  const StepPlan plan = plan_steps(scene.analysis);
  for (int step = 0; step < plan.steps; ++step) {
    const StepReport report = world.advance(plan.h);
    if (report.status != StepStatus::converged) return Error{report.reason};
  }
  const BodyId body = built.value().bodies[0];
  const std::vector<double> pressure = world.fields(body).cell_pressure;
  double jumps = 0, magnitude = 0;
  const auto faces = inner_faces(world.mesh(body));
  for (const auto& [a, b] : faces) {
    const double mean = 0.5 * (pressure[a] + pressure[b]), jump = pressure[a] - pressure[b];
    jumps += jump * jump;
    magnitude += mean * mean + 0.25 * jump * jump;
  }
  return Numbers{{"roughness", std::sqrt(jumps / std::max(magnitude, 1e-300))}};
}

}  // namespace isochor::studies
