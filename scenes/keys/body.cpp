// Bodies: where their meshes come from, and what is named by where it is.
#include "scenes/keys/parts.h"

namespace isochor::keys {

ISOCHOR_WORDS(Element, ISOCHOR_WORD(Element, tet4), ISOCHOR_WORD(Element, tet4_edge_smoothed),
              ISOCHOR_WORD(Element, tet10), ISOCHOR_WORD(Element, hex8), ISOCHOR_WORD(Element, tri3));
ISOCHOR_WORDS(CellType, ISOCHOR_WORD(CellType, tet4), ISOCHOR_WORD(CellType, tet10),
              ISOCHOR_WORD(CellType, hex8), ISOCHOR_WORD(CellType, tri3));

void describe(Visitor& io, BoxMeshDef& b) {
  const BoxMeshDef d;
  io.about("box",
           "A box of cells; surfaces x0, x1, y0, y1, z0, z1. Of `tri3` a sheet that is flat along one "
           "axis; node sets have these names.");
  io.vector({"lower", "m", "corner"}, b.lower, d.lower);
  io.vector({"upper", "m", "corner"}, b.upper, d.upper);
  io.integers(Key("divisions", "", "cells a side, six tets each").least(1).absent("1, 1, 1"), b.divisions);
  io.word({"cell_type", "", "what they are"}, b.cell_type, d.cell_type);
}

void describe(Visitor& io, LatticeMesh& l) {
  const LatticeMesh d;
  io.about("lattice",
           "[Cubes](elements.md#lattices-around-a-surface) around a closed surface, for `hex8`; results show "
           "the surface.");
  io.required_text({"surface", "", "Wavefront (`.obj`), or a volume mesh whose boundary it is"}, l.surface);
  io.number(Key("scale", "", "multiplies the coordinates of the surface").above(0), l.scale, d.scale);
  io.vector({"offset", "m", "added then"}, l.offset, d.offset);
  io.number(Key("spacing", "m", "edge of a cube").above(0).must(), l.spacing, d.spacing);
  io.integer(Key("samples", "", "parts that a cube is looked at in, per side").least(1), l.samples,
             d.samples);
  io.flag({"keep_apart", "", "parts that do not hang together in a cube get a cell each"}, l.keep_apart,
          d.keep_apart);
}

// A file with its scale, a generated box, or a lattice.
namespace {
struct MeshSource {
  std::variant<MeshFile, BoxMeshDef, LatticeMesh>& mesh;
};
}  // namespace
void describe(Visitor& io, MeshSource& m) {
  const MeshFile d;
  io.about("mesh", "One of `file`, `box` and `lattice`.");
  io.mesh_form(m.mesh);
  if (auto* file = std::get_if<MeshFile>(&m.mesh)) {
    io.required_text({"file", "", "see [meshes](meshes.md); relative to the scene file"}, file->path);
    io.number(Key("scale", "", "multiplies the coordinates of a file: 1e-3 for millimeters").above(0),
              file->scale, d.scale);
    io.vector({"turn", "rad", "turns the scaled coordinates of a file about the origin: axis times angle"},
              file->turn, d.turn);
    io.vector({"offset", "m", "added then"}, file->offset, d.offset);
  }
  if (auto* box = std::get_if<BoxMeshDef>(&m.mesh)) io.object({"box", "", "instead of a file"}, *box);
  if (auto* lattice = std::get_if<LatticeMesh>(&m.mesh))
    io.object({"lattice", "", "instead of a file"}, *lattice);
}

void describe(Visitor& io, PlanePlace& p) {
  const PlanePlace d;
  io.about("plane_place", "Nodes on this plane.");
  io.vector({"point", "m", "on it"}, p.point, d.point);
  io.required_vector({"normal", "", "its direction"}, p.normal);
}

void describe(Visitor& io, SpherePlace& s) {
  const SpherePlace d;
  io.about("sphere_place", "Nodes inside this sphere.");
  io.required_vector({"center", "m", "its middle"}, s.center);
  io.number(Key("radius", "m", "its radius").above(0).must(), s.radius, d.radius);
}

void describe(Visitor& io, RefinedPlace& p) {
  const RefinedPlace d;
  io.about("refined_place",
           "Cells that are refined beyond their neighbors: those that fit all of the criteria, in the placed "
           "mesh. See [refined meshes](#refined-meshes).");
  io.optional_box({"box", "m", "lower and upper corner; a node of the cell is between them"}, p.box);
  io.maybe_object({"sphere", "", "a node of the cell is inside"}, p.sphere);
  io.names({"surfaces", "", "a node of the cell is on one of them"}, p.surfaces);
  io.names({"regions", "", "of the cell"}, p.regions);
  io.optional_object({"cells", "", "by number, in the mesh as it is when their turn comes"}, p.cells,
                     p.cells.given());
  io.number(Key("tolerance", "m", "how far off nodes may be; 0: 1e-5 of the diagonal of the mesh").least(0),
            p.tolerance, d.tolerance);
  io.integer(Key("levels", "", "so many times, each time all that fit").least(1).most(12), p.levels,
             d.levels);
}

void describe(Visitor& io, SeedPlace& s) {
  const SeedPlace d;
  io.about("seed_place",
           "Faces reached from the one nearest to the point, over edges that turn by less than the angle.");
  io.required_vector({"point", "m", "where it begins"}, s.point);
  io.optional_angle({"angle", "rad", "of an edge"}, {"angle_deg", "deg", "the same, instead"}, s.angle,
                    d.angle);
}

void describe(Visitor& io, FacingPlace& f) {
  const FacingPlace d;
  io.about("facing_place", "Faces whose outward normal is within the angle of the direction.");
  io.required_vector({"direction", "", "where they look"}, f.direction);
  io.optional_angle({"angle", "rad", "off it"}, {"angle_deg", "deg", "the same, instead"}, f.angle, d.angle);
}

void describe(Visitor& io, MeshSelection& s) {
  const MeshSelection d;
  io.about("mesh_selection",
           "What fits all of the criteria, in the placed mesh; a face with all its nodes. See [faces and "
           "nodes by place](#faces-and-nodes-by-place).");
  io.required_text({"name", "", "that effects use"}, s.name);
  io.names(Key("of", "", "surfaces to choose from").absent("the whole boundary"), s.of);
  io.optional_box({"box", "m", "lower and upper corner"}, s.box);
  io.maybe_object({"plane", "", "that it lies on"}, s.plane);
  io.maybe_object({"sphere", "", "that it is inside of"}, s.sphere);
  io.maybe_object({"facing", "", "where it looks"}, s.facing);
  io.maybe_object({"seed", "", "what it is reached from"}, s.seed);
  io.text({"file", "", "a surface that it lies on: STL, OBJ, or the boundary of a volume mesh"}, s.file,
          d.file);
  io.number(Key("scale", "", "multiplies the coordinates of the file").above(0), s.scale, d.scale);
  io.number(Key("tolerance", "m", "how far off nodes may be; 0: 1e-5 of the diagonal of the mesh").least(0),
            s.tolerance, d.tolerance);
}

void describe(Visitor& io, SceneFiberField& f) {
  const SceneFiberField d;
  io.about("fiber_field",
           "Directions in the cells of the mesh from a Laplace problem, see [fiber "
           "fields](materials/fibers.md#fields-from-a-laplace-problem).");
  io.required_text({"name", "", "of the field, for `field` of fibers, muscles and `fiber_field` of shells"},
                   f.name);
  io.names(Key("from", "", "surfaces or node sets where phi = 0").must(), f.from);
  io.names(Key("to", "", "where phi = 1").must(), f.to);
  io.vector({"axis", "", "that directions go round, at an angle; zero: along the gradient of phi"}, f.axis,
            d.axis);
  io.optional_angle({"angle_from", "rad", "off the way round, toward the axis, where phi = 0"},
                    {"angle_from_deg", "deg", "the same, instead"}, f.angle_from, d.angle_from);
  io.optional_angle({"angle_to", "rad", "where phi = 1"}, {"angle_to_deg", "deg", "the same, instead"},
                    f.angle_to, d.angle_to);
}

void describe_at_rest(Visitor& io, SceneBody& b) {
  const SceneBody d;
  io.about("body", "A soft body, solid or thin.");
  io.required_text({"name", "", "that effects and results use"}, b.name);
  MeshSource mesh{b.mesh};
  io.object({"mesh", "", "where it comes from"}, mesh);
  io.list({"surfaces", "",
           "boundary faces by where they are, for effects to name; `outer` and `chamber 1`, ... are there "
           "already"},
          b.surfaces);
  io.list({"node_sets", "", "nodes by where they are, inside the body as well"}, b.node_sets);
  io.integer(Key("refine", "",
                 "cuts every cell into eight (triangles into four), so many times; see [refined "
                 "meshes](#refined-meshes)")
                 .least(0)
                 .most(8),
             b.refine, d.refine);
  io.list(
      {"refine_where", "", "then cuts the cells of these places further, and neighbors as far as they must"},
      b.refine_where);
  io.list({"fiber_fields", "", "directions in its cells, made in the refined mesh"}, b.fiber_fields);
  io.word({"element", "", "see [elements](elements.md)"}, b.element, d.element);
  io.list(Key("materials", "", "one, or one a region").absent("none, of a thin body"), b.materials);
  io.optional_number(
      Key("guard_stiffness", "",
          "[element guard](elements.md): barrier against single tets turning over, relative to mu; 0: off")
          .least(0)
          .absent("1 for Poisson's ratios from 0.49, else 0"),
      b.guard_stiffness);
  io.number(Key("guard_threshold", "", "J below which the barrier acts").above(0), b.guard_threshold,
            d.guard_threshold);
}

void describe(Visitor& io, SceneBody& b) {
  const SceneBody d;
  describe_at_rest(io, b);
  io.vector({"velocity", "m/s", "dynamics: at the start"}, b.velocity, d.velocity);
  io.vector({"angular_velocity", "rad/s", "dynamics: at the start, about the center of mass"},
            b.angular_velocity, d.angular_velocity);
}

}  // namespace isochor::keys
