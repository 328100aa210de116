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

// One vector a cell from such a field.
inline Result<std::vector<Vec3>> cell_directions(const Mesh& mesh, const std::string& name) {
  auto found = cell_field(mesh, name);
  if (!found) return found.failure();
  const MeshField& field = *found.value();
  if (field.components != 3) {
    return Error{"field \"" + name + "\" has " + std::to_string(field.components) +
                 " components; directions have three"};
  }
  std::vector<Vec3> out;
  for (std::size_t c = 0; c + 2 < field.values.size(); c += 3)
    out.push_back({field.values[c], field.values[c + 1], field.values[c + 2]});
  return out;
}

// Refused where a list is not one entry a cell.
inline Result<void> check_cells(const Mesh& mesh, const char* what, std::size_t count) {
  if (count == at(mesh.cell_count())) return {};
  return Error{std::string(what) + " has " + std::to_string(count) + " entries, the mesh of the body " +
               std::to_string(mesh.cell_count()) + " cells; give one entry a cell"};
}

}  // namespace isochor
