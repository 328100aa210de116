// Bending, where elements lock: the cantilever and Cook's membrane.
#include <limits>

#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

namespace {

// A box mesh unless a study asks for an unstructured one.
SceneDef beam(const char* name, const char* title, const char* description, const SceneVariant& v) {
  SceneDef s = on_mesh(name, title, description, "beam", "", v);
  if (v.mesh.empty()) {
    const bool quadratic = v.element == Element::tet10;
    BoxMeshDef box;
    box.upper = {1, 0.1, 0.1};
    box.divisions = quadratic ? std::array{20, 2, 2} : std::array{40, 4, 4};
    s.bodies[0].mesh = box;
    s.dirichlet = {hold("wall", "x0")};
  } else {
    s.dirichlet = {hold("wall", "clamped")};
  }
  s.bodies[0].materials = {rubber(266e3, 0.5, 1070)};
  s.analysis.options.gravity_curve = Curve::ramp(1);
  s.analysis.steps = 1;
  s.probes = {{"tip", {}, {1, 0.05, 0.05}}};
  return s;
}

const char* const kTaylorHood = "Taylor-Hood reference, extrapolated";

}  // namespace

SceneDef cantilever(const SceneVariant& v) {
  SceneDef s =
      beam("cantilever", "Cantilever under gravity",
           "A soft beam of 0.1 x 0.1 x 1 m hangs down from its clamped end; the whole load in one step.", v);
  s.analysis.options.gravity = {0, -9.8, 0};
  s.metrics = {against(displacement("tip along", "tip", Component::x), -0.7553, 0.01, kTaylorHood),
               against(displacement("tip down", "tip", Component::y), -0.9395, 0.01, kTaylorHood)};
  keep_volume(s);
  return s;
}

SceneDef cantilever_tenth(const SceneVariant& v) {
  SceneDef s = beam("cantilever_tenth", "Cantilever under a tenth of gravity",
                    "A soft beam of 0.1 x 0.1 x 1 m under a tenth of gravity, where bending decides.", v);
  s.analysis.options.gravity = {0, -0.98, 0};
  s.metrics = {against(displacement("tip along", "tip", Component::x), -0.1381, 0.02, kTaylorHood),
               against(displacement("tip down", "tip", Component::y), -0.4763, 0.01, kTaylorHood)};
  keep_volume(s);
  return s;
}

namespace {

SceneDef membrane(const char* name, const char* title, const char* description, const char* mesh,
                  const SceneVariant& v) {
  SceneDef s = on_mesh(name, title, description, "panel", mesh, v);
  MaterialDef m;
  m.constants.mu = 80.194e6;
  m.constants.bulk = std::numeric_limits<double>::infinity();
  s.bodies[0].materials = {m};
  s.dirichlet = {hold("wall", "clamped")};
  TractionDef t;
  t.name = "shear";
  t.surface = "loaded";
  t.traction = {0, 6.25e6, 0};
  t.amount = Curve::ramp(1);
  s.tractions = {t};
  s.analysis.steps = 1;
  return s;
}

MetricDef millimeters(MetricDef m) {
  m.scale = 1e3;
  m.unit = "mm";
  return m;
}

}  // namespace

SceneDef cook(const SceneVariant& v) {
  SceneDef s =
      membrane("cook", "Cook's membrane in 3D",
               "A tapered panel 10 mm thick, one edge clamped, sheared at the other.", "cook3d_2_tet10", v);
  s.bodies[0].element = v.element.value_or(Element::tet10);
  s.probes = {{"corner", {}, {0.048, 0.060, 0.005}}, {"edge", {}, {0.048, 0.052, 0.005}}};
  s.metrics = {
      against(millimeters(displacement("corner up", "corner", Component::y)), 8.348, 0.01, kTaylorHood),
      against(millimeters(displacement("edge middle up", "edge", Component::y)), 8.510, 0.01, kTaylorHood)};
  keep_volume(s);
  return s;
}

SceneDef cook_plane(const SceneVariant& v) {
  SceneDef s = membrane("cook_plane", "Cook's membrane in plane strain",
                        "A tapered panel held in its plane, one edge clamped, sheared at the other.",
                        "cook_plane_1", v);
  s.dirichlet.push_back(hold("plane", "faces", {{0, 0, 1}}));
  s.probes = {{"corner", {}, {0.048, 0.060, 0}}, {"edge", {}, {0.048, 0.052, 0}}};
  s.metrics = {
      against(millimeters(displacement("corner up", "corner", Component::y)), 6.934, 0.01, kTaylorHood),
      against(millimeters(displacement("edge middle up", "edge", Component::y)), 6.962, 0.01, kTaylorHood)};
  keep_volume(s);
  return s;
}

}  // namespace isochor
