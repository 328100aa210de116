#include "studies/formulations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace isochor::studies {

namespace {

constexpr std::array<Formulation, 12> kFormulations{{
    {"tet4", "Tet4, one field", Element::tet4, true, VolumeSpace::node, 1, false, kOneFieldPoisson},
    {"tet10", "Tet10, one field", Element::tet10, true, VolumeSpace::node, 1, false, kOneFieldPoisson},
    {"tet4_element", "Tet4, pressure per element", Element::tet4, false, VolumeSpace::element},
    {"tet4_node_plain", "Tet4, nodal pressure, not stabilized", Element::tet4, false, VolumeSpace::node, 0,
     false, kPlainPoisson},
    {"tet4_node", "Tet4, nodal pressure", Element::tet4, false, VolumeSpace::node},
    {"edge_node", "Tet4 edge-smoothed, nodal pressure", Element::tet4_edge_smoothed, false,
     VolumeSpace::node},
    {"tet10_element", "Tet10, pressure per element", Element::tet10, false, VolumeSpace::element},
    {"tet10_node", "Tet10, linear pressure", Element::tet10, false, VolumeSpace::node},
    {"hex8", "Hex8, one field", Element::hex8, true, VolumeSpace::node, 1, false, kOneFieldPoisson},
    {"hex8_element", "Hex8, pressure per element", Element::hex8, false, VolumeSpace::element},
    {"hex8_node", "Hex8, nodal pressure", Element::hex8, false, VolumeSpace::node},
    {"tet4_zone", "Tet4, one zone and penalty", Element::tet4, false, VolumeSpace::body, 1, true},
}};

// The local penalty beside a zone: lambda of this ratio, and how soon it stiffens, as in Sheen, Larionov &
// Pai (2021).
constexpr double kPenaltyPoisson = 0.45, kPenaltyBeta = 9;

double shear_modulus(const ElasticConstants& c) {
  return c.mu > 0 ? c.mu : c.young / (2 * (1 + c.poisson));
}

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
    SceneBody& body = scene.bodies[b];
    body.element = f.element;
    if (auto* box = std::get_if<BoxMeshDef>(&body.mesh))
      box->cell_type = f.hexahedra() ? CellType::hex8 : CellType::tet4;
    for (MaterialDef& m : body.materials) {
      m.compression_penalty = {};
      if (f.penalty)
        m.compression_penalty = {2 * shear_modulus(m.constants) * kPenaltyPoisson / (1 - 2 * kPenaltyPoisson),
                                 kPenaltyBeta};
    }
    rows[b].def.body = static_cast<BodyId>(b);
    if (b > 0) rows[b].def.name += " " + scene.bodies[b].name;
    rows[b].def.space = f.space;
    rows[b].def.stabilization = f.stabilization;
    rows[b].none = f.one_field;
  }
  scene.volumes = std::move(rows);
  if (f.most_poisson >= 0.5) return;
  for (const SceneBody& body : scene.bodies) {
    for (const MaterialDef& m : body.materials) {
      const ElasticConstants& c = m.constants;
      if (c.poisson >= 0.5 || std::isinf(c.bulk) || std::isinf(c.lambda)) {
        set_poisson(scene, f.most_poisson);
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
