// Random saddle points for the parts that solve them: stencils over neighboring nodes with positive definite
// energies and linear functions, nodes that are given in some directions, and rows of every treatment.
#pragma once

#include <Eigen/Core>
#include <random>

#include "engine/system/assembly.h"

namespace test {

// Four nodes each, one energy and two functions.
class RandomStencils final : public isochor::StencilPool {
 public:
  RandomStencils(isochor::Index nodes, std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    for (isochor::Index first = 0; first + 4 <= nodes; ++first) {
      std::array<isochor::Index, 4> of{};
      for (std::size_t a = 0; a < 4; ++a) of[a] = first + static_cast<isochor::Index>(a);
      nodes_.push(of);
      const Eigen::MatrixXd a =
          Eigen::MatrixXd::NullaryExpr(12, 12, [&](Eigen::Index) { return unit(random); });
      hessian_.push_back(a * a.transpose() + Eigen::MatrixXd::Identity(12, 12));
      for (int k = 0; k < 8; ++k) function_.push_back({unit(random), unit(random), unit(random)});
    }
    finish_topology();
  }
  std::string_view name() const override { return "random"; }
  isochor::StencilShape shape() const override {
    isochor::StencilShape s;
    s.energy = true;
    s.functions = 2;
    return s;
  }
  bool sees_rigid_motion() const override { return true; }
  void evaluate(const isochor::StencilRequest& q, const isochor::StencilSlots& slots) const override {
    using isochor::at;
    for (isochor::Index s = q.begin; s < q.end; ++s) {
      const Eigen::MatrixXd& h = hessian_[at(s)];
      const std::size_t first = at(nodes_.offset[at(s)]);
      auto block = static_cast<std::size_t>(hessian_offset()[at(s)]);
      Eigen::Matrix<double, 12, 1> x;
      for (int c = 0; c < 12; ++c) x(c) = q.x[at(nodes_[s][static_cast<std::size_t>(c / 3)])][c % 3];
      slots.energy[at(s)] = 0.5 * x.dot(h * x);
      for (std::size_t k = 0; k < 2; ++k) {
        double& value = slots.value[2 * at(s) + k] = 0;
        for (std::size_t a = 0; a < 4; ++a) value += dot(gradient(s, k, a), q.x[at(nodes_[s][a])]);
      }
      if (q.want == isochor::Want::value) continue;
      for (std::size_t a = 0; a < 4; ++a) {
        isochor::Vec3& g = slots.gradient[first + a] = {};
        for (int c = 0; c < 3; ++c) g[c] = h.row(3 * static_cast<Eigen::Index>(a) + c).dot(x);
        for (std::size_t k = 0; k < 2; ++k) {
          g += q.function_multiplier[2 * at(s) + k] * gradient(s, k, a);
          slots.jacobian[2 * first + 4 * k + a] = gradient(s, k, a);
        }
        for (std::size_t b = 0; q.want == isochor::Want::hessian && b <= a; ++b, ++block) {
          for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) {
              slots.hessian[block](r, c) =
                  h(3 * static_cast<Eigen::Index>(a) + r, 3 * static_cast<Eigen::Index>(b) + c);
            }
          }
        }
      }
    }
  }

 private:
  const isochor::Vec3& gradient(isochor::Index s, std::size_t k, std::size_t a) const {
    return function_[8 * isochor::at(s) + 4 * k + a];
  }
  std::vector<Eigen::MatrixXd> hessian_;
  std::vector<isochor::Vec3> function_;
};

enum class Compliance { none, diagonal, coupled };

struct RandomRows {
  isochor::RowTreatment treatment = isochor::RowTreatment::saddle;
  isochor::Index rows = 5;
  Compliance compliance = Compliance::diagonal;
  bool wide = false;     // over all stencils instead of two
  bool bounded = false;  // may be held at a bound
  double softness = 1;   // its compliance, times this
};

class RandomRowPool final : public isochor::RowPool {
 public:
  RandomRowPool(const RandomRows& def, isochor::Index stencils, std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    stencil_pool = 0;
    treatment = def.treatment;
    for (isochor::Index r = 0; r < def.rows; ++r) {
      std::vector<isochor::Index> functions;
      for (isochor::Index s = 0; s < stencils; ++s) {
        if (def.wide || s == (3 * r) % stencils || s == (3 * r + 1) % stencils)
          functions.push_back(2 * s + r % 2);
      }
      map.push(functions);
      for (std::size_t k = 0; k < functions.size(); ++k) weight.push_back(unit(random));
      metric.push_back(0.5 + 0.4 * unit(random));
      measure.push_back(1);
      if (def.compliance != Compliance::none)
        compliance.push_back({r, r, def.softness * (0.3 + 0.1 * unit(random))});
      if (def.compliance == Compliance::coupled && r > 0)
        compliance.push_back({r, r - 1, def.softness * (0.1 * unit(random))});
    }
    if (def.bounded) lower.assign(isochor::at(def.rows), 0);
  }
  std::string_view name() const override { return "random"; }
};

class GivenNodes final : public isochor::Prescriber {
 public:
  explicit GivenNodes(std::vector<isochor::PrescribedNode> of) { nodes = std::move(of); }
  std::string_view name() const override { return "given"; }
  void target(double, std::span<isochor::Vec3> position) const override {
    for (isochor::Vec3& p : position) p = {};
  }
};

// Nodes 0 to 2 are given in one, two and three directions.
inline isochor::Result<std::shared_ptr<const isochor::System>> random_system(
    unsigned seed, const std::vector<RandomRows>& rows, isochor::Index nodes = 14) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  isochor::SystemParts parts;
  for (isochor::Index i = 0; i < nodes; ++i) {
    parts.rest.push_back({unit(random), unit(random), unit(random)});
    parts.mass.push_back(1 + 0.5 * unit(random));
  }
  auto stencils = std::make_shared<RandomStencils>(nodes, random);
  for (const RandomRows& def : rows)
    parts.row_pools.push_back(std::make_shared<RandomRowPool>(def, stencils->stencils(), random));
  parts.stencil_pools.push_back(std::move(stencils));
  const isochor::Vec3 slanted{0.6, 0, 0.8}, across{0, 1, 0}, third{-0.8, 0, 0.6};
  parts.prescribers.push_back(std::make_shared<GivenNodes>(std::vector<isochor::PrescribedNode>{
      {0, 1, {slanted}}, {1, 2, {slanted, across}}, {2, 3, {slanted, across, third}}}));
  auto system = isochor::System::compile(std::move(parts));
  if (!system) return isochor::Error{system.error()};
  return std::shared_ptr<const isochor::System>(std::move(system).value());
}

// [K + mass_scale M, G^T; G, -C] from products with the assembly, in free directions, then all compliant
// rows; a row that is held leaves it, with minus its metric as its diagonal.
inline Eigen::MatrixXd dense_saddle(isochor::Assembly& assembly, double mass_scale,
                                    std::span<const std::uint8_t> held) {
  using isochor::at;
  const isochor::System& s = assembly.system();
  const Eigen::Index n = s.free_unknowns(), m = s.rows();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n + m, n + m);
  std::vector<isochor::Vec3> v(at(s.nodes())), y(v.size());
  std::vector<double> g(at(s.rows()));
  for (isochor::Index j = 0; j < s.nodes(); ++j) {
    for (isochor::Index c = 0; c < s.unknowns().of(j); ++c) {
      std::fill(v.begin(), v.end(), isochor::Vec3{});
      isochor::Vec3 unit{};
      unit[c] = 1;
      v[at(j)] = s.unknowns().from_free(j, unit);
      assembly.hessian_times(v, y);
      assembly.jacobian_times(v, g);
      const Eigen::Index column = s.unknowns().begin(j) + c;
      for (isochor::Index i = 0; i < s.nodes(); ++i) {
        const isochor::Vec3 q =
            s.unknowns().to_free(i, y[at(i)] + mass_scale * s.parts().mass[at(i)] * v[at(i)]);
        for (isochor::Index r = 0; r < s.unknowns().of(i); ++r) a(s.unknowns().begin(i) + r, column) = q[r];
      }
      for (Eigen::Index r = 0; r < m; ++r)
        a(n + r, column) = a(column, n + r) = g[static_cast<std::size_t>(r)];
    }
  }
  for (const isochor::ComplianceEntry& e : s.compliance()) {
    a(n + e.row, n + e.col) -= e.value;
    if (e.row != e.col) a(n + e.col, n + e.row) -= e.value;
  }
  for (isochor::Index r = 0; r < s.rows(); ++r) {
    if (held.empty() || !held[at(r)]) continue;
    a.row(n + r).setZero();
    a.col(n + r).setZero();
    a(n + r, n + r) = -s.row_metric()[at(r)];
  }
  return a;
}

}  // namespace test
