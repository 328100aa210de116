#include "isochor/effects/volume.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "constraints/volume/volume_zones.h"
#include "engine/base/text.h"
#include "engine/elements/volume_strain.h"

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
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (!std::isfinite(def_.stabilization) || def_.stabilization < 0) {
      return Error{who() + "stabilization = " + number(def_.stabilization) +
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
        return Error{who() + "zone \"" + z.name + "\": compliance = " + number(z.compliance) +
                     "; it must be 0 (hard), 1 (as the material says), any positive factor or infinity (no "
                     "row)"};
      }
    }
    const bool painted = std::any_of(def_.zones.begin(), def_.zones.end(),
                                     [](const VolumeZone& z) { return !z.field.empty(); });
    if (!painted && (def_.unpainted != UnpaintedCells::none || !def_.painted_surfaces.empty())) {
      return Error{who() + "unpainted and painted_surfaces are for zones with a field; give a zone one"};
    }
    if (def_.across_regions && def_.space != VolumeSpace::body && def_.space != VolumeSpace::zone) {
      return Error{who() + "across_regions is for the spaces body and zone; drop it or change space"};
    }
    if (def_.lumped_compliance && (def_.space != VolumeSpace::node || def_.hard)) {
      return Error{
          who() +
          "lumped_compliance is for compliant rows per node; drop it, or use space node without hard"};
    }
    if (is_of_mean(def_.strain) && def_.space == VolumeSpace::node) {
      return Error{who() +
                   "strain is that of the mean of J over cells, but the rows are those of nodes; take "
                   "logarithmic or mixed, or another space"};
    }
    return {};
  }

  Result<void> declare(Builder& builder) const override {
    auto regions = builder.regions(def_.body, def_.regions, def_.name);
    if (!regions) return regions.failure();
    for (const std::size_t r : regions.value()) {
      const MaterialModel& material = *builder.body(def_.body).regions[r].material;
      if (std::isinf(material.inverse_bulk()) && !def_.hard) {
        // kappa = 0: the rows would carry no pressure at all.
        if (def_.carries_bulk) builder.claim_bulk(def_.body, r);
        continue;
      }
      // Rows over several regions have a pool of their own.
      if (!def_.across_regions) builder.want_volume(def_.body, r, strain_in(def_, material));
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
    if (!regions) return regions.failure();
    const BodyData& body = builder.body(def_.body);
    std::vector<VolumeRegion> list;
    if (def_.across_regions) {
      auto all = region_across(builder, def_, regions.value());
      if (!all) return Error{who() + all.error()};
      if (all.value().pool) list.push_back(std::move(all).value());
    } else {
      list = separate_regions(builder, body, regions.value());
    }
    auto instance = std::make_unique<VolumeInstance>();
    if (def_.space == VolumeSpace::zone) {
      auto zones = zone_rows(builder, def_, list);
      if (!zones) return Error{who() + zones.error()};
      for (const auto& rows : zones.value()) add(builder, rows);
    } else {
      for (const VolumeRegion& v : list) add_rows(builder, body, v, *instance);
    }
    return std::unique_ptr<EffectInstance>(std::move(instance));
  }

 private:
  std::string who() const { return "volume \"" + def_.name + "\": "; }

  std::vector<VolumeRegion> separate_regions(const Builder& builder, const BodyData& body,
                                             std::span<const std::size_t> regions) const {
    std::vector<VolumeRegion> list;
    for (const std::size_t r : regions) {
      const RegionData& region = body.regions[r];
      const VolumeStrain strain = strain_in(def_, *region.material);
      const Index pool = region.volume_pool[static_cast<std::size_t>(strain)];
      // Rows of another effect may have asked for the pool; without a bulk modulus these carry nothing.
      if (pool < 0 || (std::isinf(region.material->inverse_bulk()) && !def_.hard)) continue;
      VolumeRegion v;
      v.name = def_.name + (body.regions.size() > 1 ? "/" + region.name : "");
      v.stencil_pool = pool;
      v.strain = strain;
      v.pool = &builder.solid(pool);
      v.corners = body.reference->corners;
      v.inverse_bulk = def_.hard ? 0 : region.material->inverse_bulk();
      v.shear_modulus = region.material->shear_modulus();
      v.material = region.material->field_cells() > 0 ? region.material.get() : nullptr;
      list.push_back(std::move(v));
    }
    return list;
  }

  void add_rows(Builder& builder, const BodyData& body, const VolumeRegion& region,
                VolumeInstance& instance) const {
    const bool equal_order = body.element != Element::tet10;
    switch (def_.space) {
      case VolumeSpace::node: {
        std::vector<Index> nodes;
        const auto rows = nodal_volume_rows(region, equal_order ? def_.stabilization : 0, &nodes);
        if (def_.lumped_compliance) rows->lump();
        const Index pool = add(builder, rows);
        if (region.strain == VolumeStrain::linear && def_.carries_bulk && !region.pool->growth()) {
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
        break;  // zone_rows
    }
  }

  Index add(Builder& builder, const std::shared_ptr<RowPool>& rows) const {
    rows->treatment = def_.treatment;
    return builder.add_rows(rows);
  }

  VolumeDef def_;
};

}  // namespace

EffectPtr volume(VolumeDef def) {
  return std::make_shared<VolumeEffect>(std::move(def));
}

}  // namespace isochor
