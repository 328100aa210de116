#include "studies/modes.h"

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/system/assembly.h"
#include "engine/system/system.h"
#include "scenes/explain.h"

namespace isochor::studies {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double bulk = 1e4;  // over mu
constexpr int counted = 30;

struct Vibrations {
  Matrix stiffness;  // rows condensed, of free coordinates
  Vector mass;       // the same
  std::vector<Index> node;
  std::vector<int> axis;
};

Result<std::shared_ptr<const System>> bar(const Formulation& f, int nodes, bool held) {
  BodyDef body;
  BoxMeshDef box;
  const int n = f.quadratic() ? nodes / 2 : nodes;
  box.upper = {2, 1, 1};
  box.divisions = {2 * n, n, n};
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
  rows.stabilization = f.stabilization;
  rows.treatment = RowTreatment::saddle;
  std::vector<EffectPtr> effects{volume(rows)};
  DirichletDef ends;
  ends.where.surfaces = {"x0", "x1"};
  if (held) effects.push_back(dirichlet(ends));
  auto compiled = compile_parts({{std::move(body)}, effects}, held);
  if (!compiled) return compiled.failure();
  return compiled.value().system;
}

Result<Vibrations> vibrations(const std::shared_ptr<const System>& system, double stretch) {
  const System& shared = *system;
  const TbbParallel one(1);
  Assembly assembly(system, one);
  std::vector<Vec3> x = shared.parts().rest;
  const double lateral = stretch > 0 ? 1 / std::sqrt(stretch) : 1;
  if (stretch > 0) {
    for (Vec3& p : x) p = {stretch * p.x, lateral * p.y, lateral * p.z};
  }
  // mu (F - F^-T) + p J F^-T is zero on the sides for this p.
  const std::vector<double> lambda(at(shared.rows()), 1 - lateral * lateral);
  assembly.evaluate(Want::hessian, Definiteness::exact, x, lambda, {});
  std::vector<Vec3> force(x.size());
  assembly.residual(force);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (shared.basis_of()[i] < 0 && dot(force[i], force[i]) > 1e-20)
      return Error{"the state is not in balance"};
  }
  const SymmetricPattern& pattern = shared.kkt();
  std::vector<double> values(static_cast<std::size_t>(pattern.nonzeros()));
  assembly.kkt_values(0, values);
  const Index free = shared.free_unknowns(), rows = shared.rows();
  if (pattern.size != free + rows) return Error{"rows are not all in the matrix"};
  Matrix k = Matrix::Zero(free, free), g = Matrix::Zero(rows, free), c = Matrix::Zero(rows, rows);
  for (const ComplianceEntry& e : shared.compliance()) c(e.row, e.col) = c(e.col, e.row) = e.value;
  for (Index col = 0; col < pattern.size; ++col) {
    for (auto e = pattern.column_start[at(col)]; e < pattern.column_start[at(col) + 1]; ++e) {
      const Index row = pattern.row[static_cast<std::size_t>(e)];
      const double v = values[static_cast<std::size_t>(e)];
      if (row < free) {
        k(row, col) = k(col, row) = v;
      } else if (col < free) {
        g(row - free, col) = v;
      }
    }
  }
  Vibrations out;
  const Eigen::LDLT<Matrix> factored(c);
  out.stiffness = k + g.transpose() * factored.solve(g);
  for (Index i = 0; i < shared.nodes(); ++i) {
    for (int a = 0; a < 3 && shared.basis_of()[at(i)] < 0; ++a) {
      out.node.push_back(i);
      out.axis.push_back(a);
    }
  }
  if (static_cast<Index>(out.node.size()) != free) return Error{"supports hold some directions only"};
  out.mass.resize(free);
  for (Index u = 0; u < free; ++u) out.mass[u] = shared.parts().mass[at(out.node[at(u)])];
  return out;
}

// Neighbors: nodes half a cell of the coarsest mesh apart.
double roughness(const System& system, const Vibrations& v, const Vector& mode, double spacing) {
  std::vector<Vec3> shape(at(system.nodes()), Vec3{});
  for (std::size_t u = 0; u < v.node.size(); ++u)
    shape[at(v.node[u])][v.axis[u]] = mode[static_cast<Eigen::Index>(u)];
  const auto& rest = system.parts().rest;
  double differs = 0, size = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    Vec3 mean{};
    int count = 0;
    for (std::size_t j = 0; j < shape.size(); ++j) {
      const Vec3 d = rest[i] - rest[j];
      if (i == j || dot(d, d) > 1.0001 * spacing * spacing) continue;
      mean += shape[j];
      ++count;
    }
    if (count == 0) continue;
    const Vec3 d = shape[i] - (1.0 / count) * mean;
    differs += dot(d, d);
    size += dot(shape[i], shape[i]);
  }
  return std::sqrt(differs / size);
}

}  // namespace

Probe modes_probe(const Formulation& f, int nodes, double stretch) {
  return [&f, nodes, stretch](const SceneDef&, int) -> Result<Numbers> {
    auto made = bar(f, nodes, stretch > 0);
    if (!made) return made.failure();
    const std::shared_ptr<const System> system = made.value();
    auto found = vibrations(system, stretch);
    if (!found) return found.failure();
    const Vibrations& v = found.value();
    const Vector scale = v.mass.cwiseSqrt().cwiseInverse();
    const Matrix scaled = scale.asDiagonal() * v.stiffness * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scaled);
    if (eigen.info() != Eigen::Success) return Error{"the eigenvalues did not converge"};
    Numbers out{{"zero modes", 0}, {"unstable", 0}, {"rough", 0}};
    int k = 0;
    const double zero = 1e-9 * eigen.eigenvalues().maxCoeff() / bulk;
    for (Eigen::Index e = 0; e < eigen.eigenvalues().size() && k < counted; ++e) {
      const double value = eigen.eigenvalues()[e];
      if (std::abs(value) < zero) {
        ++out["zero modes"];
        continue;
      }
      if (value < 0) {
        ++out["unstable"];
        continue;
      }
      out["f" + std::to_string(++k)] = std::sqrt(value);
      const Vector mode = scale.asDiagonal() * eigen.eigenvectors().col(e);
      out["rough"] = std::max(out["rough"], roughness(*system, v, mode, 1.0 / nodes));
    }
    return out;
  };
}

}  // namespace isochor::studies
