// What is wrong in a scene file is said with file, place, value and remedy; nothing crashes.
#include <random>

#include "catch.h"
#include "small_scene.h"

using namespace isochor;
using Catch::Matchers::Contains;

namespace {

std::string error_of(const std::string& text) {
  auto scene = parse_scene(text, "s.json", ".");
  return scene ? std::string("(none)") : scene.error();
}

std::string error_with(const std::string& assignment) {
  auto scene = parse_scene(test::small_text(), "s.json", ".", {assignment});
  return scene ? std::string("(none)") : scene.error();
}

// Through to the compiled world, where names of surfaces and values of materials are judged.
std::string build_error_with(const std::string& assignment) {
  auto scene = parse_scene(test::small_text(), "s.json", ".", {assignment});
  if (!scene) return scene.error();
  auto built = build(scene.value());
  return built ? std::string("(none)") : built.error();
}

}  // namespace

TEST_CASE("syntax is reported with file and line") {
  CHECK_THAT(error_of("{\n \"bodies\": [,]\n}"), Contains("s.json") && Contains("line 2"));
  CHECK_THAT(error_of(""), Contains("s.json: the file is empty"));
  CHECK_THAT(error_of("[1]"), Contains("one object"));
  CHECK_THAT(error_of(std::string(100000, '[')), Contains("nested"));
  CHECK_THAT(error_of("{\"bodies\": [], \"bodies\": []}"), Contains("\"bodies\" is given twice"));
  CHECK_THAT(error_of("{\"gravity\": [0, -1e999, 0]}"), Contains("s.json"));
  CHECK_THAT(error_of("{\"gravity\": [0, NaN, 0]}"), Contains("line 1"));
}

TEST_CASE("numbers of any size are told in a few digits") {
  int refused = 0;
  for (const char* value : {"-1e300", "1e300", "-1e-300", "1.7976931348623157e308"}) {
    for (const char* key : {"bodies.block.materials[0].young", "bodies.block.materials[0].poisson",
                            "bodies.block.materials[0].density", "bodies.block.mesh.box.upper[0]",
                            "bodies.block.guard_stiffness", "bodies.block.guard_threshold",
                            "analysis.row_tolerance", "analysis.force_tolerance", "analysis.duration",
                            "volumes[0].stabilization", "dirichlet[0].stiffness", "damping[0].viscosity",
                            "membranes[0].thickness", "contacts[0].friction", "contacts[0].obstacle.radius",
                            "epidermis[0].stiffness", "cables[0].stiffness", "probes[0].point[0]"}) {
      const std::string message = build_error_with(std::string(key) + "=" + value);
      refused += message == "(none)" ? 0 : 1;
      INFO(key << " = " << value << ": " << message);
      int run = 0, longest = 0;
      for (const char c : message) longest = std::max(longest, run = c >= '0' && c <= '9' ? run + 1 : 0);
      CHECK(longest < 20);
    }
  }
  CHECK(refused > 20);
}

TEST_CASE("unknown keys are errors with the nearest known one") {
  CHECK_THAT(error_with("tractions[0].tracton=[1,0,0]"),
             Contains("tractions[0].tracton: unknown key") && Contains("did you mean \"traction\"?"));
  CHECK_THAT(error_with("cavites=[]"), Contains("cavites: unknown key") && Contains("\"cavities\""));
  CHECK_THAT(error_with("bodies.block.materials[0].yuong=3"),
             Contains("bodies[0].materials[0].yuong") && Contains("(value 3)") && Contains("\"young\""));
  CHECK_THAT(error_with("bodies[0].element=tet20"), Contains("bodies[0].element") && Contains("\"tet10\""));
}

TEST_CASE("known keys are listed once each") {
  const std::string message = error_with("probes[0].zzzzzzzzzz=1");
  CHECK_THAT(message, Contains("; known here: name, body, point"));
  CHECK_THAT(error_with("bodies[0].mesh.zzzzzzzzzz=1"), Contains("; known here: file, box, lattice, scale"));
}

TEST_CASE("wrong types, missing and contradicting values are named") {
  CHECK_THAT(error_with("analysis.steps=many"),
             Contains("analysis.steps: expected a whole number, found \"many\""));
  CHECK_THAT(error_with("analysis.steps=2.5"), Contains("whole number"));
  CHECK_THAT(error_with("analysis.steps=0"), Contains("analysis.steps = 0"));
  CHECK_THAT(error_with("analysis.step=0.5"), Contains("both \"steps\" and \"step\""));
  CHECK_THAT(error_with("analysis={\"duration\":1,\"step\":0.3}"), Contains("does not divide the duration"));
  CHECK(error_with("analysis={\"duration\":1,\"step\":0.333333}") == "(none)");
  CHECK_THAT(build_error_with("analysis.row_tolerance=-1"), Contains("tolerance"));
  CHECK_THAT(error_with("metrics[0].tolerance=-0.1"), Contains("metrics[0].tolerance"));
  CHECK_THAT(error_with("analysis.duration=-1"), Contains("analysis.duration = -1"));
  CHECK_THAT(error_with("gravity=9.8"), Contains("gravity: expected three numbers"));
  CHECK_THAT(error_with("gravity=[0,\"a\",0]"), Contains("gravity[1]: expected a number"));
  CHECK_THAT(error_with("bodies[0].mesh={}"),
             Contains("bodies[0].mesh: \"file\", \"box\" or \"lattice\" is missing"));
  CHECK_THAT(error_with("bodies[0].mesh.file=a.msh"), Contains("both \"file\" and \"box\""));
  CHECK_THAT(error_with("bodies[0].name=7"), Contains("bodies[0].name: expected a text"));
  CHECK_THAT(error_with("bodies=[]"), Contains("bodies is empty"));
  CHECK_THAT(error_with("probes[0].body=blokc"), Contains("probes[0].body") && Contains("\"block\""));
  CHECK_THAT(error_with("tractions[0].name=wall"), Contains("tractions[0].name = \"wall\" is used already"));
  CHECK_THAT(error_with("tractions[0].amount=[[1,2],[0,3]]"), Contains("goes back in time"));
  CHECK_THAT(error_with("metrics[0].of=top"), Contains("metrics[0].of = \"top\" names no probe"));
  CHECK_THAT(error_with("metrics[0].time=0.4"), Contains("not the end of a step"));
  CHECK_THAT(error_with("dirichlet[0].where.surfaces=[1]"), Contains("dirichlet[0].where.surfaces[0]"));
  CHECK_THAT(error_with("dirichlet[0].directions=xw"), Contains("letters of x, y and z"));
  CHECK_THAT(error_with("dirichlet[0].rotation={\"axis\":[0,0,1]}"), Contains("\"angle\""));
}

TEST_CASE("what only the mesh can tell is named before the solve") {
  CHECK_THAT(build_error_with("dirichlet[0].where.surfaces=x7"), Contains("\"x7\"") && Contains("\"x0\""));
  CHECK_THAT(build_error_with("bodies[0].materials[0].poisson=0.51"),
             Contains("bodies[0].materials[0]") && Contains("0.51"));
  CHECK_THAT(build_error_with("bodies[0].materials[0].young=-1"), Contains("young = -1"));
  CHECK_THAT(build_error_with("dirichlet=[]"), Contains("block"));
  CHECK_THAT(build_error_with("volumes[0].space=none"), Contains("0.5"));
  CHECK_THAT(build_error_with("bodies[0].mesh={\"file\":\"no.msh\"}"),
             Contains("bodies[0].mesh") && Contains("no.msh"));
}

TEST_CASE("overrides that lead nowhere are named") {
  CHECK_THAT(error_with("nonsense"), Contains("--set nonsense: expected path=value"));
  CHECK_THAT(error_with("=3"), Contains("expected path=value"));
  CHECK_THAT(error_with("bodies[9].name=a"), Contains("there is no [9]"));
  CHECK_THAT(error_with("tractions.pul.amount=2"), Contains("\"pul\"") && Contains("\"pull\""));
  CHECK_THAT(error_with("bodies[x].name=a"), Contains("[number]"));
  CHECK_THAT(error_with("name.first=a"), Contains("it has no \"first\""));
  CHECK_THAT(error_with("bodies.=a"), Contains("ends with a dot"));
}

TEST_CASE("overrides change what they name") {
  const SceneDef s =
      test::small_scene({"tractions.pull.amount=2", "volumes[0].space=body", "analysis.steps=7"});
  REQUIRE(s.tractions.size() == 1);
  CHECK(evaluate(s.tractions[0].amount, 1) == 2);
  CHECK(evaluate(s.tractions[0].amount, 0.5) == 1);
  REQUIRE(s.volumes);
  CHECK(s.volumes->front().def.space == VolumeSpace::body);
  CHECK(s.analysis.steps == 7);
  CHECK(evaluate(test::small_scene({"analysis.type=dynamic"}).tractions[0].amount, 0) == 1);
}

TEST_CASE("truncated and garbled files never crash") {
  const std::string text = test::small_text();
  for (std::size_t n = 0; n < text.find_last_of('}'); n += 3) {
    CHECK_THAT(error_of(text.substr(0, n)), Contains("s.json"));
  }
  std::mt19937 random(7);
  for (int round = 0; round < 2000; ++round) {
    std::string garbled = text;
    for (int k = 0; k < 1 + round % 4; ++k)
      garbled[random() % garbled.size()] = static_cast<char>(random() % 256);
    (void)parse_scene(garbled, "s.json", ".");
  }
  std::string noise(5000, '\0');
  for (char& c : noise) c = static_cast<char>(random() % 256);
  CHECK_THAT(error_of(noise), Contains("s.json"));
}

TEST_CASE("every value replaced by every wrong one is refused or harmless") {
  for (const std::string& line : scene_file_keys()) {
    std::string path = line.substr(0, line.find(": "));
    for (auto at = path.find("[]"); at != std::string::npos; at = path.find("[]")) path.replace(at, 2, "[0]");
    for (const char* value :
         {"null", "true", "-1", "1e308", "\"\"", "[]", "{}", "[[[]]]", "[null]", "{\"a\":1}"}) {
      (void)parse_scene(test::small_text(), "s.json", ".", {path + std::string("=") + value});
    }
  }
}

TEST_CASE("files that are no files are named") {
  CHECK_THAT(read_scene_file("/no/such/scene.json").error(), Contains("there is no such file"));
  CHECK_THAT(read_scene_file("/tmp").error(), Contains("a folder"));
}
