// read_surface: Wavefront and STL files, and the boundaries of volume meshes.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "engine/mesh/boundary.h"
#include "engine/mesh/cell_shape.h"
#include "engine/mesh/read/readers.h"
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

Result<TriangleSurface> read_obj(const std::string& path, const std::string& content) {
  std::istringstream in(content);
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
        if (!c) return c.failure();
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

// Triangles that each bring their own three points; those in the same place are one.
class Soup {
 public:
  void add(const Vec3& p) {
    const Vec3 q = p + Vec3{};
    const auto [it, fresh] = seen_.try_emplace({q.x, q.y, q.z}, static_cast<Index>(surface.points.size()));
    if (fresh) surface.points.push_back(q);
    surface.triangles.push_back(it->second);
  }
  TriangleSurface surface;

 private:
  std::map<std::array<double, 3>, Index> seen_;
};

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;

Result<TriangleSurface> read_stl(const std::string& path, const std::string& content) {
  Soup soup;
  mesh_files::Cursor at(content, path);
  at.set_swapped(std::endian::native == std::endian::big);
  std::uint32_t announced = 0;
  if (content.size() >= kStlHeader) {
    at.move_to(kStlHeader - 4);
    announced = at.raw<std::uint32_t>("the number of triangles");
  }
  // Text files begin with "solid", and so do some others: the size tells.
  if (content.size() >= kStlHeader && (content.size() - kStlHeader) / kStlTriangle == announced &&
      (content.size() - kStlHeader) % kStlTriangle == 0) {
    at.set_binary(true);
    for (std::uint32_t t = 0; t < announced; ++t) {
      at.move_to(kStlHeader + kStlTriangle * t + 12);
      for (int k = 0; k < 3; ++k) {
        Vec3 p;
        for (int i = 0; i < 3; ++i) p[i] = static_cast<double>(at.raw<float>("a coordinate"));
        soup.add(p);
      }
    }
  } else if (content.starts_with("solid")) {
    at.move_to(0);
    while (!at.peek_word().empty()) {
      if (at.word("a keyword") != "vertex") continue;
      const double x = at.real("a coordinate"), y = at.real("a coordinate"), z = at.real("a coordinate");
      soup.add({x, y, z});
    }
  } else {
    return Error{path + ": it is neither an STL text (\"solid ...\") nor as long as its " +
                 std::to_string(announced) + " triangles; " + mesh_files::rewrite_file};
  }
  if (soup.surface.triangles.empty() || soup.surface.triangles.size() % 3 != 0) {
    return Error{path + ": it has " + std::to_string(soup.surface.triangles.size()) +
                 " corners of triangles; three a triangle are needed"};
  }
  return soup.surface;
}

Result<TriangleSurface> read_any_surface(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  try {
    if (extension == ".obj") return read_obj(path, mesh_files::load_file(path));
    if (extension == ".stl") return read_stl(path, mesh_files::load_file(path));
  } catch (const mesh_files::ReadFailure& failure) {
    return Error{failure.message};
  }
  auto mesh = read_mesh(path);
  if (!mesh) return mesh.failure();
  return boundary_of(mesh.value());
}

}  // namespace

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

Result<TriangleSurface> read_surface(const std::string& path, double scale) {
  if (!(scale > 0) || !std::isfinite(scale)) {
    return Error{mesh_files::join(path, ": the scale is ", scale, "; give a positive number such as 0.001")};
  }
  auto surface = read_any_surface(path);
  if (!surface) return surface;
  for (Vec3& p : surface.value().points) {
    p = scale * p;
    if (!std::isfinite(dot(p, p)))
      return Error{path + ": it has a point that is not finite; export it again"};
  }
  return surface;
}

}  // namespace isochor
