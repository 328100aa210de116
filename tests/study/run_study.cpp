// Studies run, stop, go on and show what failed.
#include "studies/run_study.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "catch.h"
#include "studies/formulations.h"
#include "studies/problems.h"
#include "studies/store.h"
#include "support/files.h"

using namespace isochor;
using namespace isochor::studies;
namespace fs = std::filesystem;
using files::slurp;

namespace {

SceneDef block(double poisson) {
  SceneDef s;
  s.name = "block";
  SceneBody body;
  body.mesh = BoxMeshDef{{0, 0, 0}, {2, 1, 1}, {2, 1, 1}};
  MaterialDef m;
  m.constants.young = 1000;
  m.constants.poisson = poisson;
  body.materials = {m};
  s.bodies = {body};
  DirichletDef wall;
  wall.name = "wall";
  wall.where.surfaces = {"x0"};
  s.dirichlet = {wall};
  TractionDef pull;
  pull.name = "pull";
  pull.surface = "x1";
  pull.traction = {100, 0, 0};
  s.tractions = {pull};
  s.analysis.steps = 1;
  s.probes = {{"tip", {}, {2, 0.5, 0.5}}};
  MetricDef tip;
  tip.name = "tip";
  tip.of = "tip";
  tip.component = Component::x;
  s.metrics = {tip};
  return s;
}

// Two that work and, between them, one that a one-field body refuses.
std::vector<Cell> three_cells(bool) {
  std::vector<Cell> out(3);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].id = "cell" + std::to_string(i);
    out[i].scene = block(i == 0 ? 0.5 : 0.4);
    out[i].metric = "tip";
    out[i].reference = 0.2;
    out[i].source = "a, \"source\"";
  }
  out[1].scene = block(0.5);
  out[1].scene.volumes = std::vector<VolumeRows>(1);
  out[1].scene.volumes->front().none = true;
  return out;
}

std::vector<Section> present(std::span<const Measured> cells) {
  Section s{"cells", ""};
  s.tables = {{"", {"id"}, {}}};
  for (const Measured& m : cells) s.tables[0].rows.push_back({m.id});
  return {s};
}

const Study kStudy{"small", "Small", "Does it run?", three_cells, present, 2};

struct Folder {
  Folder() : path(fs::temp_directory_path() / ("isochor_study_" + std::to_string(::getpid()))) {
    fs::remove_all(path);
  }
  ~Folder() {
    std::error_code code;
    fs::remove_all(path, code);
  }
  fs::path path;
};

}  // namespace

TEST_CASE("a study runs its cells and shows the one that failed as failed") {
  const Folder folder;
  StudyOptions options;
  options.folder = folder.path.string();
  options.threads = 1;
  const StudyResult r = run_study(kStudy, options);
  CHECK(r.status == StudyStatus::complete);
  REQUIRE(r.cells.size() == 3);
  CHECK(r.not_good == 1);
  CHECK(r.kept == 0);
  CHECK(r.cells[0].good());
  CHECK(r.cells[0].repeats == 2);
  CHECK(r.cells[0].error.value() == Approx(std::abs(*r.cells[0].value - 0.2) / 0.2));
  CHECK(r.cells[0].factorizations >= r.cells[0].iterations);
  CHECK(r.cells[0].solves >= r.cells[0].iterations);
  CHECK(r.cells[0].iterations > 0);
  CHECK(r.cells[0].seconds <= r.cells[0].seconds_median);
  CHECK(r.cells[0].hash.size() == 16);
  CHECK(r.cells[1].status == "bad_input");
  CHECK_FALSE(r.cells[1].error);
  CHECK_FALSE(r.cells[1].reason.empty());
  const std::string csv = slurp(folder.path / "results.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 4);
  CHECK(csv.find("bad_input") != std::string::npos);
  CHECK(csv.find("\"a, \"\"source\"\"\"") != std::string::npos);
  // What is written is what is read.
  const auto read = read_results((folder.path / "results.json").string());
  REQUIRE(read.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(read[i].id == r.cells[i].id);
    CHECK(read[i].fingerprint == r.cells[i].fingerprint);
    CHECK(read[i].value == r.cells[i].value);
    CHECK(read[i].hash == r.cells[i].hash);
    CHECK(read[i].values == r.cells[i].values);
  }
}

TEST_CASE("a stopped study leaves what it has and goes on from there") {
  const Folder folder;
  StudyOptions options;
  options.folder = folder.path.string();
  options.threads = 1;
  int asked = 0;
  options.on_cell = [&](const CellProgress&) { ++asked; };
  options.stop = [&] { return asked >= 1; };
  const StudyResult first = run_study(kStudy, options);
  CHECK(first.status == StudyStatus::interrupted);
  CHECK(first.cells.size() == 1);
  CHECK(read_results((folder.path / "results.json").string()).size() == 1);
  CHECK(fs::exists(folder.path / "results.csv"));
  CHECK(fs::exists(folder.path / "tables.md"));
  options.stop = nullptr;
  std::set<std::string> kept;
  options.on_cell = [&](const CellProgress& p) {
    if (p.kept) kept.insert(p.cell.id);
  };
  CHECK(run_study(kStudy, options).kept == 1);
  CHECK(kept == std::set<std::string>{"cell0"});
  CHECK(run_study(kStudy, options).kept == 3);
  options.fresh = true;
  CHECK(run_study(kStudy, options).kept == 0);
  // Cells further down the list survive a run that is stopped before it reaches them.
  options.fresh = false;
  options.stop = [] { return true; };
  CHECK(run_study(kStudy, options).status == StudyStatus::interrupted);
  CHECK(read_results((folder.path / "results.json").string()).size() == 3);
}

TEST_CASE("a study measures the cells whose names hold a text, and says when there are none") {
  const Folder folder;
  StudyOptions options;
  options.folder = folder.path.string();
  options.threads = 1;
  options.only = "ll2";
  const StudyResult one = run_study(kStudy, options);
  CHECK(one.status == StudyStatus::complete);
  REQUIRE(one.cells.size() == 1);
  CHECK(one.cells[0].id == "cell2");
  CHECK(one.total == 3);
  CHECK(slurp(folder.path / "results.json").find("\"complete\": true") == std::string::npos);
  // What other runs left in the folder stays.
  options.only = "cell0";
  std::size_t of = 0;
  options.on_cell = [&](const CellProgress& p) { of = p.total; };
  CHECK(run_study(kStudy, options).cells.size() == 2);
  CHECK(of == 1);
  CHECK(read_results((folder.path / "results.json").string()).size() == 2);
  options.only = "";
  CHECK(run_study(kStudy, options).kept == 2);
  options.only = "cell9";
  const StudyResult none = run_study(kStudy, options);
  CHECK(none.status == StudyStatus::failed);
  CHECK(none.reason.find("\"cell9\"") != std::string::npos);
  CHECK(none.reason.find("\"cell0\"") != std::string::npos);
  CHECK(read_results((folder.path / "results.json").string()).size() == 3);
}

TEST_CASE("a cell is measured again when what decides its numbers changed") {
  const Cell cell = three_cells(false)[0];
  const std::string before = fingerprint(cell, 1, 2);
  CHECK(fingerprint(cell, 1, 2) == before);
  CHECK(fingerprint(cell, 2, 2) != before);
  CHECK(fingerprint(cell, 1, 3) != before);
  Cell other = cell;
  other.scene.bodies[0].materials[0].constants.young *= 1 + 1e-15;
  CHECK(fingerprint(other, 1, 2) != before);
  other = cell;
  other.reference = 0.3;
  CHECK(fingerprint(other, 1, 2) != before);
}

TEST_CASE("a folder that cannot be made is said") {
  StudyOptions options;
  options.folder = "/dev/null/study";
  const StudyResult r = run_study(kStudy, options);
  CHECK(r.status == StudyStatus::failed);
  CHECK(r.reason.find("--out") != std::string::npos);
}

TEST_CASE("every study has cells with names of their own, and more of them at default size") {
  for (const Study& s : studies::studies()) {
    INFO(std::string(s.name));
    for (const bool quick : {true, false}) {
      std::set<std::string> ids;
      const auto cells = s.cells(quick);
      for (const Cell& c : cells) ids.insert(c.id);
      CHECK(ids.size() == cells.size());
    }
    CHECK(s.cells(true).size() <= s.cells(false).size());
    // A page of nothing is a page.
    CHECK_FALSE(s.present({}).empty());
  }
}

TEST_CASE("every formulation builds") {
  for (const Formulation& f : formulations()) {
    SceneDef scene = block(0.4);
    apply(f, scene);
    auto built = build(scene);
    INFO(std::string(f.name) << ": " << (built ? std::string() : built.error()));
    CHECK(built.ok());
    CHECK(&formulation(f.name) == &f);
  }
  // One-field bodies get a ratio that they can have, the others keep 0.5.
  SceneDef scene = block(0.5);
  apply(formulation("tet10_node"), scene);
  CHECK(scene.bodies[0].materials[0].constants.poisson == 0.5);
  apply(formulation("tet4"), scene);
  CHECK(scene.bodies[0].materials[0].constants.poisson == kOneFieldPoisson);
  // A zone has its penalty, and no other formulation keeps it; boxes have the cells of the element.
  scene = block(0.5);
  apply(formulation("tet4_zone"), scene);
  CHECK(scene.bodies[0].materials[0].compression_penalty.modulus > 0);
  apply(formulation("hex8_node"), scene);
  CHECK(scene.bodies[0].materials[0].compression_penalty.modulus == 0);
  CHECK(std::get<BoxMeshDef>(scene.bodies[0].mesh).cell_type == CellType::hex8);
}

TEST_CASE("every problem has its meshes, and two levels of most formulations") {
  for (const Problem& p : problems()) {
    for (const Formulation& f : formulations()) {
      INFO(std::string(p.name) << ", " << std::string(f.name));
      // Robots have no meshes of hexahedra.
      if (level_count(p, f) == 0) {
        CHECK(f.hexahedra());
        continue;
      }
      const Cell c = problem_cell(p, f, 0);
      CHECK(c.reference.value_or(0) != 0);
      CHECK_FALSE(c.source.empty());
      if (f.space == VolumeSpace::element) continue;  // may be refused, which is part of the answer
      auto built = build(c.scene, {1});
      INFO((built ? std::string() : built.error()));
      CHECK(built.ok());
    }
  }
}

TEST_CASE("a cell with outputs leaves none behind and ends in the same state") {
  Cell c;
  c.id = "block";
  c.scene = block(0.4);
  const Measured without = measure(c, 1, 0, 1, {});
  c.outputs = true;
  const auto count = [] {
    std::size_t n = 0;
    for (const auto& entry : fs::directory_iterator(fs::temp_directory_path()))
      n += entry.path().filename().string().rfind("isochor-", 0) == 0;
    return n;
  };
  const std::size_t before = count();
  const Measured with = measure(c, 1, 0, 1, {});
  CHECK(with.good());
  CHECK(with.hash == without.hash);
  CHECK(with.fingerprint != without.fingerprint);
  CHECK(count() <= before);
}
