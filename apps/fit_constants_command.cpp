// fit --scene: constants of scenes from what was measured of them.
#include <cstdio>
#include <filesystem>

#include "apps/commands.h"
#include "apps/stop.h"
#include "apps/table.h"
#include "scenes/run/outputs.h"
#include "scenes/scene_file.h"
#include "studies/fit/scene_report.h"
#include "studies/inverse/data_report.h"

namespace isochor::app {

namespace {

// "SCENE:DATA" or "SCENE:DATA:WEIGHT".
Result<fit::Experiment> experiment_of(const std::string& text, const std::vector<std::string>& overrides) {
  const std::string who = "--scene \"" + text + "\": ";
  const auto first = text.find(':');
  if (first == std::string::npos) return Error{who + "there are no data; give SCENE:DATA"};
  fit::Experiment out;
  out.name = text;
  std::string file = text.substr(first + 1);
  const auto second = file.rfind(':');
  if (second != std::string::npos) {
    const auto weight = inverse::number_in(file.substr(second + 1), who);
    if (!weight) return weight.failure();
    if (!(weight.value() > 0)) return Error{who + "the weight must be positive"};
    out.weight = weight.value();
    file.resize(second);
    out.name = text.substr(0, first + 1 + second);
  }
  auto scene = find_scene_named(text.substr(0, first), overrides);
  if (!scene) return scene.failure();
  out.scene = std::move(scene).value();
  auto data = inverse::read_data(file, out.scene);
  if (!data) return data.failure();
  out.data = std::move(data).value();
  return out;
}

Result<void> write(const std::string& folder, const std::vector<fit::Experiment>& experiments,
                   const fit::SceneFit& found) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{folder + ": cannot be made: " + error.message() + "; choose another --out"};
  if (auto r = write_text(folder + "/fit.json", fit::scene_fit_json(experiments, found)); !r) return r;
  for (std::size_t k = 0; k < found.fitted.size(); ++k) {
    const std::string end = experiments.size() == 1 ? "" : "_" + std::to_string(k + 1);
    const std::string data =
        inverse::data_csv(experiments[k].data, "measured", {{"fitted", &found.fitted[k]}});
    if (auto r = write_text(folder + "/fit" + end + ".csv", data); !r) return r;
  }
  const auto page = studies::page_html(fit::scene_fit_page(experiments, found));
  if (!page) {
    std::fprintf(stderr, "isochor: no page: %s\n", page.error().c_str());
    return {};
  }
  return write_text(folder + "/index.html", page.value());
}

void print(const fit::SceneFit& found, const std::string& folder) {
  Table table(fit::scene_table_head());
  table.numbers_from(1, 3);
  for (const auto& row : fit::scene_table_rows(found)) table.add(row);
  std::printf("%s", table.text().c_str());
  std::printf("errors %.3g of the largest change of their kind (root mean square)\n", found.rms);
  for (const std::string& w : found.warnings) std::printf("%s\n", w.c_str());
  std::printf("to use them:");
  for (const fit::FittedConstant& c : found.constants)
    std::printf(" --set %s=%s", c.name.c_str(), inverse::full(c.value).c_str());
  std::printf("\n%s/index.html\n", folder.c_str());
}

}  // namespace

int fit_constants(const FitArguments& a) {
  if (!a.curves.empty() || !a.laws.empty())
    return refuse("fit: curves and --law are for laws, --scene is for constants of scenes; give one of both");
  std::vector<fit::Experiment> experiments;
  for (const std::string& text : a.scenes) {
    auto experiment = experiment_of(text, a.overrides);
    if (!experiment) return refuse(experiment.error());
    experiments.push_back(std::move(experiment).value());
  }
  std::vector<fit::Sought> constants;
  for (const std::string& text : a.constants) {
    auto sought = fit::parse_sought(text);
    if (!sought) return refuse(sought.error());
    constants.push_back(std::move(sought).value());
  }
  stop_on_signals();
  fit::SceneFitOptions options;
  options.threads = a.threads;
  options.stop = stop_wanted;
  if (!a.quiet && !a.json) {
    options.on_iteration = [](int iteration, double rms) {
      std::fprintf(stderr, "step %d: errors %.4g\n", iteration, rms);
    };
  }
  const auto found = fit::fit_scenes(experiments, constants, options);
  if (!found) return refuse(found.error());
  const std::string folder = a.folder.empty() ? "out/fit/" + experiments.front().scene.name : a.folder;
  if (auto r = write(folder, experiments, found.value()); !r) {
    std::fprintf(stderr, "isochor: %s\n", r.error().c_str());
    return not_written;
  }
  if (a.json)
    std::printf("%s", fit::scene_fit_json(experiments, found.value()).c_str());
  else if (!a.quiet)
    print(found.value(), folder);
  if (found.value().interrupted || stop_wanted()) return interrupted;
  if (!found.value().converged) std::fprintf(stderr, "isochor: %s\n", found.value().reason.c_str());
  return found.value().converged ? success : not_converged;
}

}  // namespace isochor::app
