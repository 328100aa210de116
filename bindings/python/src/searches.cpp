// Scene.solve_to(): element and mesh for an error that is asked for.
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <cmath>

#include "interruption.h"
#include "reports.h"
#include "scene_runs.h"
#include "scenes/run/error_search.h"

namespace isochor::python {

namespace {

py::dict dict_of(const Trial& t) {
  py::dict out;
  out["setting"] = describe(t.setting);
  out["status"] = to_string(t.status);
  out["reason"] = t.reason;
  out["elements"] = t.elements;
  out["unknowns"] = t.unknowns;
  out["seconds"] = t.seconds;
  out["predicted_seconds"] = t.predicted_seconds > 0 ? py::cast(t.predicted_seconds) : py::none();
  out["indicator"] = t.indicator;
  out["held_by"] = t.held_by;
  out["how"] = t.how;
  return out;
}

py::list entries_of(const Accuracy& accuracy) {
  py::list out;
  for (const AccuracyEntry& e : accuracy.entries) {
    py::dict one;
    one["name"] = e.name;
    one["unit"] = e.unit;
    one["value"] = e.value;
    one["error"] = e.indicator;
    one["relative"] = e.relative;
    one["where"] = e.where;
    out.append(one);
  }
  return out;
}

}  // namespace

py::dict solve_to(const SceneDef& scene, const std::variant<double, std::string>& error,
                  const std::string& folder, int threads, std::optional<double> budget, int most_levels,
                  const py::object& on_trial) {
  Interruption interruption;
  ErrorSearchOptions options;
  const auto* text = std::get_if<std::string>(&error);
  options.error = text ? need(parse_error_demand(*text)) : std::get<double>(error);
  options.most_levels = most_levels;
  options.run.folder = folder;
  options.run.threads = threads;
  options.run.budget = budget;
  options.run.stop = [&] { return interruption.asked(); };
  if (!on_trial.is_none()) {
    options.on_trial = [&](const Trial& t) { interruption.call([&] { on_trial(dict_of(t)); }); };
  }
  ErrorSearch search;
  interruption.begin();
  {
    const py::gil_scoped_release free;
    search = search_error(scene, options);
  }
  interruption.end();
  if (search.end == SearchEnd::bad_input && !search.best) throw Refused("Scene.solve_to: " + search.sentence);
  py::dict out;
  out["end"] = to_string(search.end);
  out["sentence"] = search.sentence;
  out["overrides"] = search.overrides;
  out["seconds"] = search.seconds;
  py::list trials;
  for (const Trial& t : search.trials) trials.append(dict_of(t));
  out["trials"] = trials;
  out["best"] = search.best ? py::cast(*search.best) : py::none();
  out["errors"] = entries_of(search.accuracy);
  out["scene"] = search.best ? py::cast(std::make_shared<SceneDef>(search.scene)) : py::none();
  out["run"] = search.best ? py::object(dict_of(search.result)) : py::none();
  return out;
}

}  // namespace isochor::python
