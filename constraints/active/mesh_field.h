// Numbers cell by cell, from a definition or a field of the mesh.
#pragma once

#include <algorithm>
#include <string>

#include "engine/scene/builder.h"

namespace isochor {

// The field of that name in the cells of a mesh; the error is the end of a sentence.
inline Result<const MeshField*> cell_field(const Mesh& mesh, const std::string& name) {
  std::string known;
  for (const MeshField& f : mesh.cell_fields) {
    if (f.name == name) return &f;
    known += (known.empty() ? "\"" : ", \"") + f.name + "\"";
  }
  return Error{"field \"" + name + "\" is none of the cells of the mesh; they have " +
               (known.empty() ? "none" : known)};
}

// Refused where a list is not one entry a cell.
inline Result<void> check_cells(const Mesh& mesh, const char* what, std::size_t count) {
  if (count == at(mesh.cell_count())) return {};
  return Error{std::string(what) + " has " + std::to_string(count) + " entries, the mesh of the body " +
               std::to_string(mesh.cell_count()) + " cells; give one entry a cell"};
}

}  // namespace isochor
