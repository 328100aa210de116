// What the scenes' programs share.
#pragma once

#include <string>

#include "scenes/library.h"

namespace isochor::programs {

// A scene of one body from scenes/meshes.
inline SceneDef on_mesh(const char* name, const char* title, const char* description, const char* body,
                        const char* mesh, const SceneVariant& variant) {
  SceneDef scene;
  scene.name = name;
  scene.title = title;
  scene.description = description;
  scene.folder = scenes_folder();
  SceneBody b;
  b.name = body;
  b.mesh = MeshFile{"meshes/" + (variant.mesh.empty() ? mesh : variant.mesh) + ".msh", 1};
  b.element = variant.element.value_or(Element::tet4_edge_smoothed);
  scene.bodies.push_back(std::move(b));
  return scene;
}

inline MaterialDef rubber(double young, double poisson, double density = 1000, const char* region = "") {
  MaterialDef m;
  m.region = region;
  m.constants.young = young;
  m.constants.poisson = poisson;
  m.density = density;
  return m;
}

inline DirichletDef hold(const char* name, const char* surface, std::vector<Vec3> directions = {}) {
  DirichletDef d;
  d.name = name;
  d.where.surfaces = {surface};
  d.directions = std::move(directions);
  return d;
}

inline CavityDef chamber(const char* surface, double pressure) {
  CavityDef c;
  c.name = "chamber";
  c.surfaces = {surface};
  c.amount = Curve::ramp(pressure);
  return c;
}

inline MetricDef displacement(const char* name, const char* probe, Component component) {
  MetricDef m;
  m.name = name;
  m.of = probe;
  m.component = component;
  m.unit = "m";
  return m;
}

inline MetricDef against(MetricDef m, double reference, double tolerance, const char* source) {
  m.reference = reference;
  m.tolerance = tolerance;
  m.source = source;
  return m;
}

inline MetricDef pressure(const char* name, const char* cavity) {
  MetricDef m;
  m.name = name;
  m.quantity = Quantity::cavity_pressure;
  m.of = cavity;
  m.unit = "Pa";
  return m;
}

inline MetricDef at_time(MetricDef m, double time) {
  m.time = time;
  return m;
}

// The metrics that every robot has: how much its chamber swells, and what its volume rows must meet.
inline void add_robot_metrics(SceneDef& scene) {
  MetricDef swelling;
  swelling.name = "chamber volume";
  swelling.quantity = Quantity::cavity_volume;
  swelling.of = "chamber";
  swelling.scale = 1e6;
  swelling.unit = "cm^3";
  scene.metrics.push_back(swelling);
}

inline void keep_volume(SceneDef& scene) {
  MetricDef m;
  m.name = "left by volume rows";
  m.quantity = Quantity::volume_row_residual;
  m.reference = 0;
  m.tolerance = 1e-9;
  m.source = "rows are met";
  scene.metrics.push_back(m);
}

}  // namespace isochor::programs
