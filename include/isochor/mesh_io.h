// Mesh files: readers, the checker behind `isochor check`, and VTK writers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "isochor/export.h"
#include "isochor/mesh.h"

namespace isochor {

struct MeshReadOptions {
  double scale = 1.0;  // multiplies coordinates: 1e-3 for a file in millimeters
  // The triangles of the file are the cells, for a thin body. Of these formats, and of Wavefront (.obj) and
  // STL; what groups triangles becomes regions, and surfaces of the same names.
  bool triangles = false;
};

// Reads Gmsh 2.2 and 4.1 (.msh, ASCII and binary), VTK legacy (.vtk), VTK XML (.vtu), TetGen (.node/.ele with
// optional .face), Medit (.mesh) and Abaqus (.inp, one part). The format is told from the content first, the
// extension second. Inverted cells are turned over; everything else is left for check_mesh.
ISOCHOR_API Result<Mesh> read_mesh(const std::string& path, const MeshReadOptions& options = {});

enum class Severity : std::uint8_t { note, warning, error };

// One kind of finding: how many, and the first few element or node numbers as in the file.
struct MeshFinding {
  Severity severity = Severity::note;
  std::string code;     // stable name, such as "degenerate-cell"
  std::string message;  // one sentence with count, numbers and remedy
  std::int64_t count = 0;
  std::vector<std::int64_t> examples;
};

// A closed part of the boundary: what surrounds the body ("outer"), or an inner surface that encloses a void
// ("chamber 1", "chamber 2", ... in the order of the cells). Every body has these surfaces, unless its mesh
// has one of the same name.
struct BoundaryPart {
  MeshSurface surface;  // wound outward, seen from the cells
  double volume = 0;    // enclosed [m^3]; of "outer" that of the body with its chambers
  bool taken = false;   // a surface of the mesh has this name
};

struct ISOCHOR_API MeshReport {
  Index nodes = 0, cells = 0, parts = 0;  // parts: connected components of cells
  double volume = 0;                      // [m^3]
  std::array<Vec3, 2> box{};              // lower and upper corner [m]
  double worst_quality = 0, smallest_dihedral_deg = 0;
  std::vector<BoundaryPart> boundary;  // empty when arrays contradict each other
  std::vector<MeshFinding> findings;
  bool usable() const;  // no finding is an error
};

ISOCHOR_API MeshReport check_mesh(const Mesh& mesh);

// One field of a VTK file: `components` numbers a node (or cell), row-major.
struct VtkField {
  std::string name;
  int components = 1;
  std::span<const double> values;
};

struct VtkGrid {
  CellType cell_type = CellType::tet4;
  std::span<const Vec3> points;
  std::span<const Index> cells;
  std::vector<VtkField> point_fields, cell_fields;
};

// Writes a .vtu that ParaView opens (binary, compressed). Written to a temporary name first, then renamed, so
// an interrupted run leaves no half file.
ISOCHOR_API Result<void> write_vtu(const std::string& path, const VtkGrid& grid);

struct PvdEntry {
  double time = 0;   // [s], or load factor
  std::string file;  // relative to the .pvd
};
ISOCHOR_API Result<void> write_pvd(const std::string& path, std::span<const PvdEntry> entries);

}  // namespace isochor
