#include "constraints/volume/volume_rows.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace isochor {

namespace {

// Integral of N_k N_l over a stencil. A one-point tet takes the closed form V/20 (1 + delta).
double pressure_mass(const SolidData& data, Index stencil, double volume, int k, int l) {
  if (data.functions == 1) return volume / 20 * (k == l ? 2 : 1);
  double sum = 0;
  for (int q = 0; q < data.points; ++q) {
    const double* N = data.shape.data() + static_cast<std::size_t>(q * data.functions);
    sum += data.weight[at(stencil * data.points + q)] * N[k] * N[l];
  }
  return sum;
}

// All functions of a stencil together integrate Phi; N_k sum to one.
void push_whole_stencil(RowPool& rows, Index stencil, int functions) {
  for (int k = 0; k < functions; ++k) {
    rows.map.item.push_back(stencil * functions + k);
    rows.weight.push_back(1);
  }
}

// `metric`: the volume over the shear modulus, summed over the stencils of the row.
void finish_row(RowPool& rows, double volume, double metric) {
  rows.map.offset.push_back(static_cast<Index>(rows.map.item.size()));
  rows.metric.push_back(metric);
  rows.measure.push_back(volume);
}

}  // namespace

std::shared_ptr<RowPool> element_volume_rows(const VolumeRegion& region) {
  auto rows = std::make_shared<VolumeRowPool>(region);
  rows->stencil_pool = region.stencil_pool;
  for (Index s = 0; s < region.pool->stencils(); ++s) {
    const double volume = region.pool->volume(s);
    push_whole_stencil(*rows, s, region.pool->functions());
    finish_row(*rows, volume, volume / region.shear_modulus_of(s));
    rows->compliance.push_back({s, s, volume * region.inverse_bulk_of(s)});
  }
  return rows;
}

std::shared_ptr<RowPool> total_volume_row(const VolumeRegion& region) {
  auto rows = std::make_shared<VolumeRowPool>(region);
  rows->stencil_pool = region.stencil_pool;
  double volume = 0, metric = 0, compliance = 0;
  for (Index s = 0; s < region.pool->stencils(); ++s) {
    const double V = region.pool->volume(s);
    volume += V;
    metric += V / region.shear_modulus_of(s);
    compliance += V * region.inverse_bulk_of(s);
    push_whole_stencil(*rows, s, region.pool->functions());
  }
  finish_row(*rows, volume, metric);
  rows->compliance.push_back({0, 0, compliance});
  return rows;
}

bool is_hard_zone(const VolumeRegion& region, const VolumeZones& zones, std::size_t zone) {
  return zones.compliance[zone] == 0 || std::all_of(zones.stencils[zone].begin(), zones.stencils[zone].end(),
                                                    [&](Index s) { return region.inverse_bulk_of(s) == 0; });
}

std::shared_ptr<RowPool> zone_volume_rows(const VolumeRegion& region, const VolumeZones& zones) {
  auto rows = std::make_shared<VolumeRowPool>(region);
  rows->stencil_pool = region.stencil_pool;
  const SolidPool& pool = *region.pool;
  const auto weight_of = [&](std::size_t z, std::size_t i) {
    return zones.weight.empty() || zones.weight[z].empty() ? 1.0 : zones.weight[z][i];
  };
  std::vector<double> sharing(at(pool.stencils()), 0);
  for (std::size_t z = 0; z < zones.stencils.size(); ++z) {
    if (!std::isfinite(zones.compliance[z]) || is_hard_zone(region, zones, z)) continue;
    for (std::size_t i = 0; i < zones.stencils[z].size(); ++i) {
      sharing[at(zones.stencils[z][i])] += weight_of(z, i);
    }
  }
  for (std::size_t z = 0; z < zones.stencils.size(); ++z) {
    if (!std::isfinite(zones.compliance[z])) continue;
    const bool hard = is_hard_zone(region, zones, z);
    double volume = 0, metric = 0, compliance = 0;
    for (std::size_t i = 0; i < zones.stencils[z].size(); ++i) {
      const Index s = zones.stencils[z][i];
      const double weight = hard ? weight_of(z, i) : weight_of(z, i) / sharing[at(s)];
      const double share = weight * pool.volume(s);
      volume += share;
      metric += share / region.shear_modulus_of(s);
      compliance += share * zones.compliance[z] * region.inverse_bulk_of(s);
      for (int k = 0; k < pool.functions(); ++k) {
        rows->map.item.push_back(s * pool.functions() + k);
        rows->weight.push_back(weight);
      }
    }
    if (!hard) rows->compliance.push_back({rows->rows(), rows->rows(), compliance});
    finish_row(*rows, volume, metric);
  }
  return rows;
}

VolumeZones ring_zones(const VolumeRegion& region, int rings) {
  const SolidPool& pool = *region.pool;
  const auto corners = [&](Index s) { return pool.nodes()[s].first(at(region.corners)); };
  std::map<Index, std::vector<Index>> around;
  for (Index s = 0; s < pool.stencils(); ++s) {
    for (const Index n : corners(s)) around[n].push_back(s);
  }
  VolumeZones out;
  std::set<std::vector<Index>> seen;
  for (const auto& [center, first] : around) {
    std::set<Index> zone(first.begin(), first.end());
    std::vector<Index> outermost = first;
    for (int k = 1; k < rings; ++k) {
      std::vector<Index> next;
      for (const Index s : outermost) {
        for (const Index n : corners(s)) {
          for (const Index t : around[n]) {
            if (zone.insert(t).second) next.push_back(t);
          }
        }
      }
      outermost = std::move(next);
    }
    std::vector<Index> sorted(zone.begin(), zone.end());
    if (!seen.insert(sorted).second) continue;
    out.stencils.push_back(std::move(sorted));
    out.compliance.push_back(1);
  }
  return out;
}

namespace {

// Corner nodes: rows are in ascending order of them, whatever the order of the cells.
std::vector<Index> nodes_with_rows(const VolumeRegion& region) {
  std::vector<Index> nodes;
  for (Index s = 0; s < region.pool->stencils(); ++s) {
    const auto corners = region.pool->nodes()[s].first(at(region.corners));
    nodes.insert(nodes.end(), corners.begin(), corners.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

// What a cell has to do with the rows of its corners.
struct NodalCell {
  Index row[8];
  double mass[8][8];  // integrals of N_k N_l
  double share[8];    // of N_k
};

NodalCell nodal_cell(const VolumeRegion& region, const std::vector<Index>& nodes, Index s) {
  const SolidPool& pool = *region.pool;
  const double V = pool.volume(s);
  NodalCell cell = {};
  for (int k = 0; k < region.corners; ++k) {
    const Index node = pool.nodes()[s][at(k)];
    cell.row[k] = static_cast<Index>(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
    for (int l = 0; l < region.corners; ++l) {
      cell.mass[k][l] = pressure_mass(pool.data(), s, V, k, l);
      cell.share[k] += cell.mass[k][l];
    }
  }
  return cell;
}

// What a cell adds to the compliance of nodal rows: (row, col, value).
template <class Add>
void each_share(const VolumeRegion& region, const NodalCell& cell, Index s, double tau, Add&& add) {
  const double V = region.pool->volume(s), mu = region.shear_modulus_of(s), bulk = region.inverse_bulk_of(s);
  for (int k = 0; k < region.corners; ++k) {
    for (int l = 0; l < region.corners; ++l) {
      if (cell.row[k] < cell.row[l]) continue;
      double c = cell.mass[k][l] * bulk;
      if (tau > 0) c += tau / mu * (cell.mass[k][l] - cell.share[k] * cell.share[l] / V);
      if (c != 0) add(cell.row[k], cell.row[l], c);
    }
  }
}

// Of rows over whole stencils: of their own compliance, in proportion to volume and 1/kappa.
void add_own_shares(const VolumeRegion& region, const RowSet& rows, std::vector<ComplianceShare>& out) {
  const Index functions = region.pool->functions();
  for (const ComplianceEntry& e : rows.compliance) {
    const auto first = out.size();
    double sum = 0;
    for (Index i = rows.map.offset[at(e.row)]; i < rows.map.offset[at(e.row) + 1]; ++i) {
      if (rows.map.item[at(i)] % functions != 0) continue;
      const Index s = rows.map.item[at(i)] / functions;
      const double c = rows.weight[at(i)] * region.pool->volume(s) * region.inverse_bulk_of(s);
      out.push_back({e.row, e.row, s, c});
      sum += c;
    }
    for (std::size_t i = first; i < out.size(); ++i) out[i].value *= sum > 0 ? e.value / sum : 0;
  }
}

}  // namespace

std::vector<ComplianceShare> VolumeRowPool::compliance_shares() const {
  std::vector<ComplianceShare> out;
  if (!nodal_) {
    add_own_shares(region_, *this, out);
    return out;
  }
  const std::vector<Index> nodes = nodes_with_rows(region_);
  for (Index s = 0; s < region_.pool->stencils(); ++s) {
    each_share(region_, nodal_cell(region_, nodes, s), s, *nodal_, [&](Index row, Index col, double c) {
      out.push_back({row, lumped_ ? row : col, s, c});
      if (lumped_ && row != col) out.push_back({col, col, s, c});
    });
  }
  return out;
}

void VolumeRowPool::lump() {
  lumped_ = true;
  std::vector<double> sum(at(rows()), 0);
  for (const ComplianceEntry& e : compliance) {
    sum[at(e.row)] += e.value;
    if (e.row != e.col) sum[at(e.col)] += e.value;
  }
  compliance.clear();
  for (Index r = 0; r < rows(); ++r) compliance.push_back({r, r, sum[at(r)]});
}

// One entry a pair of rows, ascending; what adds up to one comes in the order in which it was found.
static std::vector<ComplianceEntry> summed(std::vector<ComplianceEntry> entries) {
  const auto same = [](const ComplianceEntry& a, const ComplianceEntry& b) {
    return a.row == b.row && a.col == b.col;
  };
  std::stable_sort(entries.begin(), entries.end(), [](const ComplianceEntry& a, const ComplianceEntry& b) {
    return a.row != b.row ? a.row < b.row : a.col < b.col;
  });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (kept > 0 && same(entries[kept - 1], entries[k]))
      entries[kept - 1].value += entries[k].value;
    else
      entries[kept++] = entries[k];
  }
  entries.resize(kept);
  return entries;
}

std::shared_ptr<VolumeRowPool> nodal_volume_rows(const VolumeRegion& region, double tau,
                                                 std::vector<Index>* corner_nodes) {
  auto rows = std::make_shared<VolumeRowPool>(region);
  rows->stencil_pool = region.stencil_pool;
  const SolidPool& pool = *region.pool;
  const SolidData& data = pool.data();
  const std::size_t corners = static_cast<std::size_t>(region.corners);
  const std::vector<Index> nodes = nodes_with_rows(region);
  std::vector<std::vector<std::pair<Index, double>>> terms(nodes.size());
  std::vector<double> volume(nodes.size(), 0), metric(nodes.size(), 0);
  std::vector<ComplianceEntry> compliance;
  const bool per_corner = data.functions == region.corners;
  for (Index s = 0; s < pool.stencils(); ++s) {
    const NodalCell cell = nodal_cell(region, nodes, s);
    const double mu = region.shear_modulus_of(s);
    for (std::size_t k = 0; k < corners; ++k) {
      const int kk = static_cast<int>(k);
      terms[at(cell.row[k])].push_back(per_corner ? std::pair(s * data.functions + kk, 1.0)
                                                  : std::pair(s, 1.0 / static_cast<double>(corners)));
      for (std::size_t l = 0; l < corners; ++l) {
        volume[at(cell.row[k])] += cell.mass[k][l];
        metric[at(cell.row[k])] += cell.mass[k][l] / mu;
      }
    }
    each_share(region, cell, s, tau, [&](Index row, Index col, double c) {
      compliance.push_back({row, col, c});
    });
  }
  for (std::size_t r = 0; r < nodes.size(); ++r) {
    for (const auto& [function, weight] : terms[r]) {
      rows->map.item.push_back(function);
      rows->weight.push_back(weight);
    }
    finish_row(*rows, volume[r], metric[r]);
  }
  rows->compliance = summed(std::move(compliance));
  rows->set_nodal(tau);
  if (corner_nodes) *corner_nodes = nodes;
  return rows;
}

}  // namespace isochor
