#include "engine/world/cell_stress.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "engine/elements/volume_strain.h"
#include "engine/mesh/cell_shape.h"
#include "engine/world/recovery_points.h"

namespace isochor {

namespace {

Stress numbers_of(const StressMatrix& s) {
  return {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)};
}

using Edge = std::pair<Index, Index>;

std::vector<Edge> edges_of(const BodyData& body, Index cell) {
  const Index* n = body.global_cells.data() + 4 * at(cell);
  std::vector<Edge> out;
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) out.push_back(std::minmax(n[i], n[j]));
  }
  return out;
}

}  // namespace

CellStress::CellStress(const BodyData& body, const SystemParts& parts, Index cell) : cell_(cell) {
  for (const RegionData& region : body.regions) {
    const auto found = std::find(region.cells.begin(), region.cells.end(), cell);
    if (found == region.cells.end()) continue;
    region_ = &region;
    local_ = static_cast<Index>(found - region.cells.begin());
  }
  auto data =
      solid_data(*body.reference, parts.rest, body.global_cells, std::span(&cell_, 1), VolumeFunctions::none);
  pool_ = std::make_shared<const SolidPool>("", std::make_shared<const SolidData>(std::move(data).value()),
                                            nullptr, VolumeStrain::linear);
  const auto of_cell = pool_->nodes()[0];
  nodes_.assign(of_cell.begin(), of_cell.end());
  if (body.element == Element::tet4_edge_smoothed) find_patches(body, parts);
}

// Patches come in the order of their edges: both ends are nodes of all their tets.
void CellStress::find_patches(const BodyData& body, const SystemParts& parts) {
  std::set<Edge> all;
  for (const Index c : region_->cells) {
    for (const Edge& e : edges_of(body, c)) all.insert(e);
  }
  const std::vector<Edge> own = edges_of(body, cell_);
  std::set<Index> nodes(nodes_.begin(), nodes_.end());
  const StencilPool& pool = *parts.stencil_pools[at(region_->elastic_pool)];
  Index stencil = 0;
  for (const Edge& e : all) {
    if (std::find(own.begin(), own.end(), e) != own.end()) {
      patches_.push_back({stencil, 1. / 6});
      nodes.insert(pool.nodes()[stencil].begin(), pool.nodes()[stencil].end());
    }
    ++stencil;
  }
  nodes_.assign(nodes.begin(), nodes.end());
}

double CellStress::size() const {
  return std::cbrt(pool_->volume(0));
}

Stress CellStress::of_energy(const RecoveryInput& in) const {
  StressMatrix sum = StressMatrix::Zero();
  const Growth* growth = nullptr;
  if (!patches_.empty()) {
    const auto& pool = static_cast<const SolidPool&>(*in.parts.stencil_pools[at(region_->elastic_pool)]);
    growth = pool.growth();
    for (const PatchOfCell& patch : patches_) {
      const GrownState grown = growth ? growth->at(patch.stencil, growth->amount->at(in.t)) : GrownState{};
      sum += patch.share * point_state(pool, region_->energy.get(), patch.stencil, patch.stencil, 0, in,
                                       growth ? &grown : nullptr, 0)
                               .stress;
    }
    return numbers_of(sum);
  }
  growth = region_->growth.get();
  const GrownState grown = growth ? growth->at(cell_, growth->amount->at(in.t)) : GrownState{};
  for (int q = 0; q < pool_->data().points; ++q) {
    const PointState p =
        point_state(*pool_, region_->energy.get(), 0, local_, q, in, growth ? &grown : nullptr, 0);
    sum += p.weight / pool_->volume(0) * p.stress;
  }
  return numbers_of(sum);
}

double CellStress::of_rows(const RecoveryInput& in) const {
  const Growth* growth = region_->growth.get();
  const GrownState grown = growth ? growth->at(cell_, growth->amount->at(in.t)) : GrownState{};
  double sum = 0;
  for (int q = 0; q < pool_->data().points; ++q) {
    const PointState p = point_state(*pool_, nullptr, 0, local_, q, in, growth ? &grown : nullptr, 0);
    sum += p.weight / pool_->volume(0) *
           row_pressure(in, *region_, local_, q, p.elastic_J, growth ? &grown : nullptr);
  }
  return sum;
}

Stress CellStress::whole(const RecoveryInput& in) const {
  Stress out = of_energy(in);
  const double pressure = of_rows(in);
  for (std::size_t k = 0; k < 3; ++k) out[k] += pressure;
  return out;
}

std::vector<CellStress::Functions> CellStress::functions(const RecoveryInput& in) const {
  std::vector<Functions> out;
  const auto add = [&](Index pool, Index stencil) {
    const Index count = in.parts.stencil_pools[at(pool)]->functions();
    if (stencil >= 0) out.push_back({pool, stencil * count, count});
  };
  for (const Index pool : region_->volume_pool) {
    if (pool >= 0) add(pool, local_);
  }
  for (const SpanningVolume& v : in.body.spanning) add(v.pool, v.stencil_of_cell[at(cell_)]);
  return out;
}

}  // namespace isochor
