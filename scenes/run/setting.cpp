#include "scenes/run/setting.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "scenes/body_parts.h"
#include "scenes/check_values.h"
#include "scenes/run/outputs.h"
#include "scenes/run/step_errors.h"

namespace isochor {

namespace {

constexpr int kMostRefined = 8;  // of the key bodies[].refine

const char* key_word(Element e) {
  switch (e) {
    case Element::tet4:
      return "tet4";
    case Element::tet4_edge_smoothed:
      return "tet4_edge_smoothed";
    case Element::tet10:
      return "tet10";
    case Element::tri3:
      return "tri3";
    default:
      return "hex8";
  }
}

}  // namespace

std::string element_text(const std::optional<Element>& element) {
  if (!element) return "elements of the scene";
  switch (*element) {
    case Element::tet4:
      return "Tet4";
    case Element::tet4_edge_smoothed:
      return "edge-smoothed Tet4";
    case Element::tet10:
      return "Tet10";
    case Element::tri3:
      return "triangles";
    default:
      return "Hex8";
  }
}

namespace {

std::string times(std::size_t n) {
  return n == 1 ? "once" : n == 2 ? "twice" : std::to_string(n) + " times";
}

}  // namespace

std::string describe(const Setting& s) {
  std::string mesh = "mesh of the scene";
  if (s.refine > 0) mesh = "mesh refined " + times(static_cast<std::size_t>(s.refine));
  if (!s.rounds.empty())
    mesh = (s.refine > 0 ? mesh + ", then " : "mesh refined ") + times(s.rounds.size()) + " where it counts";
  const std::string steps = s.halved > 0 ? ", steps cut in " + std::to_string(1 << s.halved) : "";
  return element_text(s.element) + ", " + mesh + steps;
}

Result<SettingChoices> setting_choices(const SceneDef& scene) {
  SettingChoices out;
  out.most_levels = kMostRefined;
  out.steps_matter = steps_matter(scene);
  bool any = false;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    if (std::holds_alternative<LatticeMesh>(body.mesh)) {
      return Error{
          place("bodies", b) + " (\"" + body.name +
          "\") has a lattice for a mesh, which cannot be refined: its cubes are cut anew from the surface at "
          "every spacing; run the scene with mesh.lattice.spacing halved and compare"};
    }
    const auto made = make_body(body, scene.folder, place("bodies", b));
    if (!made) return made.failure();
    const Mesh& mesh = made.value().def.mesh;
    if (mesh.cell_type == CellType::tri3) {
      return Error{
          place("bodies", b) + " (\"" + body.name +
          "\") is thin, and meshes of triangles are not refined here; run the scene with a finer mesh "
          "of its surface and compare"};
    }
    out.linear_tets.push_back(mesh.cell_type == CellType::tet4);
    out.cells.push_back(mesh.cell_count());
    out.most_levels = std::min(out.most_levels, kMostRefined - body.refine);
    any = any || out.linear_tets.back();
    out.can_local = out.can_local && mesh.cell_type != CellType::hex8;
    // Lists of cells are those of a mesh that is no finer.
    for (const RefinedPlace& p : body.refine_where) {
      if (p.cells.given()) out.most_levels = 0;
    }
    // Edges of Tet10 may be curved.
    const FlatFaces faces = mesh.cell_type == CellType::tet10 ? FlatFaces{} : flat_faces(mesh);
    if (faces.deficit > out.faces.deficit) {
      out.faces = faces;
      out.faces_of = body.name;
    }
  }
  if (any)
    out.elements = {Element::tet4, Element::tet4_edge_smoothed, Element::tet10};
  else
    out.elements = {std::nullopt};
  return out;
}

namespace {

// What is reported and written stays at the same times.
void cut_steps(SceneDef& scene, int halved) {
  if (halved == 0) return;
  AnalysisDef& a = scene.analysis;
  const int parts = 1 << halved;
  const int steps = plan_steps(a).steps * parts;
  if (a.step)
    a.step = a.duration / steps;
  else
    a.steps = steps;
  a.options.time_error /= parts;
  scene.outputs.every *= parts;
  scene.outputs.checkpoint_steps *= parts;
}

}  // namespace

SceneDef with_setting(const SceneDef& scene, const SettingChoices& choices, const Setting& setting) {
  SceneDef out = scene;
  cut_steps(out, setting.halved);
  for (std::size_t b = 0; b < out.bodies.size(); ++b) {
    if (setting.element && choices.linear_tets[b]) out.bodies[b].element = *setting.element;
    out.bodies[b].refine += setting.refine;
    for (const auto& round : setting.rounds) {
      if (b >= round.size() || round[b].empty()) continue;
      RefinedPlace place;
      place.cells.values.assign(round[b].begin(), round[b].end());
      out.bodies[b].refine_where.push_back(std::move(place));
    }
  }
  return out;
}

namespace {

// All of them, so that the run is the same to the bit.
std::string digits_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string file_of_round(const std::string& folder, std::size_t body, std::size_t round) {
  return (std::filesystem::path(folder) /
          ("refined_" + std::to_string(body) + "_" + std::to_string(round) + ".txt"))
      .string();
}

}  // namespace

Result<void> write_rounds(const Setting& setting, const std::string& folder) {
  for (std::size_t k = 0; k < setting.rounds.size(); ++k) {
    for (std::size_t b = 0; b < setting.rounds[k].size(); ++b) {
      if (setting.rounds[k][b].empty()) continue;
      std::string text;
      for (const Index c : setting.rounds[k][b]) text += std::to_string(c) + "\n";
      if (auto r = write_text(file_of_round(folder, b, k), text); !r) return r;
    }
  }
  return {};
}

std::string overrides_for(const SceneDef& scene, const SettingChoices& choices, const Setting& setting,
                          const std::string& folder) {
  std::string out;
  const SceneDef wanted = with_setting(scene, choices, setting);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody &is = scene.bodies[b], &be = wanted.bodies[b];
    const auto set = [&] { return std::string(out.empty() ? "" : " ") + "--set " + place("bodies", b); };
    if (is.element != be.element) out += set() + ".element=" + key_word(be.element);
    if (is.refine != be.refine) out += set() + ".refine=" + std::to_string(be.refine);
    std::string places;
    for (std::size_t k = 0; !folder.empty() && k < setting.rounds.size(); ++k) {
      if (b >= setting.rounds[k].size() || setting.rounds[k][b].empty()) continue;
      const std::string file =
          std::filesystem::absolute(file_of_round(folder, b, k)).lexically_normal().string();
      places += (places.empty() ? "" : ",") + ("{\"cells\":{\"file\":\"" + file + "\"}}");
    }
    if (!places.empty())
      out += (out.empty() ? "" : " ") + ("--set '" + place("bodies", b) + ".refine_where=[" + places + "]'");
  }
  const AnalysisDef &is = scene.analysis, &be = wanted.analysis;
  const auto set = [&](const std::string& what) { out += (out.empty() ? "--set " : " --set ") + what; };
  if (setting.halved > 0) {
    if (be.step)
      set("analysis.step=" + digits_of(*be.step));
    else
      set("analysis.steps=" + std::to_string(be.steps));
    if (is.options.time_error > 0) set("analysis.time_error=" + digits_of(be.options.time_error));
    if (scene.outputs.every > 0) set("outputs.every=" + std::to_string(wanted.outputs.every));
  }
  return out;
}

}  // namespace isochor
