// Surfaces and node sets that a scene names by where they are, and names that the boundary has by itself:
// usable wherever a surface can be named.
#include <filesystem>
#include <fstream>

#include "catch.h"
#include "small_scene.h"

using namespace isochor;

namespace {

// A block with a void of one cubic centimeter, as a file without groups.
std::string hollow_file(const std::filesystem::path& folder) {
  const auto file = folder / "hollow.mesh";
  std::ofstream out(file);
  out << "MeshVersionFormatted 2\nDimension 3\nVertices\n64\n";
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) out << 0.01 * i << " " << 0.01 * j << " " << 0.01 * k << " 0\n";
    }
  }
  out << "Tetrahedra\n156\n";
  constexpr int kKuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                               {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  for (int cell = 0; cell < 27; ++cell) {
    if (cell == 13) continue;
    for (const auto& tet : kKuhn) {
      for (const int c : tet)
        out << 1 + cell % 3 + (c & 1) + 4 * (cell / 3 % 3 + (c >> 1 & 1) + 4 * (cell / 9 + (c >> 2))) << " ";
      out << "0\n";
    }
  }
  out << "End\n";
  std::ofstream(folder / "lid.obj") << "v 0 0 30\nv 30 0 30\nv 30 30 30\nv 0 30 30\nf 1 2 3\nf 1 3 4\n";
  return "hollow.mesh";
}

using test::Scratch;

std::string scene_text(const std::string& file, const std::string& more) {
  return R"({"bodies": [{"name": "b", "mesh": {"file": ")" + file + R"("},
    "surfaces": [
      {"name": "top", "plane": {"point": [0, 0, 0.03], "normal": [0, 0, 2]}},
      {"name": "bottom", "box": [[-1, -1, -1], [1, 1, 0]]},
      {"name": "side", "of": "outer", "seed": {"point": [0.05, 0.015, 0.015], "angle_deg": 10}},
      {"name": "lid", "file": "lid.obj", "scale": 0.001},
      {"name": "ceiling", "of": "chamber 1", "facing": {"direction": [0, 0, -1]}},
      {"name": "corner", "sphere": {"center": [0, 0, 0.03], "radius": 0.0143}}],
    "node_sets": [{"name": "foot", "plane": {"normal": [0, 0, 1]}}],
    "materials": [{"young": 1e5, "poisson": 0.45}]}],
  "analysis": {"steps": 1}, "outputs": {"every": 0, "page": false},
  "dirichlet": [{"name": "hold", "where": {"node_sets": "foot"}}])" +
         more + "}";
}

std::string outcome(const Scratch& folder, const std::string& more) {
  const auto scene =
      parse_scene(scene_text(hollow_file(folder.string()), more), "places", folder.string(), {});
  if (!scene) return scene.error();
  // Written and read again it is the same.
  const auto again = parse_scene(to_json(scene.value()), "again", folder.string(), {});
  if (!again) return again.error();
  CHECK(to_json(again.value()) == to_json(scene.value()));
  const auto built = build(again.value(), {1, nullptr});
  return built ? "built" : built.error();
}

}  // namespace

TEST_CASE("surfaces by place, and those of the boundary, can be named wherever a surface can") {
  const Scratch folder("places");
  for (const std::string name : {"top", "bottom", "side", "lid", "ceiling", "corner", "outer", "chamber 1"}) {
    const std::string one = "\"surfaces\": \"" + name + "\"";
    const bool chamber = name == "chamber 1";
    std::vector<std::string> uses = {
        R"("dirichlet": [{"name": "d", "where": {)" + one + "}}]",
        R"("tractions": [{"name": "t", "surface": ")" + name + R"(", "traction": [0, 0, 1]}])",
        R"("pressures": [{"name": "p", )" + one + R"(, "amount": 10}])",
        R"("epidermis": [{)" + one + R"(, "stiffness": 1}])",
        R"("membranes": [{)" + one + R"(, "young": 1e5, "thickness": 1e-4}])",
        R"("shells": [{)" + one + R"(, "young": 1e5, "thickness": 1e-4}])",
        R"("layers": [{"name": "l", )" + one + R"(, "stiffness": 1}])",
        R"("contacts": [{"name": "c", )" + one + R"(, "obstacle": {"position": [0, 0, -1]}}])",
        R"("cavities": [{"name": "v", )" + one + R"(, "amount": 10, "cap_free_openings": true}])",
    };
    if (!chamber) uses.push_back(R"("surface_contacts": [{"name": "s", )" + one + "}]");
    for (const std::string& use : uses) {
      INFO(name << ": " << use);
      // What is held has no contact.
      if (name == "bottom" && use.starts_with("\"contacts\"")) continue;
      std::string text = "," + use;
      // The support of the text above stays, under another list where this is one.
      if (use.starts_with("\"dirichlet\""))
        text = R"(,"forces": [{"name": "f", "where": {)" + one + R"(}, "force": [0, 0, 1]}])";
      CHECK(outcome(folder, text) == "built");
    }
  }
}

TEST_CASE("places that cannot be are refused with body, entry and number") {
  const auto refused = [](const std::string& surfaces) {
    const std::string text = R"({"bodies": [{"name": "b", "mesh": {"box": {}}, "surfaces": )" + surfaces +
                             R"(, "materials": [{"young": 1e5, "poisson": 0.4}]}]})";
    const auto scene = parse_scene(text, "bad", ".", {});
    if (!scene) return scene.error();
    const auto built = build(scene.value(), {1, nullptr});
    return built ? std::string("built") : built.error();
  };
  using Catch::Matchers::Contains;
  CHECK_THAT(refused(R"([{"name": "a", "box": [[5, 5, 5], [6, 6, 6]]}])"),
             Contains("bodies[0].surfaces[0]") && Contains("no boundary face"));
  CHECK_THAT(refused(R"([{"name": "x0", "box": [[0, 0, 0], [1, 1, 1]]}])"),
             Contains("surfaces[0]") && Contains("x0"));
  CHECK_THAT(refused(R"([{"name": "a", "of": "x0"}, {"name": "a", "of": "x1"}])"), Contains("used already"));
  CHECK_THAT(refused(R"([{"name": "a\u0007", "of": "x0"}])"),
             Contains("U+0007") && Contains("control character"));
  CHECK_THAT(refused(R"([{"name": "a"}])"), Contains("nothing says"));
  CHECK_THAT(refused(R"([{"name": "a", "file": "none.stl"}])"),
             Contains("surfaces[0].file") && Contains("none.stl"));
  CHECK_THAT(refused(R"([{"name": "a", "seed": {}}])"), Contains("surfaces[0].seed") && Contains("point"));
  CHECK_THAT(refused(R"([{"name": "a", "box": [[0, 0, 0]]}])"), Contains("two corners"));
}
