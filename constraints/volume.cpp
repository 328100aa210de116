#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "constraints/volume_rows.h"
#include "engine/builder.h"

namespace isochor {

namespace {

// Rows at nodes know the pressure there.
class VolumeInstance final : public EffectInstance {
 public:
  struct Nodal {
    Index row_pool;
    std::vector<Index> nodes;
  };
  std::vector<Nodal> nodal;

  void node_multipliers(const GaugeContext& c, std::span<double> pressure) const override {
    // Where regions meet each has its own row; the node shows their mean.
    std::map<Index, std::pair<double, int>> sums;
    for (const Nodal& n : nodal) {
      for (std::size_t r = 0; r < n.nodes.size(); ++r) {
        auto& [sum, count] = sums[n.nodes[r]];
        sum += c.state.lambda[at(c.system.first_row(n.row_pool)) + r];
        ++count;
      }
    }
    for (const auto& [node, s] : sums) pressure[at(node)] = s.first / s.second;
  }
};

class VolumeEffect final : public EffectSource {
 public:
  explicit VolumeEffect(VolumeDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }

  Result<void> check() const override {
    if (!std::isfinite(def_.stabilization) || def_.stabilization < 0) {
      return Error{who() + "stabilization = " + std::to_string(def_.stabilization) +
                   "; it must be zero (off) or positive, 1 is the default"};
    }
    if (def_.rings < 1 || def_.rings > 1000) {
      return Error{who() + "rings = " + std::to_string(def_.rings) +
                   "; it must be at least 1, the cells around a node (and at most 1000)"};
    }
    if ((def_.space == VolumeSpace::zone) == def_.zones.empty()) {
      return Error{who() + (def_.zones.empty() ? "space is zone, but zones is empty; give at least one"
                                               : "zones are given, but space is not zone; change space")};
    }
    for (const VolumeZone& z : def_.zones) {
      if (!(z.compliance >= 0)) {
        return Error{who() + "zone \"" + z.name + "\": compliance = " + std::to_string(z.compliance) +
                     "; it must be 0 (hard), 1 (as the material says), any positive factor or infinity (no "
                     "row)"};
      }
    }
    if (def_.lumped_compliance && (def_.space != VolumeSpace::node || def_.hard)) {
      return Error{
          who() +
          "lumped_compliance is for compliant rows per node; drop it, or use space node without hard"};
    }
    return {};
  }

  Result<void> declare(Builder& builder) const override {
    auto regions = builder.regions(def_.body, def_.regions, def_.name);
    if (!regions) return Error{regions.error()};
    for (const std::size_t r : regions.value()) {
      const MaterialModel& material = *builder.body(def_.body).regions[r].material;
      if (std::isinf(material.inverse_bulk()) && !def_.hard) {
        // kappa = 0: the rows would carry no pressure at all.
        if (def_.carries_bulk) builder.claim_bulk(def_.body, r);
        continue;
      }
      builder.want_volume(def_.body, r, strain());
      if (def_.carries_bulk && !builder.claim_bulk(def_.body, r)) {
        return Error{who() + "other volume rows already carry the bulk modulus of region \"" +
                     builder.body(def_.body).regions[r].name +
                     "\"; set carries_bulk = false on the rows that come on top"};
      }
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto regions = builder.regions(def_.body, def_.regions, def_.name);
    if (!regions) return Error{regions.error()};
    const BodyData& body = builder.body(def_.body);
    std::vector<VolumeRegion> list;
    for (const std::size_t r : regions.value()) {
      const RegionData& region = body.regions[r];
      const Index pool = region.volume_pool[static_cast<std::size_t>(strain())];
      // Rows of another effect may have asked for the pool; without a bulk modulus these carry nothing.
      if (pool < 0 || (std::isinf(region.material->inverse_bulk()) && !def_.hard)) continue;
      VolumeRegion v;
      v.name = def_.name + (body.regions.size() > 1 ? "/" + region.name : "");
      v.stencil_pool = pool;
      v.pool = &builder.solid(pool);
      v.corners = body.reference->corners;
      v.inverse_bulk = def_.hard ? 0 : region.material->inverse_bulk();
      v.shear_modulus = region.material->shear_modulus();
      v.material = region.material->field_cells() > 0 ? region.material.get() : nullptr;
      list.push_back(v);
    }
    auto instance = std::make_unique<VolumeInstance>();
    std::vector<std::vector<Index>> chosen;
    for (const VolumeZone& z : def_.zones) {
      auto cells = cells_of(builder, body, z);
      if (!cells) return Error{cells.error()};
      chosen.push_back(std::move(cells).value());
    }
    if (auto r = check_zones(body, list, chosen); !r) return Error{r.error()};
    for (const VolumeRegion& v : list) {
      if (def_.space == VolumeSpace::zone) {
        if (auto r = add_zones(builder, v, chosen); !r) return Error{r.error()};
      } else {
        add_rows(builder, body, v, *instance);
      }
    }
    return std::unique_ptr<EffectInstance>(std::move(instance));
  }

 private:
  std::string who() const { return "volume \"" + def_.name + "\": "; }
  VolumeStrain strain() const {
    return def_.strain == VolumeStrainKind::linear ? VolumeStrain::linear : VolumeStrain::logarithmic;
  }

  void add_rows(Builder& builder, const BodyData& body, const VolumeRegion& region,
                VolumeInstance& instance) const {
    const bool equal_order = body.element != Element::tet10;
    switch (def_.space) {
      case VolumeSpace::node: {
        std::vector<Index> nodes;
        const auto rows = nodal_volume_rows(region, equal_order ? def_.stabilization : 0, &nodes);
        if (def_.lumped_compliance) lump(*rows);
        const Index pool = add(builder, rows);
        if (def_.strain == VolumeStrainKind::linear && def_.carries_bulk) {
          instance.nodal.push_back({pool, std::move(nodes)});
        }
        break;
      }
      case VolumeSpace::element:
        add(builder, element_volume_rows(region));
        break;
      case VolumeSpace::body:
        add(builder, total_volume_row(region));
        break;
      case VolumeSpace::ring:
        add(builder, zone_volume_rows(region, ring_zones(region, def_.rings)));
        break;
      case VolumeSpace::zone:
        break;  // add_zones
    }
  }

  // Cells of a zone, ascending and each once.
  Result<std::vector<Index>> cells_of(const Builder& builder, const BodyData& body,
                                      const VolumeZone& zone) const {
    const std::string where = who() + "zone \"" + zone.name + "\": ";
    const Index count = body.mesh.cell_count();
    std::set<Index> cells;
    if (!zone.regions.empty()) {
      auto regions = builder.regions(def_.body, zone.regions, def_.name);
      if (!regions) return Error{regions.error()};
      for (const std::size_t r : regions.value()) {
        cells.insert(body.regions[r].cells.begin(), body.regions[r].cells.end());
      }
    }
    for (const Index c : zone.cells) {
      if (c < 0 || c >= count) {
        return Error{where + "cell " + std::to_string(c) + " is not in body \"" + body.name +
                     "\", which has cells 0 to " + std::to_string(count - 1)};
      }
      cells.insert(c);
    }
    const auto per = static_cast<std::size_t>(nodes_per_cell(body.mesh.cell_type));
    for (Index c = 0; c < count && !zone.boxes.empty(); ++c) {
      Vec3 center;
      for (std::size_t k = 0; k < at(body.reference->corners); ++k) {
        center += (1.0 / body.reference->corners) * body.mesh.nodes[at(body.mesh.cells[at(c) * per + k])];
      }
      for (const auto& [lo, hi] : zone.boxes) {
        if (center.x >= lo.x && center.y >= lo.y && center.z >= lo.z && center.x <= hi.x &&
            center.y <= hi.y && center.z <= hi.z) {
          cells.insert(c);
        }
      }
    }
    if (cells.empty()) {
      return Error{where + "it has no cells; give regions, cells, or boxes that hold centers of cells"};
    }
    return std::vector<Index>(cells.begin(), cells.end());
  }

  // A row lives in one region. Cells that rows should carry but no zone holds would have no bulk modulus.
  Result<void> check_zones(const BodyData& body, const std::vector<VolumeRegion>& list,
                           const std::vector<std::vector<Index>>& chosen) const {
    if (def_.space != VolumeSpace::zone) return {};
    constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    std::vector<std::size_t> region_of(at(body.mesh.cell_count()), kNone);
    std::vector<bool> covered(at(body.mesh.cell_count()), false);
    for (std::size_t v = 0; v < list.size(); ++v) {
      for (const Index c : list[v].pool->data().cell) region_of[at(c)] = v;
    }
    for (std::size_t z = 0; z < chosen.size(); ++z) {
      const VolumeZone& zone = def_.zones[z];
      for (const Index c : chosen[z]) {
        if (region_of[at(c)] != region_of[at(chosen[z].front())] || region_of[at(c)] == kNone) {
          return Error{who() + "zone \"" + zone.name + "\": cells " + std::to_string(chosen[z].front()) +
                       " and " + std::to_string(c) +
                       " are not in one region that has these volume rows; make one zone a region"};
        }
        covered[at(c)] = covered[at(c)] || (zone.compliance > 0 && std::isfinite(zone.compliance));
      }
    }
    if (!def_.carries_bulk || def_.hard) return {};
    Index missing = 0, example = -1;
    for (std::size_t c = 0; c < covered.size(); ++c) {
      if (region_of[c] == kNone || covered[c] || list[region_of[c]].inverse_bulk == 0) continue;
      if (missing++ == 0) example = static_cast<Index>(c);
    }
    if (missing == 0) return {};
    return Error{who() + std::to_string(missing) + " cells, cell " + std::to_string(example) +
                 " the first, are in no compliant zone and would have no bulk modulus; add a zone for them, "
                 "or set carries_bulk = false"};
  }

  // Hard zones make a pool of their own, which checks of hard rows look at as a whole.
  Result<void> add_zones(Builder& builder, const VolumeRegion& region,
                         const std::vector<std::vector<Index>>& chosen) const {
    const std::vector<Index>& cell = region.pool->data().cell;
    std::map<Index, Index> stencil_of;
    for (std::size_t s = 0; s < cell.size(); ++s) stencil_of[cell[s]] = static_cast<Index>(s);
    VolumeZones hard, compliant;
    std::vector<std::string> names;
    for (std::size_t z = 0; z < chosen.size(); ++z) {
      if (!stencil_of.count(chosen[z].front())) continue;
      const double compliance = def_.zones[z].compliance;
      const bool is_hard = compliance == 0 || (region.inverse_bulk == 0 && std::isfinite(compliance));
      VolumeZones& zones = is_hard ? hard : compliant;
      std::vector<Index> stencils;
      for (const Index c : chosen[z]) stencils.push_back(stencil_of.at(c));
      std::sort(stencils.begin(), stencils.end());
      zones.stencils.push_back(std::move(stencils));
      zones.compliance.push_back(is_hard ? 0 : compliance);
      if (is_hard) names.push_back(def_.zones[z].name);
    }
    if (auto r = check_independent(region, hard, names); !r) return r;
    for (const VolumeZones* zones : {&hard, &compliant}) {
      const auto rows = zone_volume_rows(region, *zones);
      if (rows->rows() > 0) add(builder, rows);
    }
    return {};
  }

  // A hard zone that the ones before it determine (the same cells, or a union of others) would leave its
  // pressure open. Gram-Schmidt on the zones' cells, each scaled by its volume.
  Result<void> check_independent(const VolumeRegion& region, const VolumeZones& zones,
                                 const std::vector<std::string>& names) const {
    std::vector<std::vector<double>> basis;
    for (std::size_t z = 0; z < zones.stencils.size(); ++z) {
      std::vector<double> v(at(region.pool->stencils()), 0);
      double size = 0;
      for (const Index s : zones.stencils[z]) {
        v[at(s)] = std::sqrt(region.pool->volume(s));
        size += region.pool->volume(s);
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
        return Error{who() + "hard zone \"" + names[z] +
                     "\" repeats what the hard zones before it say together; drop one of them, or give one "
                     "a compliance"};
      }
      for (double& c : v) c /= std::sqrt(rest);
      basis.push_back(std::move(v));
    }
    return {};
  }

  Index add(Builder& builder, const std::shared_ptr<RowPool>& rows) const {
    rows->treatment = def_.treatment;
    return builder.add_rows(rows);
  }

  // Row sums on the diagonal. Those of the stabilization are zero.
  static void lump(RowPool& rows) {
    std::vector<double> sum(at(rows.rows()), 0);
    for (const ComplianceEntry& e : rows.compliance) {
      sum[at(e.row)] += e.value;
      if (e.row != e.col) sum[at(e.col)] += e.value;
    }
    rows.compliance.clear();
    for (Index r = 0; r < rows.rows(); ++r) rows.compliance.push_back({r, r, sum[at(r)]});
  }

  VolumeDef def_;
};

}  // namespace

EffectPtr volume(VolumeDef def) {
  return std::make_shared<VolumeEffect>(std::move(def));
}

}  // namespace isochor
