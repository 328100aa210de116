// write_vtu and write_pvd: what is written is read back, and a failure leaves nothing behind.
#include "mesh_support.h"

#if __has_include(<sys/resource.h>)
#include <signal.h>
#include <sys/resource.h>
#define ISOCHOR_TEST_FILE_LIMIT 1
#endif

using namespace mesh_test;
using isochor::VtkGrid;

namespace {

VtkGrid grid_of(const Mesh& mesh) {
  return {mesh.cell_type, mesh.nodes, mesh.cells, {}, {}};
}

}  // namespace

TEST_CASE("mesh write: what write_vtu writes, read_mesh reads", "[mesh]") {
  const TempDir dir;
  // The larger mesh needs several compressed blocks.
  for (const Mesh& mesh : {two_tets(), quadratic(cube_mesh(2)), cube_mesh(24, 0.1)}) {
    std::vector<double> weight, push, region;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      weight.push_back(std::sin(static_cast<double>(i)));
      push.insert(push.end(), {1.0 / 3, static_cast<double>(i), -1e-300});
    }
    for (Index c = 0; c < mesh.cell_count(); ++c) region.push_back(c % 2);
    VtkGrid grid = grid_of(mesh);
    grid.point_fields = {{"weight <&\">", 1, weight}, {"push", 3, push}};
    grid.cell_fields = {{"region", 1, region}};
    REQUIRE(isochor::write_vtu(dir.file("a.vtu"), grid).ok());
    const Mesh back = read(dir.file("a.vtu"));
    CHECK(back.cell_type == mesh.cell_type);
    CHECK(back.nodes == mesh.nodes);
    CHECK(back.cells == mesh.cells);
    CHECK(back.regions == std::vector<std::string>{"0", "1"});
    CHECK(std::vector<double>(back.cell_region.begin(), back.cell_region.end()) == region);
    REQUIRE(back.fields.size() == 2);
    CHECK(back.fields[0].name == "weight <&\">");
    CHECK(back.fields[0].values == weight);
    CHECK(back.fields[1].components == 3);
    CHECK(back.fields[1].values == push);
    CHECK(dir.entries() == 1);
  }
}

TEST_CASE("mesh write: a .vtu has VTK's cell types and is compressed", "[mesh]") {
  const TempDir dir;
  const Mesh mesh = cube_mesh(10);
  REQUIRE(isochor::write_vtu(dir.file("a.vtu"), grid_of(mesh)).ok());
  const std::string text = load(dir.file("a.vtu"));
  CHECK(mentions(text,
                 {"vtkZLibDataCompressor", "NumberOfCells=\"6000\"", "Name=\"types\"", "encoding=\"raw\""}));
  CHECK(text.size() < 6000 * 4 * 4);
}

TEST_CASE("mesh write: failures give path and reason and leave no file", "[mesh]") {
  const TempDir dir;
  const Mesh mesh = two_tets();
  CHECK(mentions(isochor::write_vtu(dir.file("no/such/a.vtu"), grid_of(mesh)).error(),
                 {"no/such/a.vtu", "No such file"}));
  CHECK(mentions(isochor::write_vtu(dir.file("."), grid_of(mesh)).error(), {"directory"}));
  VtkGrid bad = grid_of(mesh);
  const std::vector<double> three{1, 2, 3};
  bad.point_fields = {{"w", 1, three}};
  CHECK(mentions(isochor::write_vtu(dir.file("a.vtu"), bad).error(), {"'w'", "3 values", "5"}));
  bad.point_fields = {{"", 1, three}};
  CHECK_FALSE(isochor::write_vtu(dir.file("a.vtu"), bad).ok());
  const std::vector<Index> wild{0, 1, 2, 9};
  bad = grid_of(mesh);
  bad.cells = wild;
  CHECK(mentions(isochor::write_vtu(dir.file("a.vtu"), bad).error(), {"cell 0", "point 9"}));
  CHECK(dir.entries() == 0);
}

#ifdef ISOCHOR_TEST_FILE_LIMIT
TEST_CASE("mesh write: a full disk is reported and the old file stays", "[mesh]") {
  const TempDir dir;
  REQUIRE(isochor::write_vtu(dir.file("a.vtu"), grid_of(two_tets())).ok());
  const std::string before = load(dir.file("a.vtu"));
  // A limit on the file size fails a write just as a full disk does.
  rlimit old{};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &old) == 0);
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  rlimit small = old;
  small.rlim_cur = 2000;
  REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
  const Mesh mesh = cube_mesh(12);
  const auto result = isochor::write_vtu(dir.file("a.vtu"), grid_of(mesh));
  setrlimit(RLIMIT_FSIZE, &old);
  signal(SIGXFSZ, handler);
  CHECK(mentions(result.error(), {"a.vtu", "writing failed"}));
  CHECK(load(dir.file("a.vtu")) == before);
  CHECK(dir.entries() == 1);
}
#endif

TEST_CASE("mesh write: a .pvd lists files with times", "[mesh]") {
  const TempDir dir;
  const std::vector<isochor::PvdEntry> entries{{0, "a_0.vtu"}, {0.1, "a&1.vtu"}};
  REQUIRE(isochor::write_pvd(dir.file("a.pvd"), entries).ok());
  CHECK(
      mentions(load(dir.file("a.pvd")), {"type=\"Collection\"", "timestep=\"0.1\"", "file=\"a&amp;1.vtu\""}));
  REQUIRE(isochor::write_pvd(dir.file("a.pvd"), {}).ok());
  const std::vector<isochor::PvdEntry> endless{{std::nan(""), "a.vtu"}};
  CHECK_FALSE(isochor::write_pvd(dir.file("b.pvd"), endless).ok());
  CHECK(dir.entries() == 1);
}
