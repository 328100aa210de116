// Laws with constants of their own, and fields of fibers, as scene files give them.
#include <cmath>

#include "catch.h"
#include "engine/elements/material_model.h"
#include "isochor/generate.h"
#include "isochor/mesh_io.h"
#include "scenes/body_parts.h"
#include "small_scene.h"

using namespace isochor;
using Catch::Matchers::Contains;

namespace {

std::string scene_with(const std::string& material, const std::string& mesh) {
  return R"({"name": "s", "bodies": [{"name": "b", "mesh": )" + mesh +
         R"(, "element": "tet4", "materials": [)" + material + R"(]}], "analysis": {"steps": 2},
         "volumes": [{"space": "element"}],
         "dirichlet": [
           {"name": "x0", "where": {"surfaces": "x0"}, "directions": "x"},
           {"name": "y0", "where": {"surfaces": "y0"}, "directions": "y"},
           {"name": "z0", "where": {"surfaces": "z0"}, "directions": "z"},
           {"name": "x1", "where": {"surfaces": "x1"}, "directions": "x", "displacement": [0.5, 0, 0]}],
         "probes": [{"name": "side", "point": [1, 1, 1]}],
         "metrics": [{"name": "pull", "quantity": "reaction_force", "of": "x1", "component": "x"},
                     {"name": "side", "of": "side", "component": "y"}]})";
}

constexpr const char* kBox = R"({"box": {"upper": [1, 1, 1], "divisions": [1, 1, 1]}})";

Result<BuiltScene> built(const std::string& material, const std::string& folder = ".",
                         const std::string& mesh = kBox) {
  auto scene = parse_scene(scene_with(material, mesh), "s.json", folder);
  if (!scene) return Error{scene.error()};
  return build(scene.value());
}

std::string error_of(const std::string& material, const std::string& folder = ".",
                     const std::string& mesh = kBox) {
  auto b = built(material, folder, mesh);
  return b ? std::string("(none)") : b.error();
}

// Force on a cube of 1 m pulled to 1.5 times its length, sides free, and how its sides move.
std::pair<double, double> pulled(const std::string& material) {
  auto scene = parse_scene(scene_with(material, kBox), "s.json", ".");
  INFO((scene ? std::string() : scene.error()));
  REQUIRE(scene.ok());
  RunOptions options;
  options.threads = 1;
  const RunResult run = run_scene(scene.value(), options);
  INFO(run.reason);
  REQUIRE(run.status == RunStatus::converged);
  REQUIRE(run.metrics.size() == 2);
  return {run.metrics[0].value, run.metrics[1].value};
}

// The same of a block of W(J^(-2/3) I, J^(-4/3) II) and U(J) by bisection on the side's stretch: stresses by
// differences of the energy, which are exact enough for six digits.
template <class Energy>
std::pair<double, double> by_hand(const Energy& psi) {
  constexpr double a = 1.5, h = 1e-5;
  double low = 0.6, high = 1.1;
  for (int i = 0; i < 60; ++i) {
    const double b = 0.5 * (low + high);
    (psi(a, b + h) > psi(a, b - h) ? high : low) = b;
  }
  return {(psi(a + h, low) - psi(a - h, low)) / (2 * h), low - 1};
}

}  // namespace

TEST_CASE("scene files pull cubes of every uncoupled law as their energies say, with the U(J) chosen") {
  struct Law {
    const char* json;
    std::function<double(double I, double II)> W;
  };
  const Law laws[] = {
      {R"("law": "isochoric_mooney_rivlin", "c1": 2e4, "c2": 1e4, "c20": 1e3, "c11": -5e2, "c02": 2e2)",
       [](double I, double II) {
         const double x = I - 3, y = II - 3;
         return 2e4 * x + 1e4 * y + 1e3 * x * x - 5e2 * x * y + 2e2 * y * y;
       }},
      {R"("law": "isochoric_yeoh", "c": [1.7e4, -200, 23])",
       [](double I, double) {
         const double x = I - 3;
         return 1.7e4 * x - 200 * x * x + 23 * x * x * x;
       }},
      {R"("law": "isochoric_fung", "mu0": 1e3, "mu1": 0.8, "gamma": 2e4)",
       [](double I, double) { return 5e2 * (I - 3) + 1e4 * std::expm1(0.8 * (I - 3)); }},
      {R"("law": "isochoric_gent", "mu": 3e4, "jm": 8)",
       [](double I, double) { return -1.2e5 * std::log(1 - (I - 3) / 8); }},
      {R"("law": "isochoric_veronda_westmann", "c1": 2e4, "c2": 0.9)",
       [](double I, double II) { return 2e4 * std::expm1(0.9 * (I - 3)) - 0.9e4 * (II - 3); }},
      {R"("law": "isochoric_holmes_mow", "mu": 3e4, "beta": 0.6)",
       [](double I, double) { return 3e4 / 1.2 * std::expm1(0.6 * (I - 3)); }},
      {R"("law": "isochoric_arruda_boyce", "mu": 2e4, "locking_stretch": 2)",
       [](double I, double) {
         constexpr double C[] = {1.0 / 2, 1.0 / 20, 11.0 / 1050, 19.0 / 7000, 519.0 / 673750};
         double sum = 0;
         for (int i = 1; i <= 5; ++i)
           sum += 2e4 * C[i - 1] / std::pow(4.0, i - 1) * (std::pow(I, i) - std::pow(3.0, i));
         return sum;
       }},
      // alpha = 2 and -2 are the two invariants where J = 1.
      {R"("law": "isochoric_ogden", "terms": [{"mu": 3e4, "alpha": 2}, {"mu": -8e3, "alpha": -2}])",
       [](double I, double II) { return 1.5e4 * (I - 3) + 4e3 * (II - 3); }},
  };
  const double bulk = 2e5;
  const std::pair<const char*, std::function<double(double)>> volumes[] = {
      {"quadratic", [](double J) { return 0.5 * (J - 1) * (J - 1); }},
      {"logarithmic", [](double J) { return 0.5 * std::log(J) * std::log(J); }},
      {"mixed", [](double J) { return 0.25 * (J * J - 1 - 2 * std::log(J)); }}};
  for (const Law& law : laws) {
    for (const auto& [word, U] : volumes) {
      std::string json = "{";
      json.append(law.json).append(R"(, "bulk": 2e5, "volume_energy": ")").append(word).append("\"}");
      INFO(json);
      const auto [force, side] = pulled(json);
      const auto [expected, moved] = by_hand([&, &w = law.W, &u = U](double a, double b) {
        const double J = a * b * b, r = std::cbrt(J);
        return w((a * a + 2 * b * b) / (r * r), (2 * a * a * b * b + b * b * b * b) / (r * r * r * r)) +
               bulk * u(J);
      });
      CHECK(force == Approx(expected).epsilon(1e-6));
      CHECK(side == Approx(moved).epsilon(1e-6));
    }
  }
}

TEST_CASE("constants of laws are refused in scene files where they mean nothing or cannot be") {
  CHECK_THAT(error_of(R"({"law": "isochoric_yeoh", "c": [1], "jm": 3})"),
             Contains("jm belongs to the law gent"));
  CHECK_THAT(error_of(R"({"law": "neo_hookean", "young": 1, "volume_energy": "mixed"})"),
             Contains("volume_energy belongs to"));
  CHECK_THAT(error_of(R"({"law": "isochoric_gent", "mu": 1, "jm": 3, "young": 2})"),
             Contains("young is given"));
  CHECK_THAT(error_of(R"({"law": "isochoric_yeoh", "c": [1], "poisson": 0.3, "bulk": 4})"),
             Contains("both poisson = 0.3 and bulk = 4"));
  CHECK_THAT(error_of(R"({"law": "isochoric_gent", "mu": 1, "poisson": 0.4})"), Contains("jm = 0"));
  CHECK_THAT(error_of(R"({"law": "named", "name": "ecoflex", "poisson": 0.49})"),
             Contains("\"ecoflex\"") && Contains("ecoflex_00_30_marechal"));
  CHECK(error_of(R"({"law": "named", "name": "ecoflex_00_30_marechal", "poisson": 0.49})") == "(none)");
  CHECK(error_of(R"({"law": "isochoric_yeoh", "c": [1e4], "bulk": "inf"})") == "(none)");
  for (const char* softening : {R"({})", R"({"r": 0})", R"({"m": 1})"}) {
    CHECK_THAT(error_of(R"({"law": "isochoric_neo_hookean", "young": 1, "poisson": 0.4, "mullins": )" +
                        std::string(softening) + "}"),
               Contains("r = 0;"));
  }
}

TEST_CASE("a run that stops where Gent's law has no value any more says so") {
  // Twice the length has I >= 4 whatever the sides do.
  auto scene = parse_scene(scene_with(R"({"law": "gent", "mu": 1e4, "jm": 0.3, "poisson": 0.49})", kBox),
                           "s.json", ".", {"dirichlet[3].displacement=[1, 0, 0]"});
  REQUIRE(scene.ok());
  RunOptions options;
  options.threads = 1;
  const RunResult run = run_scene(scene.value(), options);
  CHECK(run.status == RunStatus::not_converged);
  // s^2 + 2/s = 3.3 at s = 1.3307.
  CHECK_THAT(run.reason, Contains("body \"b\"") && Contains("jm = 0.3") && Contains("stretch of 1.3"));
}

TEST_CASE("fibers follow a field of the mesh file, in its cells or at its nodes") {
  const test::Scratch folder("fiber_field");
  Mesh mesh = std::move(box_mesh({{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, CellType::tet4})).value();
  std::vector<double> in_cells, at_nodes, zero(3 * static_cast<std::size_t>(mesh.cell_count()), 0);
  for (Index c = 0; c < mesh.cell_count(); ++c)
    in_cells.insert(in_cells.end(), {0, c % 2 == 0 ? 2.0 : -1.0, 0});
  // Opposite signs at neighboring nodes are the same axis.
  for (Index n = 0; n < mesh.node_count(); ++n)
    at_nodes.insert(at_nodes.end(), {n % 2 == 0 ? 1.0 : -3.0, 0, 0});
  VtkGrid grid;
  grid.points = mesh.nodes;
  grid.cells = mesh.cells;
  grid.point_fields = {{"along x", 3, at_nodes}};
  grid.cell_fields = {{"along y", 3, in_cells}, {"nowhere", 3, zero}};
  REQUIRE(write_vtu((folder / "box.vtu").string(), grid).ok());
  const auto read = read_mesh((folder / "box.vtu").string());
  REQUIRE(read.ok());
  REQUIRE(read.value().cell_fields.size() == 2);
  CHECK(read.value().cell_fields[0].values == in_cells);
  const auto material = [&](const std::string& field) {
    MaterialDef def;
    def.constants = {1e4, 0.3, 0, -1, -1, BulkChoice::consistent};
    SceneFibers f;
    f.k1 = 1e5;
    f.field = field;
    def.fibers = {f};
    return make_material(def, folder.string(), &read.value());
  };
  for (const auto& [field, axis] : {std::pair{"along x", 0}, {"along y", 1}}) {
    INFO(field);
    const auto m = material(field);
    REQUIRE(m.ok());
    CHECK(m.value()->field_cells() == static_cast<std::size_t>(mesh.cell_count()));
    PointBatch points{};
    for (int l = 0; l < kLanes; ++l) {
      points.element[l] = l % mesh.cell_count();
      for (int i = 0; i < 3; ++i) points.F[4 * i][l] = i == axis ? 1.1 : 1;
    }
    ResponseBatch r;
    m.value()->distortional()->evaluate(Want::gradient, points, r);
    for (int l = 0; l < kLanes; ++l) CHECK(r.P[4 * axis][l] > 2 * 1e5 * 0.2 * 1.1);
  }
  const auto none = material("across");
  REQUIRE(!none.ok());
  CHECK_THAT(none.error(), Contains("\"across\"") && Contains("\"along y\"") && Contains("\"along x\""));
  const auto nowhere = material("nowhere");
  REQUIRE(!nowhere.ok());
  CHECK_THAT(nowhere.error(), Contains("directions[0] = (0, 0, 0)"));
}
