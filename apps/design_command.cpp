// design: shapes and stiffness fields for targets.
#include <cstdio>
#include <filesystem>

#include "apps/commands.h"
#include "apps/stop.h"
#include "scenes/run/outputs.h"
#include "scenes/run/run.h"
#include "scenes/scene_file.h"
#include "studies/design/design_report.h"
#include "studies/inverse/data_report.h"

namespace isochor::app {

namespace {

Result<void> write_field_of_cells(const std::string& folder, const design::Design& found,
                                  const BuiltScene& built, std::size_t body) {
  const Mesh& mesh = built.world.mesh(built.bodies[body]);
  VtkGrid grid{mesh.cell_type, mesh.nodes, mesh.cells, {}, {}};
  grid.cell_fields.push_back({"stiffness_factor", 1, found.factor});
  grid.cell_fields.push_back({"deviation_of_logarithm", 1, found.deviation});
  return write_vtu(folder + "/field.vtu", grid);
}

// The usual outputs are those of a run of the scene as it was designed.
Result<void> write(const DesignArguments& a, const std::string& folder, const design::Design& found) {
  if (auto r = write_text(folder + "/design.json", design::design_json(found)); !r) return r;
  if (auto r = write_text(folder + "/history.csv", design::history_csv(found)); !r) return r;
  const std::string data =
      inverse::data_csv(found.data, "wanted", {{"found", &found.found}, {"before", &found.before}});
  if (auto r = write_text(folder + "/targets.csv", data); !r) return r;
  SceneDef scene = found.scene;
  for (SceneBody& body : scene.bodies) {
    // Beside the scene file, where the command has written it; others from wherever it is read.
    auto* file = std::get_if<MeshFile>(&body.mesh);
    if (!file) continue;
    namespace fs = std::filesystem;
    const fs::path whole = fs::absolute(fs::path(scene.folder) / file->path);
    std::error_code none;
    file->path = fs::relative(whole, fs::absolute(folder), none).string();
  }
  if (auto r = write_text(folder + "/scene.json", to_json(scene)); !r) return r;
  if (const auto page = studies::page_html(design::design_page(found))) {
    if (auto r = write_text(folder + "/design.html", page.value()); !r) return r;
  }
  if (!found.factor.empty()) {
    if (auto r = write_text(folder + "/field.csv", design::field_csv(found)); !r) return r;
    const auto built = build(found.scene, {.threads = a.threads});
    for (std::size_t b = 0; built && b < found.scene.bodies.size(); ++b) {
      if (found.scene.bodies[b].name != a.stiffness) continue;
      if (auto r = write_field_of_cells(folder, found, built.value(), b); !r) return r;
    }
  }
  if (found.interrupted) return {};
  RunOptions options;
  options.folder = folder;
  options.threads = a.threads;
  options.stop = stop_wanted;
  const RunResult run = run_scene(found.scene, options);
  if (run.status == RunStatus::not_written) return Error{run.reason};
  if (run.status != RunStatus::converged)
    std::fprintf(stderr, "isochor: the run of the design: %s\n", run.reason.c_str());
  return {};
}

design::DesignOptions options_of(const DesignArguments& a, const std::string& folder) {
  design::DesignOptions options;
  if (!a.stiffness.empty()) {
    options.stiffness.emplace();
    options.stiffness->body = a.stiffness;
    options.stiffness->length = a.length;
    options.stiffness->spread = a.spread;
    options.stiffness->least = a.least_factor;
    options.stiffness->most = a.most_factor;
  }
  options.hold = a.hold;
  options.least_volume = a.least_volume;
  options.most_volume = a.most_volume;
  options.least_quality = a.quality;
  options.noise = a.noise;
  options.max_iterations = a.iterations;
  options.threads = a.threads;
  options.folder = folder;
  options.stop = stop_wanted;
  if (!a.quiet && !a.json) {
    options.on_iteration = [](int iteration, double error) {
      std::fprintf(stderr, "step %d: errors %.4g times what is to be met\n", iteration, error);
    };
  }
  return options;
}

}  // namespace

int design_scene(const DesignArguments& a) {
  const auto scene = find_scene_named(a.scene, a.overrides);
  if (!scene) return refuse(scene.error());
  const auto data = inverse::read_data(a.targets, scene.value());
  if (!data) return refuse(data.error());
  const std::string folder = a.folder.empty() ? "out/design/" + scene.value().name : a.folder;
  design::DesignOptions options = options_of(a, folder);
  for (const std::string& text : a.moves) {
    auto move = design::parse_move(text, scene.value());
    if (!move) return refuse(move.error());
    options.moves.push_back(std::move(move).value());
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    std::fprintf(stderr, "isochor: %s: cannot be made: %s; choose another --out\n", folder.c_str(),
                 error.message().c_str());
    return not_written;
  }
  stop_on_signals();
  const auto found = design::design(scene.value(), data.value(), options);
  if (!found) return refuse(found.error());
  if (auto r = write(a, folder, found.value()); !r) {
    std::fprintf(stderr, "isochor: %s\n", r.error().c_str());
    return not_written;
  }
  if (a.json) {
    std::printf("%s", design::design_json(found.value()).c_str());
  } else if (!a.quiet) {
    for (const std::string& line : design::summary_lines(found.value())) std::printf("%s\n", line.c_str());
    std::printf("%s/design.html\n", folder.c_str());
  }
  if (found.value().interrupted || stop_wanted()) return interrupted;
  const std::string why = found.value().reason.empty() ? found.value().note : found.value().reason;
  if (!found.value().reached && !why.empty()) std::fprintf(stderr, "isochor: %s\n", why.c_str());
  return found.value().reached ? success : not_converged;
}

}  // namespace isochor::app
