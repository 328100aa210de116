// The readers behind read_mesh, one a format. Each throws ReadFailure and nothing else of its own.
#pragma once

#include <string>
#include <string_view>

#include "engine/mesh/read/raw_mesh.h"

namespace isochor::mesh_files {

// Gmsh 2.2 and 4.1, ASCII and binary.
RawMesh read_gmsh(std::string_view content, const std::string& file);
// VTK legacy, ASCII and binary, unstructured grids.
RawMesh read_vtk_legacy(std::string_view content, const std::string& file);
// VTK XML unstructured grids.
RawMesh read_vtu(std::string_view content, const std::string& file);
// Medit, ASCII.
RawMesh read_medit(std::string_view content, const std::string& file);
// Abaqus and CalculiX decks.
bool is_abaqus(std::string_view content);
RawMesh read_abaqus(std::string_view content, const std::string& file);
// TetGen: `file` is the .node or the .ele file; the others lie beside it.
RawMesh read_tetgen(const std::string& file);

// The whole file in memory; refuses directories and devices.
std::string load_file(const std::string& file);

}  // namespace isochor::mesh_files
