// Where the error of an output comes from: the error of the strain in each cell, found by recovery
// (Zienkiewicz & Zhu 1992), times that of the field that says how far the output feels it (Prudhomme & Oden
// 1999).
#include <algorithm>
#include <cmath>

#include "engine/base/out_of_memory.h"
#include "engine/step/time_scheme.h"
#include "engine/world/gradient_parts.h"
#include "engine/world/node_fit.h"

namespace isochor {

namespace {

using Gradient = Eigen::Matrix<double, 9, 1>;

// Of every cell of a region the root of the integral of |F* - F|^2, F being the gradient of displacements and
// F* the field that is fitted to those around each node. In cells with one point F* is looked at in the
// corners, elsewhere in the points.
void add_strain_errors(const BodyData& body, const RegionData& region, const SolidPool& pool,
                       std::span<const Vec3> x, std::span<const Vec3> rest, std::vector<double>& error,
                       double& strain) {
  const ReferenceElement& element = *body.reference;
  const auto points = at(pool.data().points), nodes = static_cast<std::size_t>(element.nodes);
  const auto gradient = [&](Index s, std::size_t q) {
    Gradient F;
    double volume_strain = 0;
    pool.deformation_gradient(s, static_cast<int>(q), x, rest, F.data(), volume_strain);
    for (int k = 0; k < 3; ++k) F(4 * k) -= 1;
    return F;
  };
  const auto weight = [&](Index s, std::size_t q) { return pool.data().weight[at(s) * points + q]; };
  NodeFit<9> fit(rest.subspan(at(body.first_node), body.mesh.nodes.size()));
  for (Index s = 0; s < pool.stencils(); ++s) {
    const auto of_cell = pool.nodes()[s];
    for (std::size_t q = 0; q < points; ++q) {
      Vec3 place{};
      for (std::size_t a = 0; a < nodes; ++a) place += element.shape[q * nodes + a] * rest[at(of_cell[a])];
      for (const Index n : of_cell) fit.add(n - body.first_node, place, weight(s, q), gradient(s, q));
    }
  }
  std::vector<Gradient> fitted;
  for (Index n = 0; n < body.mesh.node_count(); ++n) fitted.push_back(fit.value(n));
  for (Index s = 0; s < pool.stencils(); ++s) {
    const auto of_cell = pool.nodes()[s];
    double sum = 0;
    for (std::size_t q = 0; q < points; ++q) {
      const Gradient F = gradient(s, q);
      strain += weight(s, q) * F.squaredNorm();
      Gradient mean = Gradient::Zero();
      for (std::size_t a = 0; a < nodes; ++a) {
        const Gradient& at_node = fitted[at(of_cell[a] - body.first_node)];
        mean += element.shape[q * nodes + a] * at_node;
        if (points == 1) sum += weight(s, q) / static_cast<double>(nodes) * (at_node - F).squaredNorm();
      }
      if (points > 1) sum += weight(s, q) * (mean - F).squaredNorm();
    }
    error[at(region.cells[at(s)])] = std::sqrt(sum);
  }
}

// Errors below this part of the gradient of displacements, and of 1, are rounding: of the fit, and of
// positions.
constexpr double kRounding = 1e-9, kRoundingOfPlaces = 1e-14;

std::vector<double> strain_errors(const BodyData& body, std::span<const Vec3> x, std::span<const Vec3> rest) {
  std::vector<double> error(at(body.mesh.cell_count()));
  double strain = 0, volume = 0;
  for (const RegionData& region : body.regions) {
    auto data = solid_data(*body.reference, rest, body.global_cells, region.cells, VolumeFunctions::none);
    if (!data) continue;
    const SolidPool pool("", std::make_shared<const SolidData>(std::move(data).value()), nullptr,
                         VolumeStrain::linear);
    add_strain_errors(body, region, pool, x, rest, error, strain);
    for (Index s = 0; s < pool.stencils(); ++s) volume += pool.volume(s);
  }
  double sum = 0;
  for (const double e : error) sum += e * e;
  if (!(sum > kRounding * kRounding * strain + kRoundingOfPlaces * kRoundingOfPlaces * volume))
    std::fill(error.begin(), error.end(), 0.0);
  return error;
}

// Stiffness, error of the strain and weight of every cell, as parts of their sum.
ErrorOrigin shares(const std::vector<BodyData>& bodies, const std::vector<std::vector<double>>& strain,
                   const std::vector<std::vector<double>>& weight) {
  ErrorOrigin out;
  double total = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    std::vector<double> cells(strain[b].size());
    for (const RegionData& region : bodies[b].regions) {
      for (const Index c : region.cells) {
        cells[at(c)] = region.material->shear_modulus() * strain[b][at(c)] * weight[b][at(c)];
        total += cells[at(c)];
      }
    }
    out.cells.push_back(std::move(cells));
  }
  for (auto& cells : out.cells) {
    for (double& share : cells) share = total > 0 && std::isfinite(total) ? share / total : 0;
  }
  return out;
}

}  // namespace

Result<std::vector<ErrorOrigin>> World::error_origins(std::span<const Output> outputs) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r.failure();
  const std::vector<BodyData>& bodies = w.said.builder.bodies();
  const std::span<const Vec3> rest = w.system().parts().rest;
  const auto errors_of = [&](std::span<const Vec3> x) {
    std::vector<std::vector<double>> all;
    for (const BodyData& body : bodies)
      all.push_back(body.present() ? strain_errors(body, x, rest) : std::vector<double>{});
    return all;
  };
  const auto strain = errors_of(w.state.x);
  std::vector<ErrorOrigin> out;
  const auto unweighted = [&](const std::string& why) {
    out.push_back(shares(bodies, strain, strain));
    out.back().note = why;
  };
  if (outputs.empty()) unweighted("");
  // Why no output has a field that says how far it feels what.
  std::string why;
  Impl::Equilibrium eq(w);
  for (const Output& o : outputs) {
    if (names_effect(o)) {
      if (auto r = check(o.effect); !r) return r.failure();
    }
    if (auto r = eq.watch(o); !r) return r.failure();
  }
  if (w.settled)
    why = "the state is unfinished";
  else if (w.options.scheme->has_inertia())
    why = "in dynamics there is no equilibrium to follow it through";
  else if (w.system().has_lag())
    why = "with friction, or a pressure on faces with a free rim, the matrix is unsymmetric";
  else if (auto r = outputs.empty() ? Result<void>() : eq.linearize(true); !r)
    why = r.error();
  for (const Output& output : outputs) {
    if (!why.empty()) {
      unweighted(why);
      continue;
    }
    auto seed = eq.seed_of(output);
    if (!seed) return seed.failure();
    auto adjoint = eq.adjoint_of(seed.value());
    if (!adjoint) {
      unweighted(adjoint.error());
      continue;
    }
    // The adjoint is a displacement: its gradient is that of where it would carry the body.
    std::vector<Vec3> carried(rest.begin(), rest.end());
    double most = 0;
    for (const Vec3& v : adjoint.value().force) most = std::max(most, norm(v));
    const double scale = most > 0 ? w.system().length() / most : 0;
    for (std::size_t i = 0; i < carried.size(); ++i) carried[i] += scale * adjoint.value().force[i];
    out.push_back(shares(bodies, strain, errors_of(carried)));
    out.back().by_output = true;
  }
  return out;
} catch (const std::bad_alloc&) {
  impl_->methods.drop();
  return no_memory("error_origins");
}

}  // namespace isochor
