#include "studies/formulations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace isochor::studies {

namespace {

constexpr std::array<Formulation, 8> kFormulations{{
    {"tet4", "Tet4, one field", Element::tet4, true},
    {"tet10", "Tet10, one field", Element::tet10, true},
    {"tet4_element", "Tet4, pressure per element", Element::tet4, false, VolumeSpace::element},
    {"tet4_node_plain", "Tet4, nodal pressure, not stabilized", Element::tet4, false, VolumeSpace::node, 0},
    {"tet4_node", "Tet4, nodal pressure", Element::tet4, false, VolumeSpace::node},
    {"edge_node", "Tet4 edge-smoothed, nodal pressure", Element::tet4_edge_smoothed, false,
     VolumeSpace::node},
    {"tet10_element", "Tet10, pressure per element", Element::tet10, false, VolumeSpace::element},
    {"tet10_node", "Tet10, linear pressure", Element::tet10, false, VolumeSpace::node},
}};

}  // namespace

std::span<const Formulation> formulations() {
  return kFormulations;
}

const Formulation& formulation(std::string_view name) {
  const auto it =
      std::find_if(kFormulations.begin(), kFormulations.end(), [&](const auto& f) { return f.name == name; });
  return it == kFormulations.end() ? kFormulations.front() : *it;
}

void apply(const Formulation& f, SceneDef& scene) {
  std::vector<VolumeRows> rows(scene.bodies.size());
  for (std::size_t b = 0; b < rows.size(); ++b) {
    scene.bodies[b].element = f.element;
    rows[b].def.body = static_cast<BodyId>(b);
    if (b > 0) rows[b].def.name += " " + scene.bodies[b].name;
    rows[b].def.space = f.space;
    rows[b].def.stabilization = f.stabilization;
    rows[b].none = f.one_field;
  }
  scene.volumes = std::move(rows);
  if (!f.one_field) return;
  for (const SceneBody& body : scene.bodies) {
    for (const MaterialDef& m : body.materials) {
      const ElasticConstants& c = m.constants;
      if (c.poisson >= 0.5 || std::isinf(c.bulk) || std::isinf(c.lambda)) {
        set_poisson(scene, kOneFieldPoisson);
        return;
      }
    }
  }
}

void set_poisson(SceneDef& scene, double nu) {
  for (SceneBody& body : scene.bodies) {
    for (MaterialDef& m : body.materials) {
      const ElasticConstants old = m.constants;
      m.constants = {};
      if (old.young > 0) {
        m.constants.young = old.young;
        m.constants.poisson = nu;
      } else {
        m.constants.mu = old.mu;
        m.constants.bulk =
            nu < 0.5 ? 2 * old.mu * (1 + nu) / (3 * (1 - 2 * nu)) : std::numeric_limits<double>::infinity();
      }
      m.constants.bulk_choice = BulkChoice::bulk_modulus;
    }
  }
}

}  // namespace isochor::studies
