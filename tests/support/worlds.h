// Short words for building worlds in tests. A refused part fails the test with its message.
#pragma once

#include <string>
#include <vector>

#include "catch.h"
#include "isochor/effects.h"
#include "isochor/mesh_io.h"
#include "isochor/schemes.h"
#include "isochor/world.h"
#include "support/meshes.h"

namespace test {

template <class T>
T value(isochor::Result<T> result) {
  if (!result) FAIL(result.error());
  return std::move(result).value();
}

inline void value(const isochor::Result<void>& result) {
  if (!result) FAIL(result.error());
}

inline isochor::MaterialPtr neo_hookean(double young, double poisson,
                                        isochor::BulkChoice bulk = isochor::BulkChoice::consistent) {
  isochor::ElasticConstants c;
  c.young = young;
  c.poisson = poisson;
  c.bulk_choice = bulk;
  return value(isochor::neo_hookean(c));
}

inline Mesh block(const Vec3& lower, const Vec3& upper, std::array<int, 3> cells,
                  isochor::CellType type = isochor::CellType::tet4) {
  isochor::BoxMeshDef def;
  def.lower = lower;
  def.upper = upper;
  def.divisions = cells;
  def.cell_type = type;
  return value(isochor::box_mesh(def));
}

inline isochor::WorldOptions static_options() {
  isochor::WorldOptions options;
  options.scheme = isochor::statics();
  options.threads = 1;
  return options;
}

inline isochor::WorldOptions dynamic_options() {
  isochor::WorldOptions options;
  options.scheme = isochor::implicit_euler();
  options.threads = 1;
  return options;
}

inline isochor::World make_world(const isochor::WorldOptions& options) {
  return value(isochor::World::create(options));
}

inline isochor::BodyId add_body(isochor::World& world, Mesh mesh, isochor::Element element,
                                const isochor::MaterialPtr& material, double density = 1000,
                                const std::string& name = "body") {
  isochor::BodyDef def;
  def.name = name;
  def.mesh = std::move(mesh);
  def.element = element;
  def.materials = {{"", material, density}};
  return value(world.add_body(def));
}

inline isochor::EffectId add_volume(isochor::World& world, isochor::BodyId body,
                                    isochor::VolumeSpace space = isochor::VolumeSpace::node) {
  isochor::VolumeDef def;
  def.body = body;
  def.space = space;
  return value(world.add(isochor::volume(def)));
}

// Holds (or moves) surfaces in some directions, all three when none is given.
inline isochor::EffectId hold(isochor::World& world, isochor::BodyId body, std::vector<std::string> surfaces,
                              std::vector<Vec3> directions = {}, Vec3 displacement = {},
                              isochor::Curve amount = isochor::Curve::ramp(1)) {
  isochor::DirichletDef def;
  def.name = "hold";
  for (const auto& s : surfaces) def.name += " " + s;
  def.where.body = body;
  def.where.surfaces = std::move(surfaces);
  def.directions = std::move(directions);
  def.displacement = displacement;
  def.amount = std::move(amount);
  return value(world.add(isochor::dirichlet(def)));
}

inline isochor::StepReport must_advance(isochor::World& world, double h = 1) {
  const isochor::StepReport report = world.advance(h);
  INFO(report.reason);
  REQUIRE(report.status == isochor::StepStatus::converged);
  return report;
}

inline double gauge(const isochor::World& world, const std::string& quantity) {
  for (const isochor::Gauge& g : world.gauges()) {
    if (g.quantity == quantity) return g.value;
  }
  FAIL("no gauge " << quantity);
  return 0;
}

inline Index nearest_node(std::span<const Vec3> rest, const Vec3& point) {
  Index best = 0;
  for (std::size_t i = 1; i < rest.size(); ++i) {
    const Vec3 d = rest[i] - point, b = rest[static_cast<std::size_t>(best)] - point;
    if (dot(d, d) < dot(b, b)) best = static_cast<Index>(i);
  }
  return best;
}

inline Vec3 displacement_at(const isochor::World& world, isochor::BodyId body, const Vec3& point) {
  const auto i = static_cast<std::size_t>(nearest_node(world.rest_positions(body), point));
  return world.positions(body)[i] - world.rest_positions(body)[i];
}

inline Mesh scene_mesh(const std::string& name) {
  std::string path = ISOCHOR_SCENES "/meshes/";
  return value(isochor::read_mesh(path.append(name).append(".msh")));
}

inline const char* name_of(isochor::Element e) {
  switch (e) {
    case isochor::Element::tet4:
      return "tet4";
    case isochor::Element::tet10:
      return "tet10";
    case isochor::Element::hex8:
      return "hex8";
    default:
      return "edge-smoothed";
  }
}
// Every element, with the cells that a mesh for it must have.
inline constexpr isochor::Element kAllElements[] = {isochor::Element::tet4,
                                                    isochor::Element::tet4_edge_smoothed,
                                                    isochor::Element::tet10, isochor::Element::hex8};
inline isochor::CellType cells_for(isochor::Element e) {
  return e == isochor::Element::hex8 ? isochor::CellType::hex8 : isochor::CellType::tet4;
}
inline constexpr isochor::Element kElements[] = {isochor::Element::tet4, isochor::Element::tet4_edge_smoothed,
                                                 isochor::Element::tet10};

}  // namespace test
