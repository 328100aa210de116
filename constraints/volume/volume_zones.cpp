#include "constraints/volume/volume_zones.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/elements/volume_strain.h"

namespace isochor {

namespace {

using CellWeights = std::map<Index, double>;  // cell to weight, 0 to 1

std::string about(const VolumeZone& zone) {
  return "zone \"" + zone.name + "\": ";
}

// Cells of a zone that are named, not painted: with weight 1.
Result<CellWeights> named_cells(const Builder& builder, const VolumeDef& def, const VolumeZone& zone) {
  const BodyData& body = builder.body(def.body);
  const Index count = body.mesh.cell_count();
  CellWeights cells;
  if (!zone.regions.empty()) {
    auto regions = builder.regions(def.body, zone.regions, def.name);
    if (!regions) return regions.failure();
    for (const std::size_t r : regions.value()) {
      for (const Index c : body.regions[r].cells) cells[c] = 1;
    }
  }
  for (const Index c : zone.cells) {
    if (c < 0 || c >= count) {
      return Error{about(zone) + "cell " + std::to_string(c) + " is not in body \"" + body.name +
                   "\", which has cells 0 to " + std::to_string(count - 1)};
    }
    cells[c] = 1;
  }
  const auto per = static_cast<std::size_t>(nodes_per_cell(body.mesh.cell_type));
  for (Index c = 0; c < count && !zone.boxes.empty(); ++c) {
    Vec3 center;
    for (std::size_t k = 0; k < at(body.reference->corners); ++k) {
      center += (1.0 / body.reference->corners) * body.mesh.nodes[at(body.mesh.cells[at(c) * per + k])];
    }
    for (const auto& [lo, hi] : zone.boxes) {
      if (center.x >= lo.x && center.y >= lo.y && center.z >= lo.z && center.x <= hi.x && center.y <= hi.y &&
          center.z <= hi.z) {
        cells[c] = 1;
      }
    }
  }
  return cells;
}

// What the author may want to know about paint.
void report_paint(Builder& builder, const VolumeDef& def, const PaintedCells& painted) {
  if (painted.shared + painted.filled + painted.without + painted.lost == 0) return;
  std::string text = "volume \"" + def.name + "\": painted zones hold " + std::to_string(painted.painted) +
                     " cells, " + std::to_string(painted.shared) + " of them shared by several";
  if (painted.filled > 0)
    text += "; " + std::to_string(painted.filled) + " unpainted cells take the nearest zones";
  if (painted.without > 0) text += "; " + std::to_string(painted.without) + " cells are in no painted zone";
  if (painted.lost > 0) {
    text += "; " + std::to_string(painted.lost) +
            " cells found no path to the surface and have the weights of its nearest node";
  }
  builder.warn(std::move(text));
}

Result<std::vector<CellWeights>> zone_cells(Builder& builder, const VolumeDef& def) {
  std::vector<CellWeights> cells;
  std::vector<std::string> fields;
  std::vector<std::size_t> zone_of_field;
  for (const VolumeZone& z : def.zones) {
    auto named = named_cells(builder, def, z);
    if (!named) return named.failure();
    cells.push_back(std::move(named).value());
    if (z.field.empty()) continue;
    fields.push_back(z.field);
    zone_of_field.push_back(cells.size() - 1);
  }
  if (!fields.empty()) {
    auto painted = painted_cells(builder.body(def.body).mesh, fields, def.painted_surfaces, def.unpainted);
    if (!painted) return painted.failure();
    report_paint(builder, def, painted.value());
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const std::vector<double>& weight = painted.value().weight[f];
      for (std::size_t c = 0; c < weight.size(); ++c) {
        if (weight[c] > 0) cells[zone_of_field[f]].emplace(static_cast<Index>(c), weight[c]);
      }
    }
  }
  for (std::size_t z = 0; z < cells.size(); ++z) {
    if (!cells[z].empty()) continue;
    return Error{about(def.zones[z]) +
                 "it has no cells; give regions, cells, boxes that hold centers of cells, or a field that is "
                 "painted somewhere"};
  }
  return cells;
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// Which of the regions each cell is in.
std::vector<std::size_t> region_of_cells(const BodyData& body, const std::vector<VolumeRegion>& regions) {
  std::vector<std::size_t> of(at(body.mesh.cell_count()), kNone);
  for (std::size_t v = 0; v < regions.size(); ++v) {
    for (const Index c : regions[v].pool->data().cell) of[at(c)] = v;
  }
  return of;
}

// A row lives in one stencil pool. Cells that rows should carry but no zone holds would have no bulk modulus.
Result<void> check_cells(const VolumeDef& def, const std::vector<VolumeRegion>& regions,
                         const std::vector<std::size_t>& region_of, const std::vector<CellWeights>& cells) {
  std::vector<bool> covered(region_of.size(), false);
  for (std::size_t z = 0; z < cells.size(); ++z) {
    const VolumeZone& zone = def.zones[z];
    const Index first = cells[z].begin()->first;
    for (const auto& [c, weight] : cells[z]) {
      if (region_of[at(c)] != region_of[at(first)] || region_of[at(c)] == kNone) {
        return Error{about(zone) + "cells " + std::to_string(first) + " and " + std::to_string(c) +
                     " are not in one region that has these volume rows; make one zone a region, or set "
                     "across_regions = true"};
      }
      covered[at(c)] = covered[at(c)] || (zone.compliance > 0 && std::isfinite(zone.compliance));
    }
  }
  if (!def.carries_bulk || def.hard) return {};
  Index missing = 0, example = -1;
  std::vector<bool> compliant(covered.size(), false);
  for (const VolumeRegion& r : regions) {
    for (Index s = 0; s < r.pool->stencils(); ++s)
      compliant[at(r.pool->data().cell[at(s)])] = r.inverse_bulk_of(s) > 0;
  }
  for (std::size_t c = 0; c < covered.size(); ++c) {
    if (region_of[c] == kNone || covered[c] || !compliant[c]) continue;
    if (missing++ == 0) example = static_cast<Index>(c);
  }
  if (missing == 0) return {};
  return Error{std::to_string(missing) + " cells, cell " + std::to_string(example) +
               " the first, are in no compliant zone and would have no bulk modulus; add a zone for them, "
               "or set carries_bulk = false"};
}

// A hard zone that the ones before it determine (the same cells, or a union of others) would leave its
// pressure open. Gram-Schmidt on the zones' cells, each scaled by its volume.
Result<void> check_independent(const VolumeRegion& region, const VolumeZones& zones,
                               const std::vector<std::string>& names) {
  std::vector<std::vector<double>> basis;
  for (std::size_t z = 0; z < zones.stencils.size(); ++z) {
    std::vector<double> v(at(region.pool->stencils()), 0);
    double size = 0;
    for (std::size_t i = 0; i < zones.stencils[z].size(); ++i) {
      const Index s = zones.stencils[z][i];
      v[at(s)] = zones.weight[z][i] * std::sqrt(region.pool->volume(s));
      size += v[at(s)] * v[at(s)];
    }
    const auto product = [&](const std::vector<double>& b) {
      double sum = 0;
      for (std::size_t i = 0; i < v.size(); ++i) sum += v[i] * b[i];
      return sum;
    };
    for (int pass = 0; pass < 2; ++pass) {
      for (const auto& b : basis) {
        const double along = product(b);
        for (std::size_t i = 0; i < v.size(); ++i) v[i] -= along * b[i];
      }
    }
    const double rest = product(v);
    if (rest <= 1e-12 * size) {
      return Error{"hard zone \"" + names[z] +
                   "\" repeats what the hard zones before it say together; drop one of them, or give one "
                   "a compliance"};
    }
    for (double& c : v) c /= std::sqrt(rest);
    basis.push_back(std::move(v));
  }
  return {};
}

}  // namespace

VolumeStrain strain_in(const VolumeDef& def, const MaterialModel& material) {
  if (def.strain != VolumeStrain::by_law) return def.strain;
  // Rows without compliance have no U(J): the linear strain keeps the whole volume, not only each row's mean.
  if (def.hard || material.inverse_bulk() == 0) return VolumeStrain::linear;
  const VolumeStrain strain = material.volume_strain();
  if (def.space != VolumeSpace::element || strain == VolumeStrain::linear) return strain;
  return strain == VolumeStrain::mixed ? VolumeStrain::mean_mixed : VolumeStrain::mean_logarithmic;
}

Result<VolumeRegion> region_across(Builder& builder, const VolumeDef& def,
                                   std::span<const std::size_t> regions) {
  const BodyData& body = builder.body(def.body);
  std::vector<Index> cells;
  std::vector<const MaterialModel*> material(at(body.mesh.cell_count()), nullptr);
  double shear = 0, volume = 0;
  VolumeStrain strain = VolumeStrain::by_law;
  for (const std::size_t r : regions) {
    const RegionData& region = body.regions[r];
    if (std::isinf(region.material->inverse_bulk()) && !def.hard) continue;
    if (region.growth) {
      return Error{"the rows go across regions and region \"" + region.name +
                   "\" has growth, which they do not follow; give it rows of its own, or end the growth"};
    }
    const VolumeStrain own = strain_in(def, *region.material);
    if (strain != VolumeStrain::by_law && strain != own) {
      return Error{
          "the rows go across regions whose laws have different volume parts; say which strain they "
          "measure (linear, logarithmic, mixed)"};
    }
    strain = own;
    for (const Index c : region.cells) material[at(c)] = region.material.get();
    cells.insert(cells.end(), region.cells.begin(), region.cells.end());
  }
  VolumeRegion out;
  if (cells.empty()) return out;
  std::sort(cells.begin(), cells.end());
  const VolumeFunctions kind = body.reference->points > 1 && !is_of_mean(strain) ? VolumeFunctions::corners
                                                                                 : VolumeFunctions::constant;
  auto data = solid_data(*body.reference, builder.rest(), body.global_cells, cells, kind);
  if (!data) return data.failure();
  const auto pool = std::make_shared<SolidPool>(body.name + "/" + def.name,
                                                std::make_shared<const SolidData>(std::move(data).value()),
                                                nullptr, strain);
  out.name = def.name;
  out.strain = strain;
  out.stencil_pool = builder.add_stencils(pool);
  out.pool = &builder.solid(out.stencil_pool);
  out.corners = body.reference->corners;
  SpanningVolume spanning{out.stencil_pool, strain, std::vector<Index>(at(body.mesh.cell_count()), -1)};
  for (Index s = 0; s < out.pool->stencils(); ++s) {
    const Index c = out.pool->data().cell[at(s)];
    const MaterialModel& m = *material[at(c)];
    out.own_inverse_bulk.push_back(def.hard ? 0 : m.inverse_bulk_of(c));
    shear += out.pool->volume(s) * m.shear_modulus();
    volume += out.pool->volume(s);
    spanning.stencil_of_cell[at(c)] = s;
  }
  builder.bodies()[static_cast<std::size_t>(def.body)].spanning.push_back(std::move(spanning));
  out.shear_modulus = shear / volume;
  return out;
}

Result<std::vector<std::shared_ptr<RowPool>>> zone_rows(Builder& builder, const VolumeDef& def,
                                                        const std::vector<VolumeRegion>& regions) {
  const BodyData& body = builder.body(def.body);
  auto cells = zone_cells(builder, def);
  if (!cells) return cells.failure();
  if (auto r = check_cells(def, regions, region_of_cells(body, regions), cells.value()); !r)
    return r.failure();
  std::vector<std::shared_ptr<RowPool>> out;
  for (const VolumeRegion& region : regions) {
    const std::vector<Index>& cell = region.pool->data().cell;
    std::map<Index, Index> stencil_of;
    for (std::size_t s = 0; s < cell.size(); ++s) stencil_of[cell[s]] = static_cast<Index>(s);
    VolumeZones hard, compliant;
    std::vector<std::string> names;
    for (std::size_t z = 0; z < cells.value().size(); ++z) {
      const CellWeights& members = cells.value()[z];
      if (!stencil_of.count(members.begin()->first)) continue;
      std::vector<std::pair<Index, double>> list;
      for (const auto& [c, weight] : members) list.emplace_back(stencil_of.at(c), weight);
      std::sort(list.begin(), list.end());
      VolumeZones one{{{}}, {def.zones[z].compliance}, {{}}};
      for (const auto& [s, weight] : list) {
        one.stencils[0].push_back(s);
        one.weight[0].push_back(weight);
      }
      const bool is_hard = std::isfinite(one.compliance[0]) && is_hard_zone(region, one, 0);
      VolumeZones& zones = is_hard ? hard : compliant;
      zones.stencils.push_back(std::move(one.stencils[0]));
      zones.weight.push_back(std::move(one.weight[0]));
      zones.compliance.push_back(is_hard ? 0 : one.compliance[0]);
      if (is_hard) names.push_back(def.zones[z].name);
    }
    if (auto r = check_independent(region, hard, names); !r) return r.failure();
    for (const VolumeZones* zones : {&hard, &compliant}) {
      const auto rows = zone_volume_rows(region, *zones);
      if (rows->rows() > 0) out.push_back(rows);
    }
  }
  return out;
}

}  // namespace isochor
