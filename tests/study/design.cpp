// `isochor design`: fields and shapes that were hidden are found again, bounds are kept, meshes stay whole.
#include "studies/design/design.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>

#include "catch.h"
#include "scenes/scene_file.h"
#include "studies/design/smooth_field.h"
#include "studies/design/write_gmsh.h"
#include "studies/inverse/data_report.h"
#include "support/dense.h"
#include "support/worlds.h"

using namespace isochor;
using namespace isochor::design;
using Catch::Matchers::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using test::value;
namespace fs = std::filesystem;

namespace {

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("isochor_design_" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code none;
    fs::remove_all(path_, none);
  }
  std::string file(const char* name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

// A slab that is held below and loaded three ways, one after the other.
SceneDef slab(const std::array<int, 3>& divisions, const Overrides& overrides = {}) {
  Overrides all{"bodies[0].mesh.box.divisions=[" + std::to_string(divisions[0]) + "," +
                std::to_string(divisions[1]) + "," + std::to_string(divisions[2]) + "]"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return value(parse_scene(R"({
    "bodies": [{"name": "slab", "element": "tet4",
                "mesh": {"box": {"upper": [0.12, 0.1, 0.07], "divisions": [1, 1, 1]}},
                "materials": [{"young": 100000, "poisson": 0.5}]}],
    "analysis": {"duration": 3, "steps": 3},
    "dirichlet": [{"name": "floor", "where": {"surfaces": "z0"}}],
    "tractions": [
      {"name": "along", "surface": "z1", "traction": [2000, 0, 0], "amount": [[0, 0], [1, 1], [2, 0], [3, 0]]},
      {"name": "across", "surface": "z1", "traction": [0, 2000, 0], "amount": [[0, 0], [1, 0], [2, 1], [3, 0]]},
      {"name": "push", "surface": "x1", "traction": [-3000, 0, 1000], "amount": [[0, 0], [2, 0], [3, 1]]}],
    "probes": [{"name": "corner", "point": [0.12, 0.1, 0.07]}, {"name": "top", "point": [0.06, 0.05, 0.07]}]
  })",
                           "slab", ".", all));
}

// Markers on the free sides, about every third node, at three times; where they are seen is left at 1.
inverse::Data markers_on(const SceneDef& scene, std::size_t every) {
  const BuiltScene built = value(build(scene, {.threads = 1}));
  const Mesh& mesh = built.world.mesh(built.bodies[0]);
  std::set<Index> nodes;
  for (const MeshSurface& s : mesh.surfaces) {
    if (s.name != "z0") nodes.insert(s.faces.begin(), s.faces.end());
  }
  std::string text = "time,X,Y,Z,x,y,z\n";
  for (const char* time : {"1", "2", "3"}) {
    std::size_t k = 0;
    for (const Index n : nodes) {
      if (k++ % every != 0) continue;
      const Vec3& x = mesh.nodes[static_cast<std::size_t>(n)];
      text += std::string(time) + "," + inverse::full(x.x) + "," + inverse::full(x.y) + "," +
              inverse::full(x.z) + ",1,1,1\n";
    }
  }
  return value(inverse::parse_data(text, "markers", scene));
}

void fill(inverse::Data& data, const SceneDef& truth, double noise, unsigned seed) {
  const inverse::Answer made = value(inverse::answer(truth, data, {}, 1));
  INFO(made.reason);
  REQUIRE(made.found);
  for (std::size_t i = 0; i < data.values.size(); ++i)
    data.values[i].value = made.values[static_cast<Eigen::Index>(i)];
  const Eigen::VectorXd scale = inverse::scales(data, made);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < data.values.size(); ++i)
    data.values[i].value += noise * scale[static_cast<Eigen::Index>(i)] * normal(random);
}

Mesh mesh_of(const SceneDef& scene) {
  const BuiltScene built = value(build(scene, {.threads = 1}));
  return built.world.mesh(built.bodies[0]);
}

DesignOptions options_in(const Folder& folder) {
  DesignOptions options;
  options.threads = 1;
  options.folder = folder.path();
  return options;
}

struct Hidden {
  double error = 0, expected = 0, prior = 0;  // root mean squares of logarithms of factors
  double within_two = 0;                      // share of cells within two deviations
  Design found;
};

// A field drawn from what is taken for granted, seen by markers with errors, and found again.
Hidden hide_and_seek(const std::array<int, 3>& divisions, std::size_t every, unsigned seed) {
  const Folder folder;
  const double noise = 1e-3, length = 0.03, spread = 0.5;
  SceneDef scene = slab(divisions);
  const Mesh mesh = mesh_of(scene);
  const SmoothField field(mesh, length, spread);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd white(field.cells());
  for (double& w : white) w = normal(random);
  const Eigen::VectorXd truth = field.field(white);
  SceneDef hidden = scene;
  for (const double m : truth) hidden.bodies[0].materials[0].stiffness_field.values.push_back(std::exp(m));
  inverse::Data data = markers_on(scene, every);
  fill(data, hidden, noise, seed + 1);
  DesignOptions options = options_in(folder);
  options.noise = noise;
  options.stiffness = StiffnessField{"slab", length, spread, 1e-3, 1e3};
  Hidden out;
  out.found = value(design::design(scene, data, options));
  const auto n = static_cast<std::size_t>(truth.size());
  REQUIRE(out.found.factor.size() == n);
  for (std::size_t c = 0; c < n; ++c) {
    const double m = truth[static_cast<Eigen::Index>(c)], off = std::log(out.found.factor[c]) - m;
    out.error += off * off / static_cast<double>(n);
    out.expected += out.found.deviation[c] * out.found.deviation[c] / static_cast<double>(n);
    out.prior += m * m / static_cast<double>(n);
    out.within_two += std::abs(off) < 2 * out.found.deviation[c] ? 1.0 / static_cast<double>(n) : 0;
  }
  out.error = std::sqrt(out.error);
  out.expected = std::sqrt(out.expected);
  out.prior = std::sqrt(out.prior);
  return out;
}

}  // namespace

TEST_CASE("meshes that designs write are read again bit by bit", "[design]") {
  const Folder folder;
  const Vec3 lower{-0.1, 0.2, 1.0 / 3}, upper{0.7, 0.9, 1.1};
  for (const Mesh& mesh :
       {test::block(lower, upper, {2, 3, 1}), to_tet10(test::block(lower, upper, {2, 1, 2})),
        test::block(lower, upper, {2, 2, 3}, CellType::hex8)}) {
    value(write_gmsh(folder.file("mesh.msh"), mesh));
    const Mesh read = value(read_mesh(folder.file("mesh.msh")));
    CHECK(read.cell_type == mesh.cell_type);
    CHECK(read.nodes == mesh.nodes);
    CHECK(read.cells == mesh.cells);
    CHECK(read.regions == mesh.regions);
    REQUIRE(read.surfaces.size() == mesh.surfaces.size());
    for (const MeshSurface& s : mesh.surfaces) {
      const auto same = std::find_if(read.surfaces.begin(), read.surfaces.end(),
                                     [&](const MeshSurface& r) { return r.name == s.name; });
      REQUIRE(same != read.surfaces.end());
      CHECK(same->faces == s.faces);
    }
  }
}

TEST_CASE("a surface moves, what is held stays, and nothing between moves farther", "[design]") {
  for (const CellType type : {CellType::tet4, CellType::hex8}) {
    const Mesh mesh = test::block({0, 0, 0}, {3, 2, 1}, {6, 4, 3}, type);
    const Morph slide = value(Morph::make(mesh, {{"x1", 'n', -1, 1}}, {"x0"}));
    const Morph shut = value(Morph::make(mesh, {{"z1", 'z', -1, 1}, {"x1", 'n', -1, 1}}, {}));
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const Vec3 m = slide.motions()[0][n], s = shut.motions()[0][n];
      const Vec3& x = mesh.nodes[n];
      CHECK(m.x >= -1e-12);
      CHECK(m.x <= 1 + 1e-12);
      CHECK(std::abs(m.y) + std::abs(m.z) < 1e-12);
      if (x.x == 0) CHECK(m.x == 0);
      if (x.x == 3) CHECK(m.x == 1);
      if (x.z == 1) CHECK(s.z == 1);
      if (x.z == 0) CHECK(s.z == 0);
    }
    CHECK_THAT(slide.volume({0}), WithinRel(6, 1e-12));
    CHECK_THAT(slide.volume({0.5}), WithinRel(7, 1e-12));
    CHECK_THAT(slide.quality({0}), WithinAbs(1, 1e-12));
    CHECK(slide.quality({-3.1}) < 0);
  }
  CHECK_THAT(Morph::make(test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), {{"x1", 'n', -1, 1}}, {"x1"}).error(),
             Contains("held"));
}

TEST_CASE("what is taken for granted of a field is one operator in all its uses", "[design]") {
  const Mesh mesh = test::block({0, 0, 0}, {0.3, 0.2, 0.2}, {3, 2, 2});
  const SmoothField field(mesh, 0.1, 0.7);
  const auto n = field.cells();
  Eigen::MatrixXd B(n, n);
  for (Eigen::Index c = 0; c < n; ++c) B.col(c) = field.field(Eigen::VectorXd::Unit(n, c));
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(7, n, [&] { return 3 * normal(random); });
  const Eigen::MatrixXd JB = test::product(J, B);
  CHECK((field.times(J) - JB).norm() < 1e-12 * JB.norm());
  const Eigen::MatrixXd inner = Eigen::MatrixXd::Identity(n, n) + test::product(JB.transpose(), JB);
  const Eigen::MatrixXd covariance = test::product(B, test::solve(inner, B.transpose()));
  const Eigen::VectorXd direct = covariance.diagonal().cwiseSqrt();
  CHECK((field.deviations(J) - direct).norm() < 1e-9 * direct.norm());
  // Far from its ends a long bar shows the spread that was asked for, within what a graph of tets makes of
  // it.
  const Mesh cube = test::block({0, 0, 0}, {1, 1, 1}, {10, 10, 10});
  const SmoothField bulk(cube, 0.2, 0.7);
  const Eigen::VectorXd alone = bulk.deviations(Eigen::MatrixXd::Zero(1, bulk.cells()));
  double least = HUGE_VAL;
  for (const double d : alone) least = std::min(least, d);
  CHECK(least > 0.5 * 0.7);
  CHECK(least < 1.5 * 0.7);
}

TEST_CASE("a hidden stiffness field of 5,000 cells is recovered from markers on the surface", "[design]") {
  const Hidden h = hide_and_seek({12, 10, 7}, 24, 11);
  CAPTURE(h.error, h.expected, h.prior, h.within_two, h.found.error, h.found.reason);
  CHECK(h.found.factor.size() == 5040);
  CHECK(h.found.converged);
  // The error of what is found has the covariance P = B (1 + B'J'JB)^-1 B' (docs/design.md), so that its mean
  // square is tr P / n, give or take sqrt(2 tr P^2) / n: some hundred modes make that a tenth.
  CHECK(h.error < 1.25 * h.expected);
  CHECK(h.error > 0.8 * h.expected);
  CHECK(h.within_two > 0.9);
  CHECK(h.expected < 0.7 * h.prior);
  CHECK(h.found.error < 1.1);
}

TEST_CASE("fields of other draws are recovered as well as is said", "[design]") {
  double errors = 0, expected = 0;
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    const Hidden h = hide_and_seek({5, 4, 3}, 2, seed);
    CAPTURE(seed, h.error, h.expected, h.prior, h.found.reason);
    CHECK(h.found.converged);
    CHECK(h.error < 1.5 * h.expected);
    errors += h.error * h.error;
    expected += h.expected * h.expected;
  }
  CHECK(errors < 1.5 * expected);
  CHECK(errors > expected / 1.5);
}

TEST_CASE("a shape that was hidden is found again", "[design]") {
  const Folder folder;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-0.02, 0.02);
  for (const char* element : {"tet4", "tet4_edge_smoothed", "tet10"}) {
    const std::array<double, 2> moves{anywhere(random), anywhere(random)};
    CAPTURE(element, moves[0], moves[1]);
    const SceneDef scene = slab({4, 3, 3}, {std::string("bodies[0].element=") + element});
    DesignOptions options = options_in(folder);
    for (const char* text : {"x1=-0.03:0.03", "slab:y1.y=-0.03:0.03"})
      options.moves.push_back(value(parse_move(text, scene)));
    options.hold = {"x0", "y0"};
    // The mesh that moved is another scene's.
    Mesh moved = mesh_of(scene);
    const Morph morph = value(Morph::make(moved, {options.moves.begin(), options.moves.end()}, options.hold));
    moved.nodes = morph.nodes({moves[0], moves[1]});
    value(write_gmsh(folder.file("truth.msh"), moved));
    SceneDef truth = scene;
    truth.bodies[0].mesh = MeshFile{folder.file("truth.msh")};
    truth.probes[0].point = {0.12 + moves[0], 0.1 + moves[1], 0.07};
    inverse::Data data = value(
        inverse::parse_data("time,corner.x,corner.y,corner.z\n1,1,1,1\n2,1,1,1\n3,1,1,1\n", "wanted", scene));
    fill(data, truth, 0, 1);
    const Design found = value(design::design(scene, data, options));
    CAPTURE(found.reason, found.note, found.error);
    CHECK(found.reached);
    CHECK_THAT(found.moves[0].value, WithinAbs(moves[0], 1e-7));
    CHECK_THAT(found.moves[1].value, WithinAbs(moves[1], 1e-7));
    CHECK(found.history.size() > 1);
    // The scene that results answers what is told of it.
    inverse::Data again = data;
    const inverse::Answer told = value(inverse::answer(found.scene, again, {}, 1));
    CHECK((told.values - found.found).norm() < 1e-9);
  }
}

TEST_CASE("bounds of moves, volume and mesh are kept", "[design]") {
  const Folder folder;
  const SceneDef scene = slab({4, 3, 3});
  inverse::Data data =
      value(inverse::parse_data("time,corner.x\n1,0.121\n", "wanted", scene));  // stiffer than it can be
  DesignOptions options = options_in(folder);
  options.moves = {value(parse_move("z1=-0.05:0.02", scene))};
  options.hold = {"z0"};
  const Design bounded = value(design::design(scene, data, options));
  CAPTURE(bounded.moves[0].value, bounded.quality, bounded.note);
  CHECK(bounded.moves[0].value >= -0.05);
  CHECK(bounded.quality >= 0.2);
  options.least_volume = 0.9 * 0.12 * 0.1 * 0.07;
  const Design heavy = value(design::design(scene, data, options));
  CAPTURE(heavy.volume, heavy.moves[0].value);
  CHECK(heavy.volume > (1 - 1e-6) * *options.least_volume);
  CHECK(heavy.volume < (1 + 1e-3) * *options.least_volume);
  CHECK_FALSE(heavy.reached);
  options.least_volume.reset();
  options.least_quality = 0.8;
  const Design whole = value(design::design(scene, data, options));
  CAPTURE(whole.quality, whole.moves[0].value, whole.note);
  CHECK(whole.quality >= 0.8);
  CHECK(whole.quality < 0.85);
}

TEST_CASE("a design that is stopped keeps what it has", "[design]") {
  const Folder folder;
  const SceneDef scene = slab({4, 3, 3});
  const inverse::Data data = value(inverse::parse_data("time,corner.x\n1,0.123\n", "wanted", scene));
  DesignOptions options = options_in(folder);
  options.moves = {value(parse_move("z1=-0.05:0.02", scene))};
  options.hold = {"z0"};
  int steps = 0;
  options.on_iteration = [&](int iteration, double) { steps = iteration; };
  options.stop = [&] { return steps >= 2; };
  const Design stopped = value(design::design(scene, data, options));
  CHECK(stopped.interrupted);
  CHECK(steps == 2);
  REQUIRE_FALSE(stopped.history.empty());
  CHECK(stopped.moves[0].value == stopped.history.back().moves[0]);
  CHECK(stopped.error < 0.5 * stopped.error_before);
}

TEST_CASE("designs refuse what means nothing", "[design]") {
  const Folder folder;
  const SceneDef scene = slab({2, 2, 2});
  const inverse::Data data = value(inverse::parse_data("time,corner.x\n1,0.125\n", "wanted", scene));
  const auto refusal = [&](const DesignOptions& options, const inverse::Data& wanted) {
    const auto made = design::design(scene, wanted, options);
    REQUIRE_FALSE(made.ok());
    return made.error();
  };
  DesignOptions options = options_in(folder);
  CHECK_THAT(refusal(options, data), Contains("nothing may be chosen"));
  options.moves = {{{"nowhere", 'n', -0.01, 0.01}, "slab"}};
  CHECK_THAT(refusal(options, data), Contains("nowhere"));
  options.moves = {{{"x1", 'n', 0.01, 0.02}, "slab"}};
  CHECK_THAT(refusal(options, data), Contains("must lie between"));
  options.moves = {{{"x1", 'n', -0.01, 0.01}, "slab"}};
  const inverse::Data far = value(inverse::parse_data("time,corner.x\n1,125\n", "wanted", scene));
  CHECK_THAT(refusal(options, far), Contains("meters"));
  options.most_volume = 1e6;
  options.least_volume = 1e5;
  CHECK_THAT(refusal(options, data), Contains("cubic meters"));
  options = options_in(folder);
  options.stiffness = StiffnessField{"nobody", 0.03, 0.5, 0.1, 10};
  CHECK_THAT(refusal(options, data), Contains("nobody"));
  options.stiffness = StiffnessField{"slab", 0.03, 0.5, 2, 10};
  CHECK_THAT(refusal(options, data), Contains("must lie between"));
  CHECK_FALSE(parse_move("x1", scene).ok());
  CHECK_FALSE(parse_move("x1=nan:1", scene).ok());
  CHECK(value(parse_move("slab:x1.z=-1:2", scene)).along == 'z');
}
