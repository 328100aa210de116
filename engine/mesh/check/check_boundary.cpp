// Checks of the faces between cells and of the boundary, and of the named sets against them.
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/mesh/check/check_parts.h"

namespace isochor::mesh_files {

std::vector<CellFace> sorted_cell_faces(const Mesh& mesh) {
  const CellShape& shape = cell_shape(mesh.cell_type);
  std::vector<CellFace> faces;
  faces.reserve(shape.sides * at(mesh.cell_count()));
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    for (std::size_t f = 0; f < shape.sides; ++f) {
      CellFace face{{}, c, static_cast<std::int8_t>(f), 0};
      const FaceCorners around = outward_corners(mesh, face);
      std::size_t least = 0;
      for (std::size_t k = 1; k < shape.side_corners; ++k) least = around[k] < around[least] ? k : least;
      const Index next = around[(least + 1) % shape.side_corners],
                  previous = around[(least + shape.side_corners - 1) % shape.side_corners];
      face.odd = next > previous ? 1 : 0;
      face.corners = around;
      std::sort(face.corners.begin(), face.corners.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

FaceCorners outward_corners(const Mesh& mesh, const CellFace& face) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const CellShape& shape = cell_shape(mesh.cell_type);
  const Index* n = &mesh.cells[width * at(face.cell)];
  FaceCorners corners{-1, -1, -1, -1};
  for (std::size_t k = 0; k < shape.side_corners; ++k) corners[k] = n[shape.side[at(face.local)][k]];
  return corners;
}

void append_face(const Mesh& mesh, const CellFace& face, std::vector<Index>& nodes) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const CellShape& shape = cell_shape(mesh.cell_type);
  const Index* n = &mesh.cells[width * at(face.cell)];
  const auto& corner = shape.side[at(face.local)];
  for (std::size_t k = 0; k < shape.side_corners; ++k) nodes.push_back(n[corner[k]]);
  if (width != 10) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = std::min(corner[k], corner[(k + 1) % 3]),
                      b = std::max(corner[k], corner[(k + 1) % 3]);
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [low, high] = std::minmax(kTetShape.edge[e][0], kTetShape.edge[e][1]);
      if (low == a && high == b) nodes.push_back(n[4 + e]);
    }
  }
}

namespace {

// An edge of a surface and the face it belongs to.
struct SurfaceEdge {
  std::array<Index, 2> ends;  // ascending
  Index face = 0;
  friend bool operator<(const SurfaceEdge& a, const SurfaceEdge& b) {
    return a.ends != b.ends ? a.ends < b.ends : a.face < b.face;
  }
};

using Faces = std::vector<FaceCorners>;

std::size_t corner_count(const FaceCorners& face) {
  return face[3] < 0 ? 3 : 4;
}

std::vector<SurfaceEdge> sorted_edges(const Faces& faces) {
  std::vector<SurfaceEdge> edges;
  edges.reserve(4 * faces.size());
  for (std::size_t t = 0; t < faces.size(); ++t) {
    const std::size_t corners = corner_count(faces[t]);
    for (std::size_t k = 0; k < corners; ++k) {
      const auto [a, b] = std::minmax(faces[t][k], faces[t][(k + 1) % corners]);
      edges.push_back({{a, b}, static_cast<Index>(t)});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Calls `visit(first, last)` for each run of equal edges.
template <class Visit>
void for_each_edge(const std::vector<SurfaceEdge>& edges, Visit visit) {
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last].ends == edges[first].ends) ++last;
    visit(first, last);
  }
}

// Faces of one cell only; counts those that more than two cells share or two cells on one side.
std::vector<CellFace> boundary_faces(const Mesh& mesh, const std::vector<CellFace>& faces,
                                     MeshReport& report) {
  std::vector<CellFace> boundary;
  Tally crowded, folded;
  for (std::size_t first = 0, last = 0; first < faces.size(); first = last) {
    while (last < faces.size() && faces[last].corners == faces[first].corners) ++last;
    if (last - first == 1) boundary.push_back(faces[first]);
    if (last - first > 2) crowded.add(cell_label(mesh, faces[first].cell));
    // Seen from two cells on its two sides a face has opposite orientations.
    if (last - first == 2 && faces[first].odd == faces[first + 1].odd)
      folded.add(cell_label(mesh, faces[first].cell));
  }
  // Lattices that keep parts of a body apart have cells in the same place on purpose.
  const bool lattice = mesh.cell_type == CellType::hex8;
  const Severity severity = lattice ? Severity::warning : Severity::error;
  const std::string remedy = std::string("remove the overlapping cells") +
                             (lattice ? ", unless a lattice keeps parts apart by them" : "");
  crowded.report(report, severity, "non-manifold-face", "face is", "faces are",
                 "shared by more than two cells; " + remedy, "at cell ");
  folded.report(report, severity, "overlapping-cells", "face has", "faces have",
                "both of its cells on one side; " + remedy, "at cell ");
  return boundary;
}

void check_edges(const Mesh& mesh, const Faces& faces, const std::vector<SurfaceEdge>& edges,
                 MeshReport& report) {
  Tally crowded;
  for_each_edge(edges, [&](std::size_t first, std::size_t last) {
    if (last - first > 2) crowded.add(node_label(mesh, edges[first].ends[0]));
  });
  crowded.report(report, Severity::warning, "non-manifold-edge", "boundary edge joins", "boundary edges join",
                 "more than two boundary faces; parts hinge there, thicken the joint", "at node ");
  // Corners of faces that share an edge at a node are joined; a node with two fans of faces is pinched.
  Groups fans(4 * faces.size());
  const auto corner = [&](Index face, Index node) {
    const FaceCorners& f = faces[at(face)];
    return 4 * face + static_cast<Index>(std::find(f.begin(), f.end(), node) - f.begin());
  };
  for_each_edge(edges, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first + 1; i < last; ++i) {
      for (const Index end : edges[i].ends)
        fans.join(corner(edges[first].face, end), corner(edges[i].face, end));
    }
  });
  std::vector<Index> fan(mesh.nodes.size(), -1);
  std::vector<bool> pinched(mesh.nodes.size(), false);
  for (Index c = 0; c < static_cast<Index>(4 * faces.size()); ++c) {
    const Index node = faces[at(c / 4)][at(c % 4)];
    if (node < 0) continue;
    const Index root = fans.root(c);
    if (fan[at(node)] >= 0 && fan[at(node)] != root) pinched[at(node)] = true;
    fan[at(node)] = root;
  }
  Tally nodes;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    if (pinched[at(n)]) nodes.add(node_label(mesh, n));
  }
  nodes.report(report, Severity::warning, "non-manifold-node", "node is", "nodes are",
               "where boundaries touch in a point only; parts hinge there, thicken the joint");
}

// Six times the volume of the cone from `apex` to a boundary face. A curved face is taken as four flat ones
// and the difference to one extrapolated, as the error falls with the square of the size.
double cone6(const Mesh& mesh, const CellFace& face, const Vec3& apex) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const Index* n = &mesh.cells[width * at(face.cell)];
  const auto cone = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return dot(cross(a - apex, b - apex), c - apex);
  };
  const auto& corner = cell_shape(mesh.cell_type).side[at(face.local)];
  std::array<Vec3, 4> x, mid;
  for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.nodes[at(n[corner[k]])];
  // What a bilinear face bounds is the mean of its two ways to be cut into triangles.
  if (width == 8) {
    return 0.5 * (cone(x[0], x[1], x[2]) + cone(x[0], x[2], x[3]) + cone(x[0], x[1], x[3]) +
                  cone(x[1], x[2], x[3]));
  }
  const double one = cone(x[0], x[1], x[2]);
  if (width == 4) return one;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = corner[k], b = corner[(k + 1) % 3];
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& edge = kTetShape.edge[e];
      const bool same = (edge[0] == a && edge[1] == b) || (edge[0] == b && edge[1] == a);
      if (same) mid[k] = mesh.nodes[at(n[4 + e])];
    }
  }
  const double four = cone(x[0], mid[0], mid[2]) + cone(mid[0], x[1], mid[1]) + cone(mid[2], mid[1], x[2]) +
                      cone(mid[0], mid[1], mid[2]);
  return (4 * four - one) / 3;
}

bool has_surface(const Mesh& mesh, const std::string& name) {
  return std::any_of(mesh.surfaces.begin(), mesh.surfaces.end(),
                     [&](const MeshSurface& s) { return s.name == name; });
}

// The boundary seen from outside has positive volume; a component with negative volume encloses a void. Both
// get a name.
void check_cavities(const Mesh& mesh, const std::vector<SurfaceEdge>& edges,
                    const std::vector<CellFace>& boundary, MeshReport& report) {
  Groups groups(boundary.size());
  for_each_edge(edges, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first + 1; i < last; ++i) groups.join(edges[first].face, edges[i].face);
  });
  const Vec3 middle = 0.5 * (report.box[0] + report.box[1]);
  std::map<Index, double> volume;
  for (std::size_t t = 0; t < boundary.size(); ++t) {
    volume[groups.root(static_cast<Index>(t))] += cone6(mesh, boundary[t], middle) / 6;
  }
  Tally cavities;
  std::string sizes;
  const Vec3 box = report.box[1] - report.box[0];
  report.boundary.push_back({{"outer", {}}, 0, has_surface(mesh, "outer")});
  std::map<Index, std::size_t> part;  // root -> place in report.boundary; the others are outer
  for (const auto& [root, v] : volume) {
    if (!(v < -1e-12 * box.x * box.y * box.z)) {
      report.boundary[0].volume += v;
      continue;
    }
    cavities.add(cell_label(mesh, boundary[at(root)].cell));
    part[root] = report.boundary.size();
    const std::string name = "chamber " + std::to_string(report.boundary.size());
    report.boundary.push_back({{name, {}}, -v, has_surface(mesh, name)});
    if (cavities.count() <= 8) sizes += (sizes.empty() ? "" : ", ") + shown(-v) + " (\"" + name + "\")";
  }
  for (std::size_t t = 0; t < boundary.size(); ++t) {
    const auto found = part.find(groups.root(static_cast<Index>(t)));
    const std::size_t at_part = found == part.end() ? 0 : found->second;
    append_face(mesh, boundary[t], report.boundary[at_part].surface.faces);
  }
  cavities.report(report, Severity::note, "cavity", "inner closed surface", "inner closed surfaces",
                  "with a volume of " + sizes + " m^3; scenes can use it by this name unless a group has it",
                  "next to cell ");
}

Faces corners_of(const MeshSurface& surface, CellType type) {
  const auto width = static_cast<std::size_t>(nodes_per_face(type));
  Faces faces;
  for (std::size_t f = 0; f < surface.faces.size(); f += width) {
    FaceCorners corners{-1, -1, -1, -1};
    std::copy_n(&surface.faces[f], cell_shape(type).side_corners, corners.begin());
    faces.push_back(corners);
  }
  return faces;
}

// How many closed loops the edges form that only one face has.
std::int64_t count_loops(const Mesh& mesh, const std::vector<SurfaceEdge>& edges) {
  Groups groups(mesh.nodes.size());
  std::vector<Index> ends;
  for_each_edge(edges, [&](std::size_t first, std::size_t last) {
    if (last - first != 1) return;
    groups.join(edges[first].ends[0], edges[first].ends[1]);
    ends.push_back(edges[first].ends[0]);
  });
  for (Index& n : ends) n = groups.root(n);
  std::sort(ends.begin(), ends.end());
  return std::unique(ends.begin(), ends.end()) - ends.begin();
}

void check_surface(const Mesh& mesh, const MeshSurface& surface, const std::vector<CellFace>& faces,
                   MeshReport& report) {
  const auto add = [&](Severity severity, const char* code, std::int64_t count, const std::string& text) {
    report.findings.push_back({severity, code, join("surface '", surface.name, "' ", text), count, {}});
  };
  const Faces given = corners_of(surface, mesh.cell_type);
  if (given.empty()) return add(Severity::warning, "empty-surface", 1, "has no faces; nothing can act on it");
  Faces sorted = given;
  Tally foreign;
  for (auto& t : sorted) {
    std::sort(t.begin(), t.end());
    const auto found = std::lower_bound(faces.begin(), faces.end(), CellFace{t, -1, 0, 0});
    if (found == faces.end() || found->corners != t) foreign.add(node_label(mesh, t[0] < 0 ? t[1] : t[0]));
  }
  if (foreign.count() > 0) {
    add(Severity::warning, "surface-off-mesh", foreign.count(),
        "has " + foreign.text("face", "faces", "at node ") +
            " that are faces of no cell (given by one of the nodes); mesh surface and volume together, "
            "unless they "
            "cap an opening");
  }
  std::sort(sorted.begin(), sorted.end());
  const auto repeats = sorted.end() - std::unique(sorted.begin(), sorted.end());
  if (repeats > 0) {
    add(Severity::warning, "repeated-face", repeats,
        join("lists ", repeats, repeats == 1 ? " face" : " faces", " more than once; each counts once"));
  }
  const std::int64_t loops = count_loops(mesh, sorted_edges(given));
  if (loops > 0) {
    add(Severity::note, "open-surface", loops,
        join("is open, with ", loops, loops == 1 ? " boundary loop" : " boundary loops",
             "; a cavity needs it closed or capped"));
  }
}

}  // namespace

void check_boundary(const Mesh& mesh, const std::vector<CellFace>& faces, MeshReport& report) {
  if (mesh.cell_type == CellType::tri3) return check_sheet(mesh, report);
  const std::vector<CellFace> boundary = boundary_faces(mesh, faces, report);
  Faces outward;
  outward.reserve(boundary.size());
  for (const CellFace& face : boundary) outward.push_back(outward_corners(mesh, face));
  const std::vector<SurfaceEdge> edges = sorted_edges(outward);
  check_edges(mesh, outward, edges, report);
  check_cavities(mesh, edges, boundary, report);
}

void check_named_sets(const Mesh& mesh, const std::vector<CellFace>& faces, MeshReport& report) {
  for (const MeshSurface& surface : mesh.surfaces) check_surface(mesh, surface, faces, report);
  for (const MeshNodeSet& set : mesh.node_sets) {
    if (!set.nodes.empty()) continue;
    report.findings.push_back(
        {Severity::warning, "empty-node-set", join("node set '", set.name, "' has no nodes"), 1, {}});
  }
}

}  // namespace isochor::mesh_files
