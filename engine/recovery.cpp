#include "engine/recovery.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

namespace isochor {

namespace {

using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

struct PointState {
  Matrix F = Matrix::Identity();
  double J = 1, weight = 0;
  Matrix stress = Matrix::Zero();  // Cauchy, of the energy alone
};

PointState point_state(const SolidPool& pool, const Material* energy, Index stencil, int q,
                       std::span<const Vec3> x, std::span<const Vec3> rest) {
  PointState p;
  double F[9], strain = 0;
  pool.deformation_gradient(stencil, q, x, rest, F, strain);
  p.F = Eigen::Map<const Matrix>(F);
  p.J = 1 + strain;
  p.weight = pool.data().weight[at(stencil * pool.data().points + q)];
  if (!energy) return p;
  PointBatch batch;
  ResponseBatch response;
  for (int l = 0; l < kLanes; ++l) {
    for (int i = 0; i < 9; ++i) batch.F[i][l] = F[i];
    batch.element[l] = stencil;
  }
  energy->evaluate(Want::gradient, batch, response);
  Matrix P;
  for (int i = 0; i < 9; ++i) P(i / 3, i % 3) = response.P[i][0];
  p.stress = P * p.F.transpose() / p.J;
  return p;
}

struct CellState {
  Matrix stress = Matrix::Zero();
  double J = 0, volume = 0, pressure = 0, stretch = 0;
};

// Stress of each patch, then the mean over the six edges of every tet.
void add_patch_stress(const RecoveryInput& in, const RegionData& region, std::vector<CellState>& cells) {
  const auto& pool = static_cast<const SolidPool&>(*in.parts.stencil_pools[at(region.elastic_pool)]);
  const auto& energy = region.energy;
  // Patches come in the order of their edges: both ends are nodes of all their tets.
  std::map<std::pair<Index, Index>, Index> patch_of;
  std::vector<std::pair<Index, Index>> edges;
  for (const Index c : region.cells) {
    const Index* n = in.body.global_cells.data() + 4 * at(c);
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) patch_of.emplace(std::minmax({n[i], n[j]}), 0);
    }
  }
  Index next = 0;
  for (auto& [edge, patch] : patch_of) patch = next++;
  std::vector<Matrix> stress(at(pool.stencils()));
  for (Index s = 0; s < pool.stencils(); ++s)
    stress[at(s)] = point_state(pool, energy.get(), s, 0, in.x, in.parts.rest).stress;
  for (const Index c : region.cells) {
    const Index* n = in.body.global_cells.data() + 4 * at(c);
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j)
        cells[at(c)].stress += stress[at(patch_of[std::minmax({n[i], n[j]})])] / 6;
    }
  }
}

// Mean pressure of the volume rows over a point, divided by J for the logarithmic strain.
double row_pressure(const RecoveryInput& in, const RegionData& region, Index local, int q, double J) {
  double p = 0;
  for (std::size_t strain = 0; strain < 2; ++strain) {
    const Index pool = region.volume_pool[strain];
    if (pool < 0) continue;
    const SolidData& data = static_cast<const SolidPool&>(*in.parts.stencil_pools[at(pool)]).data();
    double sum = 0;
    for (int k = 0; k < data.functions; ++k) {
      sum += data.shape[static_cast<std::size_t>(q * data.functions + k)] *
             in.function_multiplier[at(pool)][at(local * data.functions + k)];
    }
    p += strain == 0 ? sum : sum / J;
  }
  return p;
}

void add_region(const RecoveryInput& in, const RegionData& region, std::vector<CellState>& cells) {
  auto data = solid_data(*in.body.reference, in.parts.rest, in.body.global_cells, region.cells,
                         VolumeFunctions::none);
  if (!data) return;
  const SolidPool pool("", std::move(data).value(), nullptr, VolumeStrain::linear);
  const bool smoothed = in.body.element == Element::tet4_edge_smoothed;
  const auto energy = smoothed ? nullptr : region.energy;
  for (Index s = 0; s < pool.stencils(); ++s) {
    CellState& cell = cells[at(region.cells[at(s)])];
    const double volume = pool.volume(s);
    for (int q = 0; q < pool.data().points; ++q) {
      const PointState p = point_state(pool, energy.get(), s, q, in.x, in.parts.rest);
      const double w = p.weight / volume;
      cell.stress += w * p.stress;
      cell.J += w * p.J;
      cell.pressure += w * row_pressure(in, region, s, q, p.J);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(Eigen::Matrix3d(p.F.transpose() * p.F),
                                                                 Eigen::EigenvaluesOnly);
      cell.stretch = std::max(cell.stretch, std::sqrt(std::max(0.0, eigen.eigenvalues()(2))));
    }
    cell.volume = volume;
  }
  if (smoothed) add_patch_stress(in, region, cells);
}

// Nodal mean stress: the energy's part averaged from cells, the rows' part from the nodes where they live
// there.
std::vector<double> nodal_pressure(const RecoveryInput& in, const std::vector<CellState>& cells) {
  const Mesh& mesh = in.body.mesh;
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const auto n = at(mesh.node_count());
  std::vector<double> energy(n, 0), rows(n, 0), weight(n, 0);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::size_t k = 0; k < per; ++k) {
      const auto node = at(mesh.cells[c * per + k]);
      energy[node] += cells[c].volume * cells[c].stress.trace() / 3;
      rows[node] += cells[c].volume * cells[c].pressure;
      weight[node] += cells[c].volume;
    }
  }
  std::vector<double> result(n, 0);
  std::vector<double> multiplier(n, std::nan(""));
  for (std::size_t i = 0; i < n; ++i) multiplier[i] = in.node_multiplier[at(in.body.first_node) + i];
  // Mid-edge nodes of a Tet10 take the linear pressure of their edge.
  if (mesh.cell_type == CellType::tet10) {
    constexpr std::size_t kEdge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    for (std::size_t c = 0; c < cells.size(); ++c) {
      for (std::size_t e = 0; e < 6; ++e) {
        const auto a = at(mesh.cells[10 * c + kEdge[e][0]]), b = at(mesh.cells[10 * c + kEdge[e][1]]);
        multiplier[at(mesh.cells[10 * c + 4 + e])] = 0.5 * (multiplier[a] + multiplier[b]);
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (weight[i] == 0) continue;
    result[i] = energy[i] / weight[i] + (std::isnan(multiplier[i]) ? rows[i] / weight[i] : multiplier[i]);
  }
  return result;
}

}  // namespace

BodyFields recover_fields(const RecoveryInput& in) {
  std::vector<CellState> cells(at(in.body.mesh.cell_count()));
  for (const RegionData& region : in.body.regions) add_region(in, region, cells);
  BodyFields f;
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
  f.node_pressure = nodal_pressure(in, cells);
  return f;
}

BodyMeasures measure_body(const BodyData& body, const SystemParts& parts, std::span<const Vec3> x) {
  BodyMeasures m;
  bool first = true;
  for (const RegionData& region : body.regions) {
    auto data =
        solid_data(*body.reference, parts.rest, body.global_cells, region.cells, VolumeFunctions::none);
    if (!data) continue;
    const SolidPool pool("", std::move(data).value(), nullptr, VolumeStrain::linear);
    for (Index s = 0; s < pool.stencils(); ++s) {
      for (int q = 0; q < pool.data().points; ++q) {
        double F[9], strain = 0;
        pool.deformation_gradient(s, q, x, parts.rest, F, strain);
        const double w = pool.data().weight[at(s * pool.data().points + q)];
        m.rest_volume += w;
        m.volume += w * (1 + strain);
        m.min_J = first ? 1 + strain : std::min(m.min_J, 1 + strain);
        m.max_J = first ? 1 + strain : std::max(m.max_J, 1 + strain);
        first = false;
      }
    }
  }
  return m;
}

}  // namespace isochor
