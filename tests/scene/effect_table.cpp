// An effect of scene files is a file in scenes/effects and its lines in list.h, and nothing else.
#include <filesystem>
#include <set>

#include "catch.h"
#include "engine/base/fields.h"
#include "scenes/effects/kind.h"
#include "small_scene.h"

using namespace isochor;
namespace fs = std::filesystem;

TEST_CASE("every list of effects has an entry in the table, under its own name") {
  SceneEffects lists;
  std::size_t members = 0;
  for_each_field(lists, [&](auto&) { ++members; });
  CHECK(members == std::size(effect_kinds));
  std::set<std::string> names;
  for (const EffectKind* kind : effect_kinds) {
    INFO(kind->key);
    CHECK(names.insert(kind->key).second);
    CHECK(fs::exists(std::string(ISOCHOR_SCENES "/effects/") + kind->key + ".cpp"));
  }
}

TEST_CASE("a scene that has effects of a list counts, names and explains them") {
  const SceneDef scene = test::small_scene({R"(windings=[{"name": "thread", "paths": []}])"});
  REQUIRE(scene.windings.size() == 1);
  CHECK(windings_kind.size(scene) == 1);
  CHECK(windings_kind.name(scene, 0) == "thread");
  std::vector<EffectNote> notes;
  windings_kind.explain(windings_kind, scene, notes);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].effect == "winding \"thread\"");
}

TEST_CASE("supports are added before chambers, and contact comes last") {
  const auto order = kinds_by_phase();
  const auto at = [&](const EffectKind& kind) {
    return std::find(order.begin(), order.end(), &kind) - order.begin();
  };
  CHECK(order.size() == std::size(effect_kinds));
  CHECK(at(volumes_kind) < at(dirichlet_kind));
  CHECK(at(dirichlet_kind) < at(cavities_kind));
  CHECK(at(cavities_kind) < at(valves_kind));
  CHECK(at(rigid_bodies_kind) < at(contacts_kind));
  CHECK(order.back() == &surface_contacts_kind);
}

// What goes through the table knows no effect by name, so that a new one is two files.
TEST_CASE("reader, writer, schema, docs, build and explanation name no effect") {
  std::vector<fs::path> files{ISOCHOR_SCENES "/build.cpp", ISOCHOR_SCENES "/explain.cpp",
                              ISOCHOR_SCENES "/check_values.cpp", ISOCHOR_SCENES "/effects/kind.h",
                              ISOCHOR_SCENES "/effects/kind.cpp"};
  for (const char* folder : {"/json", "/keys"}) {
    for (const auto& entry : fs::directory_iterator(std::string(ISOCHOR_SCENES) + folder)) {
      const std::string extension = entry.path().extension().string();
      // Results have names of their own.
      if (entry.path().stem() == "summary") continue;
      if (extension == ".h" || extension == ".cpp") files.push_back(entry.path());
    }
  }
  CHECK(files.size() > 15);
  for (const fs::path& file : files) {
    const std::string text = test::slurp(file);
    REQUIRE_FALSE(text.empty());
    for (const EffectKind* kind : effect_kinds) {
      INFO(file.string() << " names " << kind->key);
      const std::string key = kind->key;
      CHECK(text.find(key + "_kind") == std::string::npos);
      CHECK(text.find("." + key) == std::string::npos);
      CHECK(text.find("\"" + key + "\"") == std::string::npos);
    }
  }
}
