#include "scenes/body_parts.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "engine/mesh/cell_shape.h"
#include "isochor/mesh_io.h"

namespace isochor {

namespace {

std::string line_of(const std::string& path, int line) {
  return path + ", line " + std::to_string(line) + ": ";
}

// One corner of a face: "7", "7/2", "7/2/3", "7//3", negative counted from the end.
Result<Index> corner(const std::string& word, std::size_t points, const std::string& where) {
  long long n = 0;
  const auto end = word.data() + std::min(word.find('/'), word.size());
  const auto [stop, error] = std::from_chars(word.data(), end, n);
  const long long count = static_cast<long long>(points);
  if (error != std::errc() || stop != end || n == 0 || n > count || n < -count) {
    return Error{where + "face corner \"" + word + "\" is none of the " + std::to_string(points) +
                 " points before it"};
  }
  return static_cast<Index>(n > 0 ? n - 1 : count + n);
}

Result<TriangleSurface> read_obj(const std::string& path) {
  std::ifstream in(path);
  if (!in) return Error{path + ": cannot be opened; check the path"};
  TriangleSurface s;
  std::string text;
  for (int line = 1; std::getline(in, text); ++line) {
    std::istringstream words(text);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3 p;
      if (!(words >> p.x >> p.y >> p.z) || !std::isfinite(dot(p, p)))
        return Error{line_of(path, line) + "a point needs three finite numbers"};
      s.points.push_back(p);
    } else if (kind == "f") {
      std::vector<Index> face;
      for (std::string word; words >> word;) {
        auto c = corner(word, s.points.size(), line_of(path, line));
        if (!c) return Error{c.error()};
        face.push_back(c.value());
      }
      if (face.size() < 3)
        return Error{line_of(path, line) + "a face has " + std::to_string(face.size()) +
                     " corners; it needs 3"};
      for (std::size_t k = 2; k < face.size(); ++k)
        s.triangles.insert(s.triangles.end(), {face[0], face[k - 1], face[k]});
    }
  }
  if (s.triangles.empty())
    return Error{path + ": it has no faces; a Wavefront file with \"f\" lines is needed"};
  return s;
}

}  // namespace

std::string path_in(const std::string& folder, const std::string& file) {
  const std::filesystem::path path(file);
  return (path.is_relative() ? std::filesystem::path(folder) / path : path).lexically_normal().string();
}

TriangleSurface boundary_of(const Mesh& mesh) {
  const CellShape& shape = cell_shape(mesh.cell_type);
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  std::map<std::vector<Index>, std::vector<Index>> open;  // sorted corners to corners in order
  for (std::size_t c = 0; c < mesh.cells.size(); c += per) {
    for (std::size_t side = 0; side < shape.sides; ++side) {
      std::vector<Index> face, key;
      for (std::size_t k = 0; k < shape.side_corners; ++k)
        face.push_back(mesh.cells[c + shape.side[side][k]]);
      key = face;
      std::sort(key.begin(), key.end());
      const auto [it, fresh] = open.try_emplace(std::move(key), std::move(face));
      if (!fresh) open.erase(it);
    }
  }
  TriangleSurface s;
  std::map<Index, Index> number;
  const auto point = [&](Index node) {
    const auto [it, fresh] = number.try_emplace(node, static_cast<Index>(s.points.size()));
    if (fresh) s.points.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
    return it->second;
  };
  for (const auto& [key, face] : open) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      for (const Index n : {face[0], face[k - 1], face[k]}) s.triangles.push_back(point(n));
    }
  }
  return s;
}

Result<TriangleSurface> read_surface(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".obj") return read_obj(path);
  auto mesh = read_mesh(path);
  if (!mesh) return Error{mesh.error()};
  return boundary_of(mesh.value());
}

Result<LatticeBody> make_lattice(const LatticeMesh& def, const std::string& folder) {
  const std::string path = path_in(folder, def.surface);
  auto surface = read_surface(path);
  if (!surface) return Error{surface.error()};
  LatticeDef lattice;
  lattice.points = std::move(surface.value().points);
  for (Vec3& p : lattice.points) p = def.scale * p + def.offset;
  lattice.triangles = std::move(surface.value().triangles);
  lattice.spacing = def.spacing;
  lattice.samples = def.samples;
  lattice.keep_apart = def.keep_apart;
  auto made = lattice_mesh(lattice);
  if (!made) return Error{made.error()};
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
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), v);
    if (error != std::errc() || stop != word.data() + word.size() || !std::isfinite(v)) {
      return Error{path + ": entry " + std::to_string(values.size()) + " is \"" + word +
                   "\"; give one finite number a cell, divided by blanks or lines"};
    }
    values.push_back(v);
  }
  if (values.empty()) return Error{path + ": it has no numbers; give one a cell"};
  return values;
}

}  // namespace isochor
