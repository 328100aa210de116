#include "engine/world/cell_terms.h"

namespace isochor {

CellTerms::CellTerms(const BodyData& body, const System& system, const Assembly& assembly,
                     const Parallel& parallel, std::span<const Vec3> x, std::span<const double> lambda)
    : body_(body), system_(system), assembly_(assembly), parallel_(parallel), x_(x), lambda_(lambda) {}

namespace {

// Without multipliers the gradient of a stencil is that of its energy alone.
struct EnergyForces {
  std::vector<double> energy;
  std::vector<Vec3> gradient;

  EnergyForces(const SolidPool& solid, StencilRequest request, const Parallel& parallel)
      : energy(at(solid.stencils())), gradient(solid.nodes().item.size()) {
    const auto functions = static_cast<std::size_t>(solid.functions());
    std::vector<double> value(energy.size() * functions), none(value.size(), 0.0);
    std::vector<Vec3> jacobian(gradient.size() * functions);
    StencilSlots slots;
    slots.energy = energy;
    slots.value = value;
    slots.gradient = gradient;
    slots.jacobian = jacobian;
    request.function_multiplier = none;
    parallel.run(solid.stencils(), solid.grain(), [&](Index begin, Index end) {
      StencilRequest part = request;
      part.begin = begin;
      part.end = end;
      solid.evaluate(part, slots);
    });
  }
  std::span<const Vec3> of(const SolidPool& solid, Index s) const {
    return std::span(gradient).subspan(at(solid.nodes().offset[at(s)]), solid.nodes()[s].size());
  }
};

// Patches, once for each of their cells, and which `patch` that is: what the cell alone adds at the patch's
// deformation.
SolidData cell_by_cell(const SolidData& patches, std::vector<Index>& patch) {
  SolidData out;
  for (Index s = 0; s < patches.nodes.count(); ++s) {
    const auto nodes = patches.nodes[s];
    const auto first = patches.gradient.begin() + patches.nodes.offset[at(s)];
    for (Index k = patches.patch_cells.offset[at(s)]; k < patches.patch_cells.offset[at(s) + 1]; ++k) {
      out.nodes.push(nodes);
      out.gradient.insert(out.gradient.end(), first, first + static_cast<std::ptrdiff_t>(nodes.size()));
      out.weight.push_back(patches.weight[at(s)] * patches.patch_share[at(k)]);
      out.cell.push_back(patches.patch_cells.item[at(k)]);
      patch.push_back(s);
    }
  }
  return out;
}

}  // namespace

void CellTerms::pool_forces(Index pool, const Force& visit) const {
  const auto& solid = static_cast<const SolidPool&>(*system_.parts().stencil_pools[at(pool)]);
  const EnergyForces all(solid, assembly_.request(pool, Want::gradient, x_), parallel_);
  for (Index s = 0; s < solid.stencils(); ++s)
    visit({solid.data().cell[at(s)], -1, -1, 1, all.energy[at(s)], solid.nodes()[s], all.of(solid, s)});
}

// Patches take the mean of the energies of their cells.
Result<void> CellTerms::patch_forces(const RegionData& region, const Force& visit) const {
  if (region.growth && (region.growth->field || region.material->field_cells() > 0)) {
    return Error{"region \"" + region.name +
                 "\": its growth or its material varies from cell to cell and patches grow by the mean, so "
                 "that cells have no stiffness of their own; take constants of the material"};
  }
  const Index pool = region.elastic_pool;
  const auto& solid = static_cast<const SolidPool&>(*system_.parts().stencil_pools[at(pool)]);
  const StencilRequest request = assembly_.request(pool, Want::gradient, x_);
  const EnergyForces all(solid, request, parallel_);
  auto made = edge_patch_data(system_.parts().rest, body_.global_cells, region.cells);
  if (!made) return made.failure();
  const SolidData& patches = made.value();
  if (region.material->field_cells() == 0) {
    for (Index s = 0; s < solid.stencils(); ++s) {
      for (Index k = patches.patch_cells.offset[at(s)]; k < patches.patch_cells.offset[at(s) + 1]; ++k) {
        visit({patches.patch_cells.item[at(k)], pool, s, patches.patch_share[at(k)], all.energy[at(s)],
               solid.nodes()[s], all.of(solid, s)});
      }
    }
    return {};
  }
  std::vector<Index> patch;
  auto data = std::make_shared<const SolidData>(cell_by_cell(patches, patch));
  Lists cells;
  for (const Index c : data->cell) cells.push({&c, 1});
  auto energy = region.material->distortional();
  if (!region.bulk_claimed) {
    auto complete = region.material->complete();
    if (!complete) return complete.failure();
    energy = complete.value();
  }
  const SolidPool apart(std::string(solid.name()), data,
                        energy->gathered(cells, std::vector<double>(data->cell.size(), 1.0)),
                        VolumeStrain::linear);
  const EnergyForces each(apart, request, parallel_);
  double sum = 0, whole = 0, size = 0;
  for (Index s = 0; s < apart.stencils(); ++s) {
    visit(
        {data->cell[at(s)], pool, patch[at(s)], 1, each.energy[at(s)], apart.nodes()[s], each.of(apart, s)});
    sum += each.energy[at(s)];
  }
  for (const double e : all.energy) whole += e, size += std::abs(e);
  if (std::abs(sum - whole) <= 1e-9 * size) return {};
  return Error{"region \"" + region.name +
               "\": its material has several fields, whose product is averaged over patches "
               "field by field, so that cells have no stiffness of their own; give it one field"};
}

Result<void> CellTerms::each_force(const Force& visit) const {
  for (const RegionData& region : body_.regions) {
    const bool patches = body_.element == Element::tet4_edge_smoothed;
    if (patches) {
      if (auto r = patch_forces(region, visit); !r)
        return Error{"gradients: body \"" + body_.name + "\", " + r.error()};
    } else if (region.elastic_pool >= 0) {
      pool_forces(region.elastic_pool, visit);
    }
    if (region.guard_pool >= 0) pool_forces(region.guard_pool, visit);
  }
  return {};
}

void CellTerms::each_row(const Row& visit) const {
  const auto is_of_body = [&](Index pool) {
    for (const RegionData& region : body_.regions) {
      if (region.has_volume_pool(pool)) return true;
    }
    for (const SpanningVolume& volume : body_.spanning) {
      if (volume.pool == pool) return true;
    }
    return false;
  };
  const auto& pools = system_.parts().row_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const SharedCompliance* shared = pools[p]->facets().shared;
    if (!shared || pools[p]->law != RowLaw::compliant || !is_of_body(pools[p]->stencil_pool)) continue;
    const auto& solid =
        static_cast<const SolidPool&>(*system_.parts().stencil_pools[at(pools[p]->stencil_pool)]);
    const Index first = system_.first_row(static_cast<Index>(p));
    for (const ComplianceShare& e : shared->compliance_shares()) {
      const Index cell = solid.data().cell[at(e.stencil)];
      visit(cell, first + e.row, e.value * lambda_[at(first + e.col)]);
      if (e.row != e.col) visit(cell, first + e.col, e.value * lambda_[at(first + e.row)]);
    }
  }
}

}  // namespace isochor
