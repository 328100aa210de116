// drive: amounts that bring probes to targets.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "apps/commands.h"
#include "apps/stop.h"
#include "apps/table.h"
#include "scenes/run/outputs.h"
#include "scenes/run/run.h"
#include "studies/drive/horizon.h"
#include "studies/drive/report.h"

namespace isochor::app {

namespace {

// The usual outputs are those of a run of the scene with the amounts that were found.
Result<void> write(const DriveArguments& a, const std::string& folder, const SceneDef& scene,
                   const drive::Drive& found) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{folder + ": cannot be made: " + error.message() + "; choose another --out"};
  if (const auto driven = drive::driven_scene(scene, found)) {
    RunOptions options;
    options.folder = folder;
    options.threads = a.threads;
    options.stop = stop_wanted;
    const RunResult run = run_scene(driven.value(), options);
    if (run.status == RunStatus::not_written) return Error{run.reason};
    if (run.status != RunStatus::converged)
      std::fprintf(stderr, "isochor: the run with the amounts found: %s\n", run.reason.c_str());
  }
  if (auto r = write_text(folder + "/drive.csv", drive::drive_csv(found)); !r) return r;
  if (!found.curves.empty()) {
    if (auto r = write_text(folder + "/amounts.csv", drive::amounts_csv(found)); !r) return r;
  }
  return write_text(folder + "/drive.json", drive::drive_json(found));
}

void print(const drive::Drive& found, const std::string& folder) {
  Table table(drive::table_head(found));
  table.numbers_from(2, found.actuators.size() + 1);
  for (const drive::Reached& step : found.steps) table.add(drive::table_row(found, step));
  std::printf("%s", table.text().c_str());
  const auto reached = std::count_if(found.steps.begin(), found.steps.end(),
                                     [](const drive::Reached& r) { return r.reached; });
  std::printf("%td of %zu targets reached\n%s/drive.csv\n", reached, found.targets.time.size(),
              folder.c_str());
}

Result<drive::Drive> search(const DriveArguments& a, const SceneDef& scene,
                            std::vector<drive::Actuator> actuators, drive::Targets targets) {
  drive::HorizonOptions options;
  options.tolerance = a.tolerance;
  options.threads = a.threads;
  options.stop = stop_wanted;
  options.every = a.every;
  options.smooth = a.smooth;
  if (!a.horizon) return drive::drive(scene, std::move(actuators), std::move(targets), options);
  if (!a.quiet && !a.json) {
    options.on_iteration = [](int gradients, double distance) {
      std::fprintf(stderr, "gradient %d: off by %.4g\n", gradients, distance);
    };
  }
  return drive::drive_over_horizon(scene, std::move(actuators), std::move(targets), options);
}

}  // namespace

int drive_scene(const DriveArguments& a) {
  const auto scene = find_scene_named(a.scene, a.overrides);
  if (!scene) return refuse(scene.error());
  auto targets = drive::read_targets(a.targets, scene.value());
  if (!targets) return refuse(targets.error());
  std::vector<drive::Actuator> actuators;
  for (const std::string& text : a.amounts) {
    auto actuator = drive::parse_actuator(text);
    if (!actuator) return refuse(actuator.error());
    actuators.push_back(std::move(actuator).value());
  }
  stop_on_signals();
  const auto found = search(a, scene.value(), std::move(actuators), std::move(targets).value());
  if (!found) return refuse(found.error());
  const std::string folder = a.folder.empty() ? "out/drive/" + scene.value().name : a.folder;
  if (auto r = write(a, folder, scene.value(), found.value()); !r) {
    std::fprintf(stderr, "isochor: %s\n", r.error().c_str());
    return not_written;
  }
  if (a.json)
    std::printf("%s", drive::drive_json(found.value()).c_str());
  else if (!a.quiet)
    print(found.value(), folder);
  if (found.value().interrupted || stop_wanted()) return interrupted;
  if (!found.value().reason.empty()) std::fprintf(stderr, "isochor: %s\n", found.value().reason.c_str());
  return found.value().all_reached() ? success : not_converged;
}

}  // namespace isochor::app
