#include "scenes/run/machine_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "scenes/run/outputs.h"

namespace isochor {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr Element kElements[] = {Element::tet4, Element::tet4_edge_smoothed, Element::tet10, Element::hex8};
constexpr int kFormat = 1;  // of the file

// A soft cube that sags from one of its sides, in one step.
SceneDef sagging_cube(Element element, int divisions) {
  SceneDef s;
  s.name = "cube";
  SceneBody body;
  BoxMeshDef box;
  box.divisions = {divisions, divisions, divisions};
  if (element == Element::hex8) box.cell_type = CellType::hex8;
  body.mesh = box;
  body.element = element;
  MaterialDef material;
  material.constants.young = 1e5;
  material.constants.poisson = 0.5;
  body.materials = {material};
  s.bodies = {body};
  DirichletDef wall;
  wall.name = "wall";
  wall.where.surfaces = {"x0"};
  s.dirichlet = {wall};
  s.analysis.options.gravity = {0, 0, -1};
  s.analysis.steps = 1;
  return s;
}

struct Sample {
  RunCost cost;        // seconds of one factorization, and of one iteration without it
  double entries = 0;  // of the factor
};

// The least of some runs: what else the machine does only adds.
std::optional<Sample> sample(Element element, int divisions, int runs, int threads,
                             const std::function<bool()>& stop) {
  Sample out;
  for (int k = 0; k < runs; ++k) {
    RunOptions options;
    options.threads = threads;
    options.stop = stop;
    const RunResult r = run_scene(sagging_cube(element, divisions), options);
    if (r.status != RunStatus::converged || r.work.factorizations < 1 || r.work.iterations < 1) return {};
    RunCost cost = cost_of(r, element);
    cost.factor_s /= r.work.factorizations;
    cost.other_s /= r.work.iterations;
    if (k > 0) {
      cost.factor_s = std::min(cost.factor_s, out.cost.factor_s);
      cost.other_s = std::min(cost.other_s, out.cost.other_s);
    }
    out.cost = cost;
    out.entries = static_cast<double>(r.size.factor_nonzeros);
  }
  return out;
}

int threads_used(int threads) {
  return threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

Json numbers_of(const CostModel::OfElement& e) {
  return {e.entries_growth, e.seconds_power, e.factor_s, e.other_s,
          e.factor_bytes,   e.other_bytes,   e.unknowns};
}

}  // namespace

std::optional<CostModel> measure_cost_model(int threads, const std::function<bool()>& stop) {
  CostModel model;
  constexpr int common = 6;  // cells a side of the cube that elements are compared on
  std::optional<Sample> smoothed;
  for (const Element element : {Element::tet4_edge_smoothed, Element::tet4, Element::tet10, Element::hex8}) {
    // Of Tet10 the comparison has the finer of its meshes.
    const int coarse = element == Element::tet10 ? common / 2 : common;
    const auto a = sample(element, coarse, 3, threads, stop),
               b = sample(element, 2 * coarse, 2, threads, stop);
    if (!a || !b) return {};
    CostModel::OfElement& e = model.of(element);
    e.entries_growth = b->entries / a->entries;
    e.seconds_power =
        std::clamp(std::log(b->cost.factor_s / a->cost.factor_s) / std::log(e.entries_growth), 1.0, 1.8);
    const Sample& here = element == Element::tet10 ? *b : *a;
    if (!smoothed) smoothed = here;
    e.factor_s = here.cost.factor_s / smoothed->cost.factor_s;
    e.other_s = here.cost.other_s / smoothed->cost.other_s;
    e.factor_bytes = here.cost.factor_bytes / smoothed->cost.factor_bytes;
    e.other_bytes = here.cost.other_bytes / smoothed->cost.other_bytes;
    e.unknowns = here.cost.unknowns / smoothed->cost.unknowns;
  }
  return model;
}

std::string cost_model_file() {
  // The standard of such places wants absolute paths and others to be ignored.
  const auto folder = [](const char* name) -> fs::path {
    const char* value = std::getenv(name);
    return value && fs::path(value).is_absolute() ? fs::path(value) : fs::path();
  };
  fs::path cache = folder("XDG_CACHE_HOME");
  if (cache.empty() && !folder("HOME").empty()) cache = folder("HOME") / ".cache";
  return cache.empty() ? "" : (cache / "isochor" / "cost_model.json").string();
}

std::string to_text(const CostModel& model, int threads) {
  Json j{{"format", kFormat},
         {"machine", machine_description()},
         {"build", version() + ", " + build_description()},
         {"threads", threads_used(threads)}};
  for (const Element e : kElements) j["elements"].push_back(numbers_of(model.of(e)));
  return j.dump(1) + "\n";
}

std::optional<CostModel> cost_model_from_text(const std::string& text, int threads) {
  const Json j = Json::parse(text, nullptr, false);
  const Json wanted = Json::parse(to_text({}, threads));
  if (!j.is_object()) return {};
  for (const char* key : {"format", "machine", "build", "threads"}) {
    if (!j.contains(key) || j[key] != wanted[key]) return {};
  }
  if (!j.contains("elements") || !j["elements"].is_array() || j["elements"].size() != std::size(kElements))
    return {};
  CostModel model;
  for (std::size_t k = 0; k < std::size(kElements); ++k) {
    const Json& list = j["elements"][k];
    CostModel::OfElement& e = model.of(kElements[k]);
    double* const place[] = {&e.entries_growth, &e.seconds_power, &e.factor_s, &e.other_s,
                             &e.factor_bytes,   &e.other_bytes,   &e.unknowns};
    if (!list.is_array() || list.size() != std::size(place)) return {};
    for (std::size_t i = 0; i < std::size(place); ++i) {
      if (!list[i].is_number()) return {};
      *place[i] = list[i].get<double>();
      if (!(*place[i] > 0) || !(*place[i] < 1e6)) return {};
    }
  }
  return model;
}

CostModel machine_cost_model(int threads, const std::function<bool()>& stop,
                             const std::function<void(const std::string&)>& log) {
  const std::string file = cost_model_file();
  if (!file.empty()) {
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (auto model = cost_model_from_text(text, threads)) return *model;
  }
  if (log) log("measuring what elements cost on this machine, once, for some seconds");
  const auto model = measure_cost_model(threads, stop);
  if (!model) {
    if (log) log("this machine could not be measured; prices are by the ratios of another");
    return {};
  }
  Result<void> kept = Error{"there is neither XDG_CACHE_HOME nor HOME"};
  if (!file.empty()) {
    std::error_code code;
    fs::create_directories(fs::path(file).parent_path(), code);
    kept = write_text(file, to_text(*model, threads));
  }
  if (!kept && log) log("what was measured of this machine is not kept: " + kept.error());
  return *model;
}

}  // namespace isochor
