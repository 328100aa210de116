// Bodies of a scene as stencils: energies, volume functions, the guard of elements, memory, mass.
#include <algorithm>
#include <limits>

#include "engine/elements/element_guard.h"
#include "engine/elements/grown_pool.h"
#include "engine/elements/relaxation_pool.h"
#include "engine/elements/volume_strain.h"
#include "engine/scene/builder.h"

namespace isochor {

Result<void> Builder::build_solids() {
  for (BodyData& body : bodies_) {
    for (RegionData& region : body.regions) {
      if (auto r = build_region(body, region); !r) {
        return Error{"body \"" + body.name + "\", region \"" + region.name + "\": " + r.error()};
      }
    }
  }
  return {};
}

// The cells of the stencils of a pool, and the share of each.
struct StencilCells {
  Lists cells;
  std::vector<double> weight;
};
static StencilCells cells_of_stencils(const SolidData& data) {
  StencilCells out{data.patch_cells, data.patch_share};
  if (!out.weight.empty()) return out;
  for (const Index c : data.cell) out.cells.push({&c, 1});
  out.weight.assign(data.cell.size(), 1.0);
  return out;
}

// The energy of a region for the stencils of a pool: where parameters vary from cell to cell, gathered.
static std::shared_ptr<const Material> for_stencils(std::shared_ptr<const Material> energy,
                                                    const MaterialModel& model, const SolidData& data) {
  if (!energy || model.field_cells() == 0) return energy;
  const StencilCells of = cells_of_stencils(data);
  auto own = energy->gathered(of.cells, of.weight);
  return own ? own : energy;
}

static std::shared_ptr<const SolidPool> solid_pool(std::string name, std::shared_ptr<const SolidData> data,
                                                   std::shared_ptr<const Material> energy,
                                                   VolumeStrain strain,
                                                   const std::shared_ptr<const Growth>& growth) {
  if (!growth)
    return std::make_shared<SolidPool>(std::move(name), std::move(data), std::move(energy), strain);
  auto own = growth;
  if (growth->field) {
    const StencilCells of = cells_of_stencils(*data);
    own = growth->gathered(of.cells, of.weight);
  }
  return std::make_shared<GrownPool>(std::move(name), std::move(data), std::move(energy), strain,
                                     std::move(own));
}

// Whether anything of a region varies from cell to cell.
static bool has_fields(const RegionData& region) {
  return region.material->field_cells() > 0 || (region.growth && region.growth->field);
}

// A barrier would falsify the true compression of a compressible material; there it acts only on tets that
// are next to turning over. Null where no cell has one. Its elements are the cells of the region, in their
// order.
static std::shared_ptr<const Material> element_guard(const BodyData& body, RegionData& region) {
  constexpr double nearly_incompressible = 0.49, true_compression = 0.1;
  const MaterialModel& material = *region.material;
  std::vector<ElementGuard::Barrier> barriers;
  for (const Index c : region.cells) {
    const double b = body.guard_stiffness.value_or(1.0);
    const bool everywhere = body.guard_stiffness || material.poisson_of(c) >= nearly_incompressible;
    barriers.push_back(
        {b * material.shear_modulus() * material.stiffness_factor(c),
         everywhere ? body.guard_threshold : std::min(body.guard_threshold, true_compression)});
    region.guarded.push_back(barriers.back().stiffness > 0 && barriers.back().threshold > 0 ? 1 : 0);
  }
  const bool any =
      std::any_of(region.guarded.begin(), region.guarded.end(), [](std::uint8_t g) { return g != 0; });
  if (!any) {
    region.guarded.clear();
    return nullptr;
  }
  return std::make_shared<ElementGuard>(std::move(barriers));
}

// Data of another place than that of the body are of no use.
static RegionStencils& stencils_at(const BodyData& body, RegionData& region) {
  if (region.stencils.first_node != body.first_node) region.stencils = {body.first_node, nullptr, {}};
  return region.stencils;
}

Result<std::shared_ptr<const SolidData>> Builder::patches_of(const BodyData& body, RegionData& region) const {
  auto& kept = stencils_at(body, region).patches;
  if (kept && !has_fields(region)) return kept;
  auto made = edge_patch_data(parts_.rest, body.global_cells, region.cells);
  if (!made) return made.failure();
  // Where nothing varies from cell to cell, nobody asks for the cells of a patch.
  const bool fields = has_fields(region);
  if (!fields) {
    made.value().patch_cells = {};
    made.value().patch_share = {};
  }
  auto data = std::make_shared<const SolidData>(std::move(made).value());
  if (!fields) kept = data;
  return data;
}

Result<std::shared_ptr<const SolidData>> Builder::cells_of(const BodyData& body, RegionData& region,
                                                           VolumeFunctions kind) const {
  auto& kept = stencils_at(body, region).cells[static_cast<std::size_t>(kind)];
  if (kept) return kept;
  auto made = solid_data(*body.reference, parts_.rest, body.global_cells, region.cells, kind);
  if (!made) return made.failure();
  kept = std::make_shared<const SolidData>(std::move(made).value());
  return kept;
}

// What flows, on the points of the energy.
void Builder::add_memory(const BodyData& body, RegionData& region,
                         const std::shared_ptr<const SolidData>& data) {
  region.memory_pools.clear();
  const MaterialMemory* memory = region.material->memory();
  if (!memory || (quasi_static_ && !memory->in_statics)) return;
  for (const auto& branch : memory->branches) {
    region.memory_pools.push_back(add_stencils(std::make_shared<RelaxationPool>(
        body.name + "/" + region.name + "/memory " + std::to_string(region.memory_pools.size()), data,
        for_stencils(branch.spring, *region.material, *data), branch.time)));
  }
}

// Elastic energy and volume functions share a stencil where both live on the cell; edge patches have their
// own.
Result<void> Builder::build_region(BodyData& body, RegionData& region) {
  const bool smoothed = body.element == Element::tet4_edge_smoothed;
  // One point integrates whatever a linear tet has; the others need a function for each corner.
  const VolumeFunctions kind =
      body.reference->points > 1 ? VolumeFunctions::corners : VolumeFunctions::constant;
  std::shared_ptr<const Material> energy;
  if (region.bulk_claimed) {
    energy = region.material->distortional();
  } else {
    auto complete = region.material->complete();
    if (!complete) return complete.failure();
    energy = complete.value();
  }
  for (const std::string& warning : region.material->warnings()) {
    warn("body \"" + body.name + "\", region \"" + region.name + "\": " + warning);
  }
  const std::size_t fields = region.material->field_cells();
  if (fields > 0 && fields != at(body.mesh.cell_count())) {
    return Error{"its material has a field of " + std::to_string(fields) + " entries, the mesh of the body " +
                 std::to_string(body.mesh.cell_count()) + " cells; give one entry a cell"};
  }
  std::vector<double> lumped(consistent_mass_ ? parts_.mass.size() : 0, 0);
  auto& mass = consistent_mass_ ? lumped : parts_.mass;
  add_lumped_mass(*body.reference, parts_.rest, body.global_cells, region.cells, region.density, mass);
  if (consistent_mass_) {
    add_consistent_mass(*body.reference, parts_.rest, body.global_cells, region.cells, region.density,
                        parts_.mass_entries);
    for (Index i = 0; i < static_cast<Index>(lumped.size()); ++i) {
      if (lumped[at(i)] == 0) continue;
      parts_.mass[at(i)] += lumped[at(i)];
      parts_.mass_entries.push_back({i, i, -lumped[at(i)]});
    }
  }
  if (smoothed) {
    auto patches = patches_of(body, region);
    if (!patches) return patches.failure();
    region.energy = energy = for_stencils(energy, *region.material, *patches.value());
    region.elastic_pool = add_stencils(solid_pool(body.name + "/" + region.name + "/patches", patches.value(),
                                                  energy, VolumeStrain::linear, region.growth));
    add_memory(body, region, patches.value());
    energy = element_guard(body, region);
  }
  const auto& asked = region.volume_wanted;
  const bool none = std::find(asked.begin(), asked.end(), true) == asked.end();
  for (std::size_t strain = 0; strain < kVolumeStrains; ++strain) {
    const bool wanted = asked[strain];
    const bool needed = strain == 0 && energy && none;
    if (!wanted && !needed) continue;
    const bool mean = is_of_mean(static_cast<VolumeStrain>(strain));
    auto data =
        cells_of(body, region, !wanted ? VolumeFunctions::none : (mean ? VolumeFunctions::constant : kind));
    if (!data) return data.failure();
    if (energy && !smoothed) region.energy = energy = for_stencils(energy, *region.material, *data.value());
    const Index pool = add_stencils(solid_pool(body.name + "/" + region.name, data.value(), energy,
                                               static_cast<VolumeStrain>(strain), region.growth));
    if (wanted) region.volume_pool[strain] = pool;
    if (energy && !smoothed) {
      region.elastic_pool = pool;
      add_memory(body, region, data.value());
    }
    if (energy && smoothed) region.guard_pool = pool;
    energy = nullptr;  // once only
  }
  region.remembers = !region.memory_pools.empty() || (region.energy && region.energy->remembers());
  return {};
}

}  // namespace isochor
