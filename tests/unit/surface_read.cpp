// Surfaces and distance fields from files.
#include <bit>
#include <cmath>

#include "isochor/solids.h"
#include "mesh_support.h"

using namespace isochor;
using mesh_test::TempDir;

namespace {

template <class T>
void put(std::string& out, T value, bool big_endian = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big_endian == (std::endian::native == std::endian::little)) std::reverse(bytes, bytes + sizeof(T));
  out.append(bytes, sizeof(T));
}

const Vec3 kCorners[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string obj_text() {
  return "# a corner\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1//1 2//1 4//1\nf -4 -1 -2\nf 2 3 4\n";
}
std::string stl_text() {
  std::string out = "solid corner of a box\n";
  for (const auto& face : kFaces) {
    out += " facet normal 0 0 0\n  outer loop\n";
    for (const int c : face) {
      const Vec3& p = kCorners[c];
      out +=
          "   vertex " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    }
    out += "  endloop\n endfacet\n";
  }
  return out + "endsolid corner of a box\n";
}
// Its header begins like a text.
std::string stl_binary() {
  std::string out = "solid, but binary";
  out.resize(80, ' ');
  put(out, std::uint32_t{4});
  for (const auto& face : kFaces) {
    for (int k = 0; k < 3; ++k) put(out, 0.0F);
    for (const int c : face) {
      for (int k = 0; k < 3; ++k) put(out, static_cast<float>(kCorners[c][k]));
    }
    put(out, std::uint16_t{0});
  }
  return out;
}

double distance_at(int i, int j, int k) {
  const double x = 0.5 * i - 1, y = 0.5 * j - 1, z = 0.5 * k - 1;
  return std::sqrt(x * x + y * y + z * z) - 0.6;
}
template <class Put>
void each_distance(const Put& one) {
  for (int k = 0; k < 5; ++k) {
    for (int j = 0; j < 5; ++j) {
      for (int i = 0; i < 5; ++i) one(distance_at(i, j, k));
    }
  }
}
std::string vtk(bool binary, const std::string& type) {
  std::string out = "# vtk DataFile Version 3.0\na ball\n";
  out += binary ? "BINARY" : "ASCII";
  out +=
      "\nDATASET STRUCTURED_POINTS\nDIMENSIONS 5 5 5\nORIGIN -1 -1 -1\nSPACING 0.5 0.5 0.5\nPOINT_DATA 125\n";
  out += "SCALARS distance " + type + (binary ? "" : " 1") + "\nLOOKUP_TABLE default\n";
  each_distance([&](double d) {
    if (!binary)
      out += std::to_string(d) + "\n";
    else if (type == "float")
      put(out, static_cast<float>(d), true);
    else
      put(out, d, true);
  });
  return out;
}
std::string sdf() {
  std::string out = "5 5 5\n-1 -1 -1\n0.5\n";
  each_distance([&](double d) { out += std::to_string(d) + "\n"; });
  return out;
}

}  // namespace

TEST_CASE("surfaces are read from Wavefront and STL files, text and binary") {
  const TempDir dir;
  for (const auto& [name, content] :
       {std::pair{"a.obj", obj_text()}, {"a.STL", stl_text()}, {"b.stl", stl_binary()}}) {
    INFO(name);
    const auto s = read_surface(dir.write(name, content), 0.5);
    REQUIRE(s);
    CHECK(s.value().points.size() == 4);
    REQUIRE(s.value().triangles.size() == 12);
    double volume = 0;
    for (std::size_t t = 0; t < 12; t += 3) {
      const auto p = [&](std::size_t k) {
        return s.value().points[static_cast<std::size_t>(s.value().triangles[t + k])];
      };
      volume += dot(p(0), cross(p(1), p(2))) / 6;
    }
    CHECK(volume == Approx(1.0 / 6 / 8));
    CHECK(mesh_solid(s.value()));
  }
}

TEST_CASE("surface files that are damaged are refused with file and remedy") {
  const TempDir dir;
  const auto why = [&](const std::string& name, const std::string& content, double scale = 1) {
    const auto s = read_surface(dir.write(name, content), scale);
    REQUIRE_FALSE(s);
    CHECK(s.error().find(name) != std::string::npos);
    return s.error();
  };
  CHECK(why("a.stl", stl_binary().substr(0, 200)).find("nor as long as its") == std::string::npos);
  std::string renamed = stl_binary();
  renamed[0] = 'x';
  CHECK(why("b.stl", renamed.substr(0, 200)).find("nor as long as its 4 triangles; the file is damaged") !=
        std::string::npos);
  CHECK(why("c.stl", "solid nothing\nendsolid\n").find("0 corners of triangles") != std::string::npos);
  CHECK(why("d.stl", "solid x\nvertex 0 0 nan\n").find("nan") != std::string::npos);
  CHECK(why("e.obj", "v 0 0 0\nf 1 2 3\n").find("none of the 1 points") != std::string::npos);
  CHECK(why("f.obj", obj_text(), -1).find("give a positive number") != std::string::npos);
  CHECK(read_surface(dir.file("none.obj")).error().find("there is no such file") != std::string::npos);
}

TEST_CASE("distances are read from VTK structured points and from SDFGen's text") {
  const TempDir dir;
  for (const auto& [name, content] : {std::pair{"a.vtk", vtk(false, "double")},
                                      {"b.vtk", vtk(true, "double")},
                                      {"c.vtk", vtk(true, "float")},
                                      {"d.sdf", sdf()}}) {
    INFO(name);
    const auto read = read_distances(dir.write(name, content), 2);
    REQUIRE(read);
    const DistanceGrid& g = read.value();
    CHECK(g.count == std::array<Index, 3>{5, 5, 5});
    CHECK(g.origin == Vec3{-2, -2, -2});
    CHECK(g.spacing == Vec3{1, 1, 1});
    REQUIRE(g.values.size() == 125);
    CHECK(g.values[3 + 5 * (1 + 5 * 4)] == Approx(2 * distance_at(3, 1, 4)).epsilon(1e-5));
    CHECK(field_solid(g));
  }
}

TEST_CASE("files of distances that are damaged are refused with file and remedy") {
  const TempDir dir;
  const auto why = [&](const std::string& name, const std::string& content) {
    const auto g = read_distances(dir.write(name, content));
    REQUIRE_FALSE(g);
    CHECK(g.error().find(name) != std::string::npos);
    return g.error();
  };
  CHECK(why("a.sdf", sdf().substr(0, 300)).find("truncated") != std::string::npos);
  CHECK(why("b.sdf", "5 5 0\n").find("give 4 to 100000 points an axis") != std::string::npos);
  CHECK(why("c.sdf", "no numbers at all").find("no") != std::string::npos);
  CHECK(why("d.vtk", vtk(true, "double").substr(0, 400)).find("truncated") != std::string::npos);
  std::string wrong = vtk(false, "double");
  wrong.replace(wrong.find("STRUCTURED_POINTS"), 17, "POLYDATA");
  CHECK(why("e.vtk", wrong).find("a distance field is STRUCTURED_POINTS") != std::string::npos);
  CHECK(why("f.vtk", vtk(false, "int")).find("write them as float or double") != std::string::npos);
}
