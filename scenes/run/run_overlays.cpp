#include "scenes/run/run_overlays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "constraints/contact/rigid/rigid_body.h"
#include "constraints/contact/shape/obstacle_shape.h"
#include "engine/mesh/cell_shape.h"
#include "isochor/painted.h"
#include "scenes/body_parts.h"
#include "scenes/material_fibers.h"

namespace isochor {

namespace {

constexpr int kAround = 32, kAlong = 12, kAcross = 4;  // kAcross: over a rounded edge

struct Triangles {
  std::vector<Vec3> points;
  std::vector<Index> corners;
  // A closed ribbon between two rings of the same size.
  void ribbon(Index a, Index b) {
    for (Index k = 0; k < kAround; ++k) {
      const Index n = (k + 1) % kAround;
      corners.insert(corners.end(), {a + k, a + n, b + k, a + n, b + n, b + k});
    }
  }
  Index ring(double radius, double z) {
    const auto first = static_cast<Index>(points.size());
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
    return first;
  }
  void cap(Index ring, double z, bool up) {
    const auto middle = static_cast<Index>(points.size());
    points.push_back({0, 0, z});
    for (Index k = 0; k < kAround; ++k) {
      const Index a = ring + k, b = ring + (k + 1) % kAround;
      if (up)
        corners.insert(corners.end(), {middle, a, b});
      else
        corners.insert(corners.end(), {middle, b, a});
    }
  }
};

// Rings from the lower to the upper pole; the middle of a capsule is straight.
Triangles round_shape(double radius, double straight) {
  Triangles t;
  Index last = -1;
  for (int half = 0; half < 2; ++half) {
    // Halves without a straight part share their ring.
    for (int k = half == 1 && straight == 0 ? 1 : 0; k <= kAlong / 2; ++k) {
      const double angle = 0.5 * std::numbers::pi * (half == 0 ? 2.0 * k / kAlong - 1 : 2.0 * k / kAlong);
      const double shift = (half == 0 ? -0.5 : 0.5) * straight;
      const Index ring = t.ring(radius * std::cos(angle), shift + radius * std::sin(angle));
      if (last >= 0) t.ribbon(last, ring);
      last = ring;
    }
  }
  return t;
}

// Caps joined to the side by quarters of a circle.
Triangles round_cylinder(double radius, double length, double rounding) {
  Triangles t;
  Index last = -1;
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; k <= kAcross; ++k) {
      const double angle = 0.5 * std::numbers::pi * (side < 0 ? k : kAcross - k) / kAcross;
      const double z = side * (0.5 * length - rounding * (1 - std::cos(angle)));
      const Index ring = t.ring(radius - rounding * (1 - std::sin(angle)), z);
      if (last < 0)
        t.cap(ring, z, false);
      else
        t.ribbon(last, ring);
      last = ring;
    }
  }
  t.cap(last, 0.5 * length, true);
  return t;
}

// A box whose surface is a grid, finer over the edges, and pulled to the distance `rounding` from a smaller
// box. Points on an edge of the grid's faces are one point, so that shading runs over it.
Triangles round_box(const Vec3& size, double rounding) {
  constexpr int n = 2 * kAcross + 2;
  Triangles t;
  std::map<std::array<int, 3>, Index> known;
  const auto point = [&](const std::array<int, 3>& at) {
    const auto [entry, fresh] = known.try_emplace(at, static_cast<Index>(t.points.size()));
    if (!fresh) return entry->second;
    Vec3 inner, out;
    for (int axis = 0; axis < 3; ++axis) {
      const int k = at[static_cast<std::size_t>(axis)];
      const bool low = 2 * k < n;
      const int steps = low ? kAcross - k : k - kAcross - 1;
      inner[axis] = (low ? -1 : 1) * (0.5 * size[axis] - rounding);
      out[axis] = (low ? -1 : 1) * std::tan(0.25 * std::numbers::pi * steps / kAcross);
    }
    t.points.push_back(inner + (rounding / std::sqrt(dot(out, out))) * out);
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      for (int i = 0; i + 1 < n; ++i) {
        for (int j = 0; j + 1 < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> at{};
            at[axis] = upper ? n - 1 : 0;
            at[(axis + 1) % 3] = i + di;
            at[(axis + 2) % 3] = j + dj;
            return point(at);
          };
          const Index a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (upper)
            t.corners.insert(t.corners.end(), {a, b, c, a, c, d});
          else
            t.corners.insert(t.corners.end(), {a, c, b, a, d, c});
        }
      }
    }
  }
  return t;
}

// A plane is drawn as a square of this size.
Triangles triangles_of(const Obstacle& o, double size) {
  Triangles t;
  switch (o.shape) {
    case ObstacleShape::plane:
      t.points = {{-size, -size, 0}, {size, -size, 0}, {size, size, 0}, {-size, size, 0}};
      t.corners = {0, 1, 2, 0, 2, 3};
      break;
    case ObstacleShape::sphere:
      return round_shape(o.radius, 0);
    case ObstacleShape::capsule:
      return round_shape(o.radius, o.length);
    case ObstacleShape::cylinder: {
      if (o.rounding > 0) return round_cylinder(o.radius, o.length, o.rounding);
      const Index low = t.ring(o.radius, -0.5 * o.length), high = t.ring(o.radius, 0.5 * o.length);
      t.ribbon(low, high);
      t.cap(low, -0.5 * o.length, false);
      t.cap(high, 0.5 * o.length, true);
      break;
    }
    case ObstacleShape::box:
      if (o.rounding > 0) return round_box(o.size, o.rounding);
      for (int k = 0; k < 8; ++k)
        t.points.push_back({(k & 1 ? 0.5 : -0.5) * o.size.x, (k & 2 ? 0.5 : -0.5) * o.size.y,
                            (k & 4 ? 0.5 : -0.5) * o.size.z});
      t.corners = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                   2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
      break;
    case ObstacleShape::mesh:
    case ObstacleShape::distance_field: {
      TriangleSurface s = o.solid->outline();
      return {std::move(s.points), std::move(s.triangles)};
    }
  }
  return t;
}

double gauge(const StepRecord& record, const std::string& effect, const char* quantity) {
  for (const Gauge& g : record.gauges) {
    if (g.effect == effect && g.kind == "rigid_body" && g.quantity == quantity) return g.value;
  }
  return 0;
}

// Turned about an axis, length of `turn` in radians (Rodrigues).
Vec3 turned(const Vec3& v, const Vec3& turn) {
  const double angle = std::sqrt(dot(turn, turn));
  if (!(angle > 0)) return v;
  const Vec3 a = (1 / angle) * turn;
  const Vec3 across{a.y * v.z - a.z * v.y, a.z * v.x - a.x * v.z, a.x * v.y - a.y * v.x};
  return std::cos(angle) * v + std::sin(angle) * across + (1 - std::cos(angle)) * dot(a, v) * a;
}

// Where a solid is: a pose, and of a free one how it has turned from there.
struct Place {
  ObstaclePose pose;
  Vec3 turn{};
  bool free = false;
  Vec3 to_world(const Vec3& y) const { return pose.position + turned(pose.R * y, turn); }
  Vec3 to_own(const Vec3& x) const {
    return transposed_times(pose.R, turned(x - pose.position, -1.0 * turn));
  }
};

Place place_of(const Obstacle& shape, const std::string& rigid, const StepRecord& record) {
  if (rigid.empty()) return {pose_of(shape, record.time), {}, false};
  Place p{pose_of(shape, 0), {}, true};
  p.pose.position = {gauge(record, rigid, "x"), gauge(record, rigid, "y"), gauge(record, rigid, "z")};
  p.turn = {gauge(record, rigid, "turn_x"), gauge(record, rigid, "turn_y"), gauge(record, rigid, "turn_z")};
  return p;
}

// Nodes of the surfaces named; of the whole mesh where none is (what is inside is not near an obstacle).
std::vector<Index> contact_nodes(const Mesh& mesh, const std::vector<std::string>& surfaces) {
  std::vector<Index> nodes;
  for (const MeshSurface& s : mesh.surfaces) {
    if (std::find(surfaces.begin(), surfaces.end(), s.name) != surfaces.end())
      nodes.insert(nodes.end(), s.faces.begin(), s.faces.end());
  }
  if (surfaces.empty()) nodes = mesh.cells;
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

Vec3 center_of(const Mesh& mesh, Index cell) {
  const auto stride = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const std::size_t corners = mesh.cell_type == CellType::hex8 ? 8 : 4;
  Vec3 sum{};
  for (std::size_t k = 0; k < corners; ++k)
    sum += mesh.nodes[static_cast<std::size_t>(mesh.cells[static_cast<std::size_t>(cell) * stride + k])];
  return (1.0 / static_cast<double>(corners)) * sum;
}

std::string region_of(const Mesh& mesh, Index cell) {
  const auto region = mesh.cell_region.empty()
                          ? std::size_t{0}
                          : static_cast<std::size_t>(mesh.cell_region[static_cast<std::size_t>(cell)]);
  return region < mesh.regions.size() ? mesh.regions[region] : std::string();
}

bool holds(const VolumeZone& zone, const Mesh& mesh, Index cell) {
  if (std::find(zone.cells.begin(), zone.cells.end(), cell) != zone.cells.end()) return true;
  const std::string region = region_of(mesh, cell);
  if (std::find(zone.regions.begin(), zone.regions.end(), region) != zone.regions.end()) return true;
  const Vec3 c = center_of(mesh, cell);
  return std::any_of(zone.boxes.begin(), zone.boxes.end(), [&](const std::array<Vec3, 2>& b) {
    return c.x >= b[0].x && c.y >= b[0].y && c.z >= b[0].z && c.x <= b[1].x && c.y <= b[1].y && c.z <= b[1].z;
  });
}

// Of each cell the zone it is in; of zones that overlap the first, of painted ones that with the largest
// weight. Null: none.
std::vector<const VolumeZone*> zone_of_cells(const VolumeDef& def, const Mesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.cell_count());
  std::vector<const VolumeZone*> out(count, nullptr);
  std::vector<const VolumeZone*> painted;
  std::vector<std::string> fields;
  for (const VolumeZone& zone : def.zones) {
    for (std::size_t c = 0; c < count; ++c) {
      if (!out[c] && holds(zone, mesh, static_cast<Index>(c))) out[c] = &zone;
    }
    if (zone.field.empty()) continue;
    painted.push_back(&zone);
    fields.push_back(zone.field);
  }
  if (fields.empty()) return out;
  // The scene has been compiled with this paint, so it is there; a page without the map would do no harm.
  const auto paint = painted_cells(mesh, fields, def.painted_surfaces, def.unpainted);
  if (!paint) return out;
  for (std::size_t c = 0; c < count; ++c) {
    double largest = 0;
    for (std::size_t f = 0; f < painted.size() && (!out[c] || largest > 0); ++f) {
      const double weight = paint.value().weight[f][c];
      if (weight <= largest) continue;
      largest = weight;
      out[c] = painted[f];
    }
  }
  return out;
}

std::size_t number_of(std::vector<std::string>& names, const std::string& name) {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it != names.end()) return static_cast<std::size_t>(it - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

}  // namespace

void RunOverlays::add_solid(const Obstacle& shape, const std::string& name, const std::string& rigid,
                            PageScene& scene) {
  Shown solid{shape, rigid, {}, {}};
  // A plane lies below the bodies, wherever its own origin is.
  Triangles t = triangles_of(shape, 0.75 * extent_);
  if (shape.shape == ObstacleShape::plane) {
    Vec3 shift = pose_of(shape, 0).to_own(middle_);
    shift.z = 0;
    for (Vec3& p : t.points) p = p + shift;
  }
  const auto first = static_cast<Index>(scene.rest.size()), part = static_cast<Index>(scene.parts.size());
  PagePart obstacle;
  obstacle.name = name;
  obstacle.obstacle = true;
  scene.parts.push_back(obstacle);
  const ObstaclePose pose = pose_of(shape, 0);
  for (const Vec3& p : t.points) scene.rest.push_back(pose.to_world(p));
  for (const Index k : t.corners) scene.triangles.push_back(first + k);
  scene.triangle_part.resize(scene.triangles.size() / 3, part);
  scene.triangle_edges.resize(scene.triangles.size() / 3, 0);
  solid.points = std::move(t.points);
  solids_.push_back(std::move(solid));
}

void RunOverlays::add_path(const RunView& view, BodyId body, const std::vector<Vec3>& points,
                           PageScene& scene, const std::string& name, std::optional<Vec3> from,
                           std::optional<Vec3> to) {
  Path path;
  path.body = static_cast<std::size_t>(body);
  path.from = from;
  path.to = to;
  const Mesh& mesh = view.built.world.mesh(view.built.bodies[path.body]);
  for (const Vec3& p : points) path.points.push_back(locate(mesh, p));
  PageLine line;
  line.name = name;
  scene.lines.push_back(line);
  paths_.push_back(std::move(path));
}

void RunOverlays::add_maps(const RunView& view, PageScene& scene,
                           const std::vector<std::vector<Index>>& triangle_cell) {
  const std::size_t triangles = scene.triangles.size() / 3;
  std::vector<std::string> regions, zones;
  std::vector<double> region_map(triangles, 0), zone_map(triangles, 0);
  if (view.scene.volumes) {
    for (const VolumeRows& rows : *view.scene.volumes) {
      if (rows.def.space == VolumeSpace::zone && zones.empty()) zones.emplace_back("no zone");
    }
  }
  std::size_t triangle = 0;
  for (std::size_t b = 0; b < triangle_cell.size(); ++b) {
    // A surface of its own has no cells to ask; its body stays without a map, and so do all.
    if (triangle_cell[b].empty()) return;
    const Mesh& mesh = view.built.world.mesh(view.built.bodies[b]);
    std::vector<std::vector<const VolumeZone*>> zone_of;
    for (std::size_t r = 0; !zones.empty() && r < view.scene.volumes->size(); ++r) {
      const VolumeDef& def = (*view.scene.volumes)[r].def;
      if (def.space == VolumeSpace::zone && static_cast<std::size_t>(def.body) == b)
        zone_of.push_back(zone_of_cells(def, mesh));
    }
    for (const Index cell : triangle_cell[b]) {
      std::string region = region_of(mesh, cell);
      if (triangle_cell.size() > 1) region = view.scene.bodies[b].name + ": " + region;
      region_map[triangle] = static_cast<double>(number_of(regions, region));
      for (const auto& of : zone_of) {
        const VolumeZone* zone = of[static_cast<std::size_t>(cell)];
        if (zone && zone_map[triangle] == 0)
          zone_map[triangle] = static_cast<double>(number_of(zones, zone->name));
      }
      ++triangle;
    }
  }
  const auto add = [&](const char* name, const char* label, const std::vector<std::string>& names,
                       std::vector<double> map) {
    if (names.size() < 2) return;
    PageField field;
    field.name = name;
    field.label = label;
    field.per_triangle = true;
    field.categories = names;
    scene.fields.push_back(field);
    maps_.push_back(std::move(map));
  };
  add("region", "Regions", regions, std::move(region_map));
  add("zone", "Volume zones", zones, std::move(zone_map));
}

void RunOverlays::start(const RunView& view, PageScene& scene,
                        const std::vector<std::vector<Index>>& triangle_cell) {
  Vec3 low = scene.rest.empty() ? Vec3{} : scene.rest.front(), high = low;
  for (const Vec3& p : scene.rest) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  middle_ = 0.5 * (low + high);
  extent_ = std::sqrt(dot(high - low, high - low));
  const SceneDef& s = view.scene;
  for (std::size_t r = 0; r < s.rigid_bodies.size(); ++r)
    add_solid(principal_form(view.built.rigid_shapes[r]), s.rigid_bodies[r].name, s.rigid_bodies[r].name,
              scene);
  for (std::size_t c = 0; c < s.contacts.size(); ++c) {
    const ContactDef& def = s.contacts[c];
    touched_.push_back(solids_.size());
    if (def.against.empty()) {
      add_solid(view.built.obstacles[c], def.name, "", scene);
      solids_.back().contact = c;
      continue;
    }
    for (std::size_t r = 0; r < s.rigid_bodies.size(); ++r) {
      if (s.rigid_bodies[r].name == def.against) touched_.back() = r;
    }
  }
  for (const CableDef& c : s.cables) add_path(view, c.body, c.points, scene, c.name, c.from, c.to);
  for (const WindingDef& w : s.windings) {
    for (const auto& path : w.paths) add_path(view, w.body, path, scene, w.name, {}, {});
  }
  add_maps(view, scene, triangle_cell);
  add_fibers(view, scene, triangle_cell);
}

namespace {

// The edges of a cell at its middle as columns, and the middle itself.
struct CellAxes {
  Vec3 middle{};
  std::array<Vec3, 3> edge{};
  Vec3 point(const Vec3& own) const { return middle + own.x * edge[0] + own.y * edge[1] + own.z * edge[2]; }
  // What it takes of the edges to make up v; none where the cell is flat.
  std::optional<Vec3> parts(const Vec3& v) const {
    const double det = dot(edge[0], cross(edge[1], edge[2]));
    if (!(std::abs(det) > 0)) return {};
    return (1 / det) * Vec3{dot(v, cross(edge[1], edge[2])), dot(v, cross(edge[2], edge[0])),
                            dot(v, cross(edge[0], edge[1]))};
  }
};

CellAxes axes_of(std::span<const Index> corners, std::span<const Vec3> x) {
  const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(corners[k])]; };
  CellAxes out;
  for (std::size_t k = 0; k < corners.size(); ++k)
    out.middle += (1.0 / static_cast<double>(corners.size())) * at(k);
  if (corners.size() == 4) {
    for (std::size_t k = 0; k < 3; ++k) out.edge[k] = at(k + 1) - at(0);
    return out;
  }
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t k = 0; k < 3; ++k) out.edge[k] += (0.25 * kHexSign[a][k]) * at(a);
  }
  return out;
}

// Of each cell the directions of the fibers in it at rest.
std::vector<std::vector<Vec3>> fibers_in_cells(const SceneBody& body, const std::string& folder,
                                               const Mesh& mesh, std::span<const Index> parent) {
  std::vector<std::vector<Vec3>> out(static_cast<std::size_t>(mesh.cell_count()));
  for (const MaterialDef& m : body.materials) {
    if (m.fibers.empty()) continue;
    const auto refined = refined_numbers(m, folder, parent);
    if (!refined) continue;
    const auto families = fibers_of(refined.value(), &mesh);
    if (!families) continue;  // a world with them would not have been built
    for (std::size_t c = 0; c < out.size(); ++c) {
      const std::string region = region_of(mesh, static_cast<Index>(c));
      const bool elsewhere = std::any_of(body.materials.begin(), body.materials.end(),
                                         [&](const MaterialDef& other) { return other.region == region; });
      if (m.region.empty() ? elsewhere && !region.empty() : m.region != region) continue;
      for (const FiberFamily& f : families.value()) {
        const Vec3 a = f.directions.empty() ? f.direction : f.directions[c];
        if (const double size = std::sqrt(dot(a, a)); size > 0) out[c].push_back((1 / size) * a);
      }
    }
  }
  return out;
}

}  // namespace

// On the surface and, for cuts, inside: so many that they can be told from each other.
void RunOverlays::add_fibers(const RunView& view, const PageScene& scene,
                             const std::vector<std::vector<Index>>& triangle_cell) {
  constexpr std::size_t most = 600;  // on the surface, and as many inside
  struct Spot {
    std::size_t body;
    Index cell;
    std::optional<Vec3> at;
  };
  std::vector<std::vector<std::vector<Vec3>>> directions;
  std::vector<Spot> outside, inside;
  std::size_t first = 0;
  for (std::size_t b = 0; b < triangle_cell.size(); ++b) {
    const Mesh& mesh = view.built.world.mesh(view.built.bodies[b]);
    directions.push_back(
        fibers_in_cells(view.scene.bodies[b], view.scene.folder, mesh, view.built.parents[b]));
    const auto& here = directions.back();
    for (std::size_t t = 0; t < triangle_cell[b].size(); ++t) {
      const Index cell = triangle_cell[b][t];
      if (here[static_cast<std::size_t>(cell)].empty()) continue;
      Vec3 at{};
      for (std::size_t k = 0; k < 3; ++k)
        at += (1.0 / 3) * scene.rest[static_cast<std::size_t>(scene.triangles[3 * (first + t) + k])];
      outside.push_back({b, cell, at});
    }
    for (std::size_t c = 0; c < here.size(); ++c) {
      if (!here[c].empty()) inside.push_back({b, static_cast<Index>(c), {}});
    }
    while (first < scene.triangle_part.size() && scene.triangle_part[first] == static_cast<Index>(b)) ++first;
  }
  const double half = 0.012 * extent_;
  for (const auto* spots : {&outside, &inside}) {
    const std::size_t stride = (spots->size() + most - 1) / most;
    for (std::size_t i = 0; i < spots->size(); i += stride) {
      const Spot& spot = (*spots)[i];
      const Mesh& mesh = view.built.world.mesh(view.built.bodies[spot.body]);
      Fiber fiber;
      fiber.body = spot.body;
      fiber.count = mesh.cell_type == CellType::hex8 ? 8 : 4;
      const auto stride_of_cell = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
      std::copy_n(mesh.cells.begin() +
                      static_cast<std::ptrdiff_t>(stride_of_cell * static_cast<std::size_t>(spot.cell)),
                  fiber.count, fiber.corners.begin());
      const CellAxes axes = axes_of(std::span(fiber.corners).first(fiber.count), mesh.nodes);
      for (const Vec3& a : directions[spot.body][static_cast<std::size_t>(spot.cell)]) {
        const auto along = axes.parts(half * a),
                   middle = axes.parts(spot.at.value_or(axes.middle) - axes.middle);
        if (!along || !middle) continue;
        fiber.along = *along;
        fiber.middle = *middle;
        fibers_.push_back(fiber);
      }
    }
  }
}

// What a contact does to a body, and lines along fibers.
void RunOverlays::append_arrows(const RunView& view, PageFrame& frame) const {
  const World& world = view.built.world;
  if (!view.scene.contacts.empty() || !view.scene.surface_contacts.empty()) {
    for (const ContactPoint& c : world.contacts())
      frame.forces.push_back({c.position, c.normal_force, c.friction});
  }
  for (const Fiber& f : fibers_) {
    const CellAxes axes =
        axes_of(std::span(f.corners).first(f.count), world.positions(view.built.bodies[f.body]));
    frame.fibers.push_back(axes.point(f.middle - f.along));
    frame.fibers.push_back(axes.point(f.middle + f.along));
  }
}

// An obstacle is where the built scene has it now, which may be elsewhere than it was at the start.
static Place now(const Obstacle& shape, const std::string& rigid, const std::optional<std::size_t>& contact,
                 const RunView& view, const StepRecord& record) {
  if (!contact) return place_of(shape, rigid, record);
  return {pose_of(shape, view.built.obstacles[*contact].motion, record.time), {}, false};
}

void RunOverlays::append(const RunView& view, PageFrame& frame) const {
  const StepRecord& record = view.result.records.back();
  const World& world = view.built.world;
  for (const Shown& solid : solids_) {
    const Place place = now(solid.shape, solid.rigid, solid.contact, view, record);
    for (const Vec3& y : solid.points) {
      frame.positions.push_back(place.to_world(y));
      for (auto& field : frame.fields) field.push_back(0);
    }
  }
  for (const auto& map : maps_) frame.fields.push_back(map);
  for (const Path& path : paths_) {
    const auto x = world.positions(view.built.bodies[path.body]);
    std::vector<Vec3> points;
    if (path.from) points.push_back(*path.from);
    for (const MaterialPoint& p : path.points) points.push_back(p.at(x));
    if (path.to) points.push_back(*path.to);
    frame.lines.push_back(std::move(points));
  }
  // Hard contacts meet their obstacle to the tolerance of the rows, soft ones sink into it.
  const double touching = 1e-5 * extent_;
  for (std::size_t k = 0; k < view.scene.contacts.size(); ++k) {
    const ContactDef& c = view.scene.contacts[k];
    if (!c.rigid.empty()) continue;
    const Shown& solid = solids_[touched_[k]];
    const Place place = now(solid.shape, solid.rigid, solid.contact, view, record);
    const BodyId id = view.built.bodies[static_cast<std::size_t>(c.body)];
    const auto x = world.positions(id);
    for (const Index n : contact_nodes(world.mesh(id), c.surfaces)) {
      const Vec3& p = x[static_cast<std::size_t>(n)];
      if (distance_value(solid.shape, place.to_own(p)) <= touching) frame.contacts.push_back(p);
    }
  }
  append_arrows(view, frame);
}

}  // namespace isochor
