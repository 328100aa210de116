#include "scenes/run/page_shape.h"

#include <algorithm>
#include <cmath>

#include "engine/mesh/cell_shape.h"
#include "page_surface.h"
#include "scenes/run/error_places.h"

namespace isochor {

namespace {

// Mean of the cells around each node: what a surface with colors at vertices can show.
std::vector<double> at_nodes(const Mesh& mesh, const std::vector<double>& cells) {
  std::vector<double> sum(mesh.nodes.size(), 0), count(mesh.nodes.size(), 0);
  const auto stride = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    const auto n = static_cast<std::size_t>(mesh.cells[i]);
    sum[n] += cells[i / stride];
    count[n] += 1;
  }
  for (std::size_t n = 0; n < sum.size(); ++n) sum[n] /= std::max(count[n], 1.0);
  return sum;
}

// By the corners.
std::vector<double> cell_volumes(const Mesh& mesh) {
  std::vector<double> out;
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  for (std::size_t c = 0; c < mesh.cells.size(); c += per) {
    const auto tet = [&](const std::array<std::size_t, 4>& a) {
      const auto x = [&](std::size_t i) {
        return mesh.nodes[static_cast<std::size_t>(mesh.cells[c + a[i]])];
      };
      return dot(cross(x(1) - x(0), x(2) - x(0)), x(3) - x(0)) / 6;
    };
    double volume = 0;
    if (mesh.cell_type == CellType::hex8) {
      for (const auto& corners : kHexTets) volume += tet(corners);
    } else {
      volume = tet({0, 1, 2, 3});
    }
    out.push_back(volume);
  }
  return out;
}

// What the nodes of a cell say at a point in it.
template <class Read>
auto interpolated(const EmbeddedPoint& p, const Read& read) {
  auto sum = p.weights[0] * read(static_cast<std::size_t>(p.nodes[0]));
  for (std::size_t a = 1; a < 8; ++a) sum += p.weights[a] * read(static_cast<std::size_t>(p.nodes[a]));
  return sum;
}

}  // namespace

char up_axis(const SceneDef& scene) {
  return std::abs(scene.analysis.options.gravity.z) > std::abs(scene.analysis.options.gravity.y) ? 'z' : 'y';
}

bool has_contact(const SceneDef& scene) {
  return !scene.contacts.empty() || !scene.surface_contacts.empty();
}

std::vector<PageField> page_fields(const SceneDef& scene, bool origins) {
  std::vector<PageField> fields(4);
  fields[0].name = "displacement";
  fields[0].label = "Displacement";
  fields[0].unit = "m";
  fields[1].name = "pressure";
  fields[1].label = "Mean stress";
  fields[1].unit = "Pa";
  fields[1].diverging = true;
  fields[2].name = "von_mises";
  fields[2].label = "Von Mises stress";
  fields[2].unit = "Pa";
  fields[3].name = "J";
  fields[3].label = "Volume ratio J";
  fields[3].diverging = true;
  fields[3].center = 1;
  if (has_contact(scene)) fields.push_back({"contact_pressure", "Contact pressure", "Pa"});
  if (origins) fields.push_back({"error_share", "Share in the error, times the mean", ""});
  return fields;
}

namespace {

// The surface in a lattice as a part of its own, in place of the cubes.
std::vector<EmbeddedPoint> add_page_surface(PageScene& scene, const Mesh& mesh, const DisplaySurface& surface,
                                            const PagePart& part) {
  const auto first = static_cast<Index>(scene.rest.size()), number = static_cast<Index>(scene.parts.size());
  scene.parts.push_back(part);
  for (const EmbeddedPoint& p : surface.points)
    scene.rest.push_back(interpolated(p, [&](std::size_t n) { return mesh.nodes[n]; }));
  for (const Index i : surface.triangles) scene.triangles.push_back(first + i);
  scene.triangle_part.resize(scene.triangles.size() / 3, number);
  scene.triangle_edges.resize(scene.triangles.size() / 3, 7);
  return surface.points;
}

}  // namespace

namespace {

// Triangles of the bodies that bound a chamber, all of their corners being nodes of its surfaces; all
// triangles where there is none.
std::vector<Index> triangles_to_cut(const RunView& view, const PageScene& scene,
                                    std::span<const std::vector<Index>> node_of_vertex) {
  std::vector<bool> on_chamber(scene.rest.size(), false);
  std::size_t first = 0;
  for (std::size_t b = 0; b < node_of_vertex.size(); ++b) {
    const Mesh& mesh = view.built.world.mesh(view.built.bodies[b]);
    std::vector<bool> wall(mesh.nodes.size(), false);
    for (const CavityDef& cavity : view.scene.cavities) {
      if (static_cast<std::size_t>(cavity.body) != b) continue;
      for (const MeshSurface& s : mesh.surfaces) {
        if (std::find(cavity.surfaces.begin(), cavity.surfaces.end(), s.name) == cavity.surfaces.end())
          continue;
        for (const Index n : s.faces) wall[static_cast<std::size_t>(n)] = true;
      }
    }
    for (std::size_t v = 0; v < node_of_vertex[b].size(); ++v)
      on_chamber[first + v] = wall[static_cast<std::size_t>(node_of_vertex[b][v])];
    first += node_of_vertex[b].size();
  }
  std::vector<Index> out;
  for (std::size_t t = 0; t < scene.triangles.size(); t += 3) {
    const auto corners = std::span(scene.triangles).subspan(t, 3);
    if (std::all_of(corners.begin(), corners.end(),
                    [&](Index v) { return on_chamber[static_cast<std::size_t>(v)]; }))
      out.insert(out.end(), corners.begin(), corners.end());
  }
  return out.empty() ? scene.triangles : out;
}

}  // namespace

PageShape::PageShape(const RunView& view) {
  std::vector<std::vector<Index>> triangle_cell(view.built.bodies.size());
  for (std::size_t b = 0; b < view.built.bodies.size(); ++b) {
    PagePart part;
    part.name = view.scene.bodies[b].name;
    const Mesh& mesh = view.built.world.mesh(view.built.bodies[b]);
    const DisplaySurface& surface = view.built.surfaces[b];
    PageMeshOptions options;
    options.triangle_cell = &triangle_cell[b];
    if (surface.points.empty())
      vertices_.push_back({add_page_mesh(scene_, mesh, part, options), {}});
    else
      vertices_.push_back({{}, add_page_surface(scene_, mesh, surface, part)});
  }
  std::vector<std::vector<Index>> nodes;
  for (const Vertices& v : vertices_)
    nodes.push_back(v.nodes.empty() ? std::vector<Index>(v.points.size(), 0) : v.nodes);
  to_cut_ = triangles_to_cut(view, scene_, nodes);
  scene_.fields = page_fields(view.scene, view.result.wants_origins);
  scene_.probes = view.result.probes;
  scene_.up = up_axis(view.scene);
  overlays_.start(view, scene_, triangle_cell);
}

PageFrame PageShape::frame(const RunView& view, const std::vector<BodyFields>& fields) const {
  PageFrame frame;
  frame.time = view.result.records.back().time;
  if (fields.empty()) {
    add_positions(view, frame);
  } else {
    add_fields(view, fields, frame);
    if (view.result.wants_origins) add_origins(view, frame);
  }
  overlays_.append(view, frame);
  const auto& displacement = view.result.records.back().probes;
  for (std::size_t p = 0; p < displacement.size(); ++p) {
    frame.probes.push_back(view.scene.probes[p].point + displacement[p]);
  }
  return frame;
}

void PageShape::add_positions(const RunView& view, PageFrame& frame) const {
  for (std::size_t b = 0; b < vertices_.size(); ++b) {
    const auto x = view.built.world.positions(view.built.bodies[b]);
    for (const Index node : vertices_[b].nodes) frame.positions.push_back(x[static_cast<std::size_t>(node)]);
    for (const EmbeddedPoint& p : vertices_[b].points)
      frame.positions.push_back(interpolated(p, [&](std::size_t n) { return x[n]; }));
  }
}

void PageShape::add_fields(const RunView& view, const std::vector<BodyFields>& fields,
                           PageFrame& frame) const {
  const bool contact = has_contact(view.scene);
  frame.fields.resize(contact ? 5 : 4);
  for (std::size_t b = 0; b < vertices_.size(); ++b) {
    const World& world = view.built.world;
    const BodyId id = view.built.bodies[b];
    const auto x = world.positions(id), rest = world.rest_positions(id);
    const auto von_mises = at_nodes(world.mesh(id), fields[b].cell_von_mises);
    const auto J = at_nodes(world.mesh(id), fields[b].cell_J);
    const auto add = [&](const Vec3& here, const Vec3& start, double pressure, double mises, double ratio) {
      const Vec3 u = here - start;
      frame.positions.push_back(here);
      frame.fields[0].push_back(std::sqrt(dot(u, u)));
      frame.fields[1].push_back(pressure);
      frame.fields[2].push_back(mises);
      frame.fields[3].push_back(ratio);
    };
    const auto& pressure = fields[b].node_pressure;
    // Empty where no contact is about this body.
    const auto& touch = fields[b].node_contact_pressure;
    const auto touched = [&](std::size_t n) { return touch.empty() ? 0.0 : touch[n]; };
    for (const Index node : vertices_[b].nodes) {
      const auto n = static_cast<std::size_t>(node);
      add(x[n], rest[n], pressure[n], von_mises[n], J[n]);
      if (contact) frame.fields[4].push_back(touched(n));
    }
    for (const EmbeddedPoint& p : vertices_[b].points) {
      const auto of = [&](const auto& list) {
        return interpolated(p, [&](std::size_t n) { return list[n]; });
      };
      add(of(x), of(rest), of(pressure), of(von_mises), of(J));
      if (contact) frame.fields[4].push_back(interpolated(p, touched));
    }
  }
}

// The largest share that a cell has in the error of any answer, per volume, against that of the whole scene;
// zero before the end, where shares are not known yet.
void PageShape::add_origins(const RunView& view, PageFrame& frame) const {
  std::vector<double>& out = frame.fields.emplace_back();
  const World& world = view.built.world;
  std::vector<std::vector<double>> volume;
  double whole = 0;
  for (const BodyId id : view.built.bodies) {
    volume.push_back(cell_volumes(world.mesh(id)));
    for (const double v : volume.back()) whole += v;
  }
  for (std::size_t b = 0; b < vertices_.size(); ++b) {
    const Mesh& mesh = world.mesh(view.built.bodies[b]);
    std::vector<double> density = largest_shares(view.result.origins, b);
    density.resize(volume[b].size());
    for (std::size_t c = 0; c < density.size(); ++c) density[c] *= whole / volume[b][c];
    const auto nodes = at_nodes(mesh, density);
    for (const Index node : vertices_[b].nodes) out.push_back(nodes[static_cast<std::size_t>(node)]);
    for (const EmbeddedPoint& p : vertices_[b].points)
      out.push_back(interpolated(p, [&](std::size_t n) { return nodes[n]; }));
  }
}

}  // namespace isochor
