#include "scenes/body_parts.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include "engine/base/chars.h"

namespace isochor {

std::string path_in(const std::string& folder, const std::string& file) {
  const std::filesystem::path path(file);
  return (path.is_relative() ? std::filesystem::path(folder) / path : path).lexically_normal().string();
}

Result<LatticeBody> make_lattice(const LatticeMesh& def, const std::string& folder) {
  const std::string path = path_in(folder, def.surface);
  auto surface = read_surface(path);
  if (!surface) return surface.failure();
  LatticeDef lattice;
  lattice.points = std::move(surface.value().points);
  for (Vec3& p : lattice.points) p = def.scale * p + def.offset;
  lattice.triangles = std::move(surface.value().triangles);
  lattice.spacing = def.spacing;
  lattice.samples = def.samples;
  lattice.keep_apart = def.keep_apart;
  auto made = lattice_mesh(lattice);
  if (!made) return made.failure();
  LatticeBody body;
  body.mesh = std::move(made.value().mesh);
  body.mesh.source = path + " in a lattice";
  body.surface = {std::move(lattice.triangles), std::move(made.value().embedding)};
  return body;
}

Result<std::vector<double>> read_field(const CellField& field, const std::string& folder) {
  if (field.file.empty()) return field.values;
  if (!field.values.empty()) return Error{"it has values and a file; give one of them"};
  const std::string path = path_in(folder, field.file);
  std::ifstream in(path);
  if (!in) return Error{path + ": cannot be opened; check the path"};
  std::vector<double> values;
  std::string word;
  while (in >> word) {
    double v = 0;
    const auto [stop, error] = isochor::from_chars(word.data(), word.data() + word.size(), v);
    if (error != std::errc() || stop != word.data() + word.size() || !std::isfinite(v)) {
      return Error{path + ": entry " + std::to_string(values.size()) + " is \"" + word +
                   "\"; give one finite number a cell, divided by blanks or lines"};
    }
    values.push_back(v);
  }
  if (values.empty()) return Error{path + ": it has no numbers; give one a cell"};
  return values;
}

namespace {

// Every cell with the entry of the one that it is of. A list of another length is left to who checks it.
template <class T>
std::vector<T> handed_down(const std::vector<T>& values, std::span<const Index> parent) {
  std::vector<T> out;
  out.reserve(parent.size());
  for (const Index c : parent) {
    if (static_cast<std::size_t>(c) < values.size()) out.push_back(values[static_cast<std::size_t>(c)]);
  }
  return out;
}

}  // namespace

Result<MaterialDef> refined_numbers(const MaterialDef& def, const std::string& folder,
                                    std::span<const Index> parent) {
  MaterialDef out = def;
  if (parent.empty()) return out;
  const auto hand_down = [&](const char* name, CellField& field) -> Result<void> {
    if (!field.given()) return {};
    auto values = read_field(field, folder);
    if (!values) return Error{std::string(name) + ": " + values.error()};
    field = {handed_down(values.value(), parent), ""};
    return {};
  };
  if (auto r = hand_down("stiffness_field", out.stiffness_field); !r) return r.failure();
  if (auto r = hand_down("poisson_field", out.poisson_field); !r) return r.failure();
  for (SceneFibers& f : out.fibers) f.directions = handed_down(f.directions, parent);
  return out;
}

}  // namespace isochor
