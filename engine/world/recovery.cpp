#include "engine/world/recovery.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/mesh/cell_shape.h"
#include "engine/world/node_fit.h"
#include "engine/world/recovery_points.h"

namespace isochor {

namespace {

using Matrix = StressMatrix;

struct CellState {
  Matrix stress = Matrix::Zero();
  double J = 0, volume = 0, pressure = 0, stretch = 0;
};

// Stress of the energy, in the order xx yy zz xy yz zx, and pressure of the rows.
using Fit = NodeFit<7>;

Fit::Values sample(const Matrix& s, double pressure) {
  Fit::Values v;
  v << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0), pressure;
  return v;
}

// Stress of each patch, then the mean over the six edges of every tet. The ends of an edge get what its patch
// has, at the middle of the patch.
void add_patch_stress(const RecoveryInput& in, const RegionData& region, std::vector<CellState>& cells,
                      Fit& nodes) {
  const auto& pool = static_cast<const SolidPool&>(*in.parts.stencil_pools[at(region.elastic_pool)]);
  const auto& energy = region.energy;
  const Growth* growth = pool.growth();
  const double amount = growth ? growth->amount->at(in.t) : 0;
  struct Patch {
    Vec3 moment{};  // volume times centroid
    double volume = 0, row_pressure = 0;
    Matrix stress = Matrix::Zero();
  };
  // Patches come in the order of their edges: both ends are nodes of all their tets.
  std::map<std::pair<Index, Index>, Patch> patches;
  const auto each_edge = [&](Index c, auto&& visit) {
    const Index* n = in.body.global_cells.data() + 4 * at(c);
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) visit(std::minmax({n[i], n[j]}));
    }
  };
  for (const Index c : region.cells) {
    const Index* n = in.body.global_cells.data() + 4 * at(c);
    Vec3 centroid{};
    for (int a = 0; a < 4; ++a) centroid += 0.25 * in.parts.rest[at(n[a])];
    const double share = cells[at(c)].volume / 6;
    each_edge(c, [&](const std::pair<Index, Index>& edge) {
      Patch& p = patches[edge];
      p.volume += share;
      p.moment += share * centroid;
      p.row_pressure += share * cells[at(c)].pressure;
    });
  }
  Index stencil = 0;
  for (auto& [edge, p] : patches) {
    const GrownState grown = growth ? growth->at(stencil, amount) : GrownState{};
    const PointState point = point_state(pool, energy.get(), stencil, stencil, 0, in,
                                         growth ? &grown : nullptr, kept_of(in, region, stencil, 0));
    p.stress = point.stress;
    if (!region.memory_pools.empty()) p.stress += memory_stress(in, region, stencil, 0, point);
    ++stencil;
    for (const Index end : {edge.first, edge.second}) {
      nodes.add(end - in.body.first_node, (1 / p.volume) * p.moment, p.volume,
                sample(p.stress, p.row_pressure / p.volume));
    }
  }
  for (const Index c : region.cells) {
    each_edge(c,
              [&](const std::pair<Index, Index>& edge) { cells[at(c)].stress += patches[edge].stress / 6; });
  }
}

void add_region(const RecoveryInput& in, const RegionData& region, std::vector<CellState>& cells,
                Fit& nodes) {
  const ReferenceElement& element = *in.body.reference;
  auto data = solid_data(element, in.parts.rest, in.body.global_cells, region.cells, VolumeFunctions::none);
  if (!data) return;
  const SolidPool pool("", std::make_shared<const SolidData>(std::move(data).value()), nullptr,
                       VolumeStrain::linear);
  const bool smoothed = in.body.element == Element::tet4_edge_smoothed;
  const auto energy = smoothed ? nullptr : region.energy;
  const Growth* growth = region.growth.get();
  const double amount = growth ? growth->amount->at(in.t) : 0;
  for (Index s = 0; s < pool.stencils(); ++s) {
    CellState& cell = cells[at(region.cells[at(s)])];
    const double volume = pool.volume(s);
    const auto of_cell = pool.nodes()[s];
    const GrownState state = growth ? growth->at(region.cells[at(s)], amount) : GrownState{};
    const GrownState* grown = growth ? &state : nullptr;
    for (int q = 0; q < pool.data().points; ++q) {
      PointState p = point_state(pool, energy.get(), s, s, q, in, grown, kept_of(in, region, s, q));
      if (!smoothed && !region.memory_pools.empty()) p.stress += memory_stress(in, region, s, q, p);
      const double w = p.weight / volume;
      const double pressure = row_pressure(in, region, s, q, p.elastic_J, grown);
      cell.stress += w * p.stress;
      cell.J += w * p.J;
      cell.pressure += w * pressure;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(Eigen::Matrix3d(p.F.transpose() * p.F),
                                                                 Eigen::EigenvaluesOnly);
      cell.stretch = std::max(cell.stretch, std::sqrt(std::max(0.0, eigen.eigenvalues()(2))));
      if (smoothed) continue;
      Vec3 point{};
      for (std::size_t a = 0; a < of_cell.size(); ++a)
        point +=
            element.shape[static_cast<std::size_t>(q) * of_cell.size() + a] * in.parts.rest[at(of_cell[a])];
      for (const Index n : of_cell)
        nodes.add(n - in.body.first_node, point, p.weight, sample(p.stress, pressure));
    }
    cell.volume = volume;
  }
  if (smoothed) add_patch_stress(in, region, cells, nodes);
}

// Pressure multipliers that live at nodes, by node of the body; NaN where there is none.
std::vector<double> pressure_at_nodes(const RecoveryInput& in) {
  const Mesh& mesh = in.body.mesh;
  std::vector<double> multiplier(mesh.nodes.size());
  for (std::size_t i = 0; i < multiplier.size(); ++i)
    multiplier[i] = in.node_multiplier[at(in.body.first_node) + i];
  // Mid-edge nodes of a Tet10 take the linear pressure of their edge.
  if (mesh.cell_type == CellType::tet10) {
    for (std::size_t c = 0; c < mesh.cells.size(); c += 10) {
      for (std::size_t e = 0; e < 6; ++e) {
        const auto a = at(mesh.cells[c + kTetShape.edge[e][0]]), b = at(mesh.cells[c + kTetShape.edge[e][1]]);
        multiplier[at(mesh.cells[c + 4 + e])] = 0.5 * (multiplier[a] + multiplier[b]);
      }
    }
  }
  return multiplier;
}

// Fitted in each region by itself, as stresses jump between materials; where regions meet, their mean by
// volume.
void recover_nodes(const RecoveryInput& in, std::vector<CellState>& cells, BodyFields& out) {
  const std::size_t n = in.body.mesh.nodes.size();
  std::vector<Fit::Values> sum(n, Fit::Values::Zero());
  std::vector<double> volume(n, 0);
  for (const RegionData& region : in.body.regions) {
    Fit fit(std::span(in.parts.rest).subspan(at(in.body.first_node), n));
    add_region(in, region, cells, fit);
    for (std::size_t i = 0; i < n; ++i) {
      const double v = fit.volume(static_cast<Index>(i));
      if (v > 0) sum[i] += v * fit.value(static_cast<Index>(i));
      volume[i] += v;
    }
  }
  const std::vector<double> multiplier = pressure_at_nodes(in);
  for (std::size_t i = 0; i < n; ++i) {
    Fit::Values v = sum[i] / (volume[i] > 0 ? volume[i] : 1);
    const double rows = std::isnan(multiplier[i]) ? v(6) : multiplier[i];
    for (int k = 0; k < 3; ++k) v(k) += rows;
    out.node_stress.insert(out.node_stress.end(), v.data(), v.data() + 6);
    out.node_pressure.push_back((v(0) + v(1) + v(2)) / 3);
  }
}

}  // namespace

BodyFields recover_fields(const RecoveryInput& in) {
  std::vector<CellState> cells(at(in.body.mesh.cell_count()));
  // Of thin bodies positions alone are known here.
  if (in.body.thin())
    for (CellState& cell : cells) cell.J = cell.stretch = 1;
  BodyFields f;
  recover_nodes(in, cells, f);
  for (const CellState& cell : cells) {
    Matrix sigma = cell.stress + cell.pressure * Matrix::Identity();
    const double mean = sigma.trace() / 3;
    const Matrix deviator = sigma - mean * Matrix::Identity();
    f.cell_J.push_back(cell.J);
    f.cell_pressure.push_back(mean);
    f.cell_von_mises.push_back(std::sqrt(1.5 * deviator.squaredNorm()));
    f.cell_max_stretch.push_back(cell.stretch);
    f.cell_stress.insert(f.cell_stress.end(),
                         {sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)});
  }
  return f;
}

BodyMeasures measure_body(const BodyData& body, const SystemParts& parts, std::span<const Vec3> x) {
  BodyMeasures m;
  if (body.thin()) m.min_J = m.max_J = 1;
  const auto extend = [](VolumeMeasures& all, double volume, double rest, double low, double high) {
    const bool first = all.rest_volume == 0;
    all.volume += volume;
    all.rest_volume += rest;
    all.min_J = first ? low : std::min(all.min_J, low);
    all.max_J = first ? high : std::max(all.max_J, high);
  };
  for (const RegionData& region : body.regions) {
    auto data =
        solid_data(*body.reference, parts.rest, body.global_cells, region.cells, VolumeFunctions::none);
    if (!data) continue;
    const SolidPool pool("", std::make_shared<const SolidData>(std::move(data).value()), nullptr,
                         VolumeStrain::linear);
    VolumeMeasures part;
    part.name = region.name;
    for (Index s = 0; s < pool.stencils(); ++s) {
      for (int q = 0; q < pool.data().points; ++q) {
        double F[9], strain = 0;
        pool.deformation_gradient(s, q, x, parts.rest, F, strain);
        const double w = pool.data().weight[at(s * pool.data().points + q)];
        extend(part, w * (1 + strain), w, 1 + strain, 1 + strain);
      }
    }
    if (part.rest_volume > 0) extend(m, part.volume, part.rest_volume, part.min_J, part.max_J);
    m.regions.push_back(std::move(part));
  }
  return m;
}

}  // namespace isochor
