// A block with a chamber inside, held, blown up, pulled by a cable, pushed and heavy: for derivatives, where
// everything is to depend on everything. What can be moved are its knobs.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>

#include "isochor/viscoelastic.h"
#include "support/worlds.h"

namespace test {

using isochor::BodyId;
using isochor::EffectId;
using isochor::World;

struct Knobs {
  double young = 1e4, poisson = 0.3, density = 1000, stiffness = 1;
  double gravity = -2;             // along z
  double clamp = 1;                // of a displacement by (0, 0.02, 0.01)
  double cavity = 400;             // pressure [Pa], or volume over that at rest
  double cable = 0.97;             // length over that at rest
  double spring = 900;             // of the cable [N/m]
  double push = 1;                 // of a force
  double shape = 0;                // of shape_motion()
  double viscosity = 0, drag = 0;  // of a damping [Pa s], [1/s]
  double velocity = 0;             // of shape_motion(), at the start [1/s]
  double late = 600;               // of a cavity whose pressure changes: what it gets to
  double ratio = 0, fades = 0.07;  // of a Prony series: a share, and its time [s]
  std::vector<double> field;       // stiffness of cells; empty: uniform
};
inline constexpr Vec3 kPushed{1, 1. / 3, 1. / 3}, kPush{1, 4, 6};  // at a node

struct Kind {
  isochor::Element element = isochor::Element::tet4;
  isochor::VolumeSpace space = isochor::VolumeSpace::node;
  isochor::CavityControl control = isochor::CavityControl::pressure;
  double guard = 0;       // stiffness of an element guard that acts everywhere; 0: as it is by default
  bool pulled = true;     // by the cable
  bool changing = false;  // the cavity's amount, in time
};

struct Block {
  Knobs knobs;
  Kind kind;
  World world;
  BodyId body{};
  EffectId clamp{}, cavity{}, cable{}, damping{};
};

inline isochor::WorldOptions tight_statics() {
  isochor::WorldOptions options = static_options();
  options.force_tolerance = 1e-13;
  options.row_tolerance = 1e-13;
  return options;
}

// 3 x 3 x 3 cubes without the one in the middle, whose sides are the surface "hollow".
inline Mesh hollow_block(isochor::CellType type) {
  Mesh mesh = block({0, 0, 0}, {1, 1, 1}, {3, 3, 3}, type);
  const auto per = static_cast<std::size_t>(isochor::nodes_per_cell(type));
  using Side = std::vector<Index>;
  const std::vector<std::vector<std::size_t>> sides =
      type == isochor::CellType::hex8
          ? std::vector<std::vector<std::size_t>>{{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                  {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}
          : std::vector<std::vector<std::size_t>>{{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}};
  std::map<Side, std::pair<Side, int>> found;
  std::vector<Index> kept;
  for (std::size_t c = 0; c < mesh.cells.size(); c += per) {
    Vec3 middle{};
    for (std::size_t k = 0; k < per; ++k)
      middle += (1.0 / static_cast<double>(per)) * mesh.nodes[static_cast<std::size_t>(mesh.cells[c + k])];
    const auto first = mesh.cells.begin() + static_cast<std::ptrdiff_t>(c);
    const auto inside = [](double v) { return v > 1. / 3 && v < 2. / 3; };
    if (!inside(middle.x) || !inside(middle.y) || !inside(middle.z)) {
      kept.insert(kept.end(), first, first + static_cast<std::ptrdiff_t>(per));
      continue;
    }
    for (const auto& side : sides) {
      Side nodes;
      for (const std::size_t k : side) nodes.push_back(mesh.cells[c + k]);
      Side key = nodes;
      std::sort(key.begin(), key.end());
      found[key].first = nodes;
      ++found[key].second;
    }
  }
  mesh.cells = std::move(kept);
  if (!mesh.cell_region.empty()) mesh.cell_region.assign(mesh.cells.size() / per, 0);
  isochor::MeshSurface hollow{"hollow", {}};
  for (const auto& [key, side] : found) {
    if (side.second == 1) hollow.faces.insert(hollow.faces.end(), side.first.begin(), side.first.end());
  }
  mesh.surfaces.push_back(std::move(hollow));
  return mesh;
}

// How rest positions move along the knob `shape`: smooth, and different everywhere.
inline Vec3 shape_motion(const Vec3& X) {
  return {0.3 * X.x + 0.1 * X.y * X.z, 0.2 * X.x * X.x - 0.1 * X.z, 0.4 * X.z * X.x + 0.1 * X.y};
}
inline std::vector<Vec3> shape_motion(const Mesh& mesh) {
  std::vector<Vec3> out;
  for (const Vec3& X : mesh.nodes) out.push_back(shape_motion(X));
  return out;
}

inline isochor::Result<isochor::MaterialPtr> material_of(double young, double poisson, const Knobs& knobs) {
  isochor::ElasticConstants c;
  c.young = young;
  c.poisson = poisson;
  if (knobs.ratio > 0) {
    auto base = isochor::isochoric_neo_hookean(c);
    if (!base) return base;
    return isochor::with_prony_series(base.value(), {{knobs.ratio, knobs.fades}, {0.2, 0.02}},
                                      isochor::StaticTime::seconds);
  }
  auto made = isochor::neo_hookean(c);
  if (!made || (knobs.field.empty() && knobs.stiffness == 1)) return made;
  std::vector<double> field = knobs.field;
  if (field.empty()) {
    c.young *= knobs.stiffness;
    return isochor::neo_hookean(c);
  }
  for (double& f : field) f *= knobs.stiffness;
  return isochor::with_stiffness_field(made.value(), std::move(field));
}

inline isochor::CableDef cable_of(const Knobs& knobs, const Kind&) {
  isochor::CableDef def;
  def.points = {{0.1, 0.5, 0.9}, {0.5, 0.45, 0.85}, {0.9, 0.5, 0.85}};  // inside of cells
  def.from = Vec3{-0.2, 0.5, 1};
  def.amount = isochor::Curve::constant(knobs.cable);
  def.stiffness = knobs.spring;
  return def;
}

inline isochor::Curve cavity_curve(const Knobs& knobs, const Kind& kind) {
  if (!kind.changing) return isochor::Curve::constant(knobs.cavity);
  return {{{0.02, knobs.cavity}, {0.12, knobs.late}}};
}

inline isochor::DampingDef damping_of(const Knobs& knobs) {
  isochor::DampingDef def;
  def.viscosity = knobs.viscosity;
  def.mass_rate = knobs.drag;
  return def;
}

// At rest, or as it begins to move.
inline Block build_block(const Knobs& knobs, const Kind& kind,
                         isochor::WorldOptions options = tight_statics()) {
  options.gravity = {0, 0, knobs.gravity};
  options.gravity_curve = isochor::Curve::constant(1);
  Block b{knobs, kind, make_world(options)};
  Mesh mesh = hollow_block(cells_for(kind.element));
  if (kind.element == isochor::Element::tet10) mesh = isochor::to_tet10(mesh);
  const std::vector<Vec3> motion = shape_motion(mesh);
  for (std::size_t n = 0; n < motion.size(); ++n) mesh.nodes[n] += knobs.shape * motion[n];
  isochor::BodyDef def;
  def.mesh = std::move(mesh);
  def.element = kind.element;
  def.materials = {{"", value(material_of(knobs.young, knobs.poisson, knobs)), knobs.density}};
  if (kind.guard > 0) {
    def.guard_stiffness = kind.guard;
    def.guard_threshold = 1.5;
  }
  b.body = value(b.world.add_body(std::move(def)));
  add_volume(b.world, b.body, kind.space);
  b.clamp = hold(b.world, b.body, {"x0"}, {}, {0, 0.02, 0.01}, isochor::Curve::constant(knobs.clamp));
  isochor::CavityDef cavity;
  cavity.body = b.body;
  cavity.surfaces = {"hollow"};
  cavity.control = kind.control;
  cavity.amount = cavity_curve(knobs, kind);
  b.cavity = value(b.world.add(isochor::cavity(cavity)));
  if (kind.pulled) {
    isochor::CableDef cable = cable_of(knobs, kind);
    cable.body = b.body;
    b.cable = value(b.world.add(isochor::cable(cable)));
  }
  if (knobs.viscosity > 0 || knobs.drag > 0) {
    isochor::DampingDef damping = damping_of(knobs);
    damping.body = b.body;
    b.damping = value(b.world.add(isochor::damping(damping)));
  }
  value(b.world.add_force_at(b.body, kPushed + knobs.shape * shape_motion(kPushed), knobs.push * kPush));
  if (knobs.velocity != 0) {
    std::vector<Vec3> velocities = motion;
    for (Vec3& v : velocities) v = knobs.velocity * v;
    value(b.world.set_velocities(b.body, velocities));
  }
  return b;
}

// In balance.
inline Block make_block(const Knobs& knobs, const Kind& kind) {
  Block b = build_block(knobs, kind);
  must_advance(b.world);
  must_advance(b.world, 0.01);
  return b;
}

}  // namespace test
