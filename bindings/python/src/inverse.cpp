// fit(), fit_scene(), drive() and design(): the same code as the commands, their JSON, and arrays beside it.
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <sstream>

#include "interop.h"
#include "interruption.h"
#include "studies/design/design_report.h"
#include "studies/drive/horizon.h"
#include "studies/drive/report.h"
#include "studies/fit/report.h"
#include "studies/fit/scene_report.h"

namespace isochor::python {

namespace {

using ScenePtr = std::shared_ptr<SceneDef>;

ScenePtr shared(SceneDef scene) {
  return std::make_shared<SceneDef>(std::move(scene));
}

// Works without the lock until it is done or stopped; what a callback raised is raised then.
template <class Work>
auto released(Interruption& interruption, const Work& work) {
  interruption.begin();
  auto out = [&] {
    const py::gil_scoped_release free;
    return work();
  }();
  interruption.end();
  return out;
}

// A callback of a number of iterations and of how far off it still is.
std::function<void(int, double)> watching(Interruption& interruption, const py::object& callback) {
  if (callback.is_none()) return {};
  return [&interruption, &callback](int iteration, double error) {
    interruption.call([&] { callback(iteration, error); });
  };
}

// --- Laws
// ----------------------------------------------------------------------------------------------------

// A curve: a file, or a table as the text of one, with its mode.
struct CurveGiven {
  std::string source, text, mode;  // of a file no text and no mode
};

Result<fit::Curve> curve_of(const CurveGiven& given, const fit::CurveOptions& options) {
  if (given.text.empty()) return fit::read_curve(given.source, options);
  const auto mode = fit::mode_of(given.mode);
  if (!mode) return Error{given.source + ": " + mode.error()};
  std::istringstream in(given.text);
  return fit::read_curve(in, given.source, mode.value(), options);
}

std::string fit_laws(const std::vector<std::tuple<std::string, std::string, std::string>>& given,
                     const std::vector<std::string>& names, const fit::CurveOptions& how, bool relative) {
  std::vector<fit::Curve> curves;
  for (const auto& [source, text, mode] : given) curves.push_back(need(curve_of({source, text, mode}, how)));
  if (curves.empty()) throw Refused("fit: nothing was measured; give curves");
  std::vector<const fit::Law*> laws;
  for (const std::string& name : names) laws.push_back(need(fit::find_law(name)));
  for (const fit::Law& law : fit::laws()) {
    if (names.empty()) laws.push_back(&law);
  }
  Interruption interruption;
  fit::FitOptions options;
  options.weights = relative ? fit::Weights::relative : fit::Weights::absolute;
  options.stop = [&] { return interruption.asked(); };
  const auto fits = released(interruption, [&] {
    std::vector<fit::Fit> out;
    for (const fit::Law* law : laws) {
      if (!interruption.asked()) out.push_back(fit::fit(*law, curves, options));
    }
    return out;
  });
  return fit::fits_json(curves, fits);
}

// --- Scenes
// --------------------------------------------------------------------------------------------------

// Data of a scene: the text of a CSV file, or the name of one.
Result<inverse::Data> data_of(const std::string& source, const std::string& text, const SceneDef& scene) {
  return text.empty() ? inverse::read_data(source, scene) : inverse::parse_data(text, source, scene);
}

using Bounds = std::pair<std::optional<double>, std::optional<double>>;

py::dict fit_scene(const std::vector<std::tuple<ScenePtr, std::string, std::string, double>>& given,
                   const std::vector<std::pair<std::string, Bounds>>& sought, int threads, int iterations,
                   const py::object& on_iteration) {
  std::vector<fit::Experiment> experiments;
  for (const auto& [scene, source, text, weight] : given) {
    if (!(weight > 0)) throw Refused("fit_scene: the weight of " + source + " must be positive");
    experiments.push_back({source, *scene, need(data_of(source, text, *scene)), weight});
  }
  if (experiments.empty()) throw Refused("fit_scene: nothing was measured; give a scene and its data");
  std::vector<fit::Sought> constants;
  for (const auto& [path, bounds] : sought) constants.push_back({path, bounds.first, bounds.second});
  Interruption interruption;
  fit::SceneFitOptions options;
  options.threads = threads;
  options.max_iterations = iterations;
  options.stop = [&] { return interruption.asked(); };
  options.on_iteration = watching(interruption, on_iteration);
  const fit::SceneFit found =
      need(released(interruption, [&] { return fit::fit_scenes(experiments, constants, options); }));
  py::dict out;
  out["json"] = fit::scene_fit_json(experiments, found);
  py::list scenes;
  for (const SceneDef& scene : found.scenes) scenes.append(py::cast(shared(scene)));
  out["scenes"] = scenes;
  py::list fitted;
  for (std::size_t k = 0; k < found.fitted.size(); ++k) {
    const inverse::Data& data = experiments[k].data;
    std::vector<std::string> names;
    std::vector<double> times, measured, answered;
    for (std::size_t i = 0; i < data.values.size(); ++i) {
      names.push_back(data.quantities[data.values[i].quantity].name);
      times.push_back(data.time[data.values[i].step]);
      measured.push_back(data.values[i].value);
      answered.push_back(found.fitted[k][static_cast<Eigen::Index>(i)]);
    }
    fitted.append(py::make_tuple(names, array_of(std::move(times), 0), array_of(std::move(measured), 0),
                                 array_of(std::move(answered), 0)));
  }
  out["fitted"] = fitted;
  return out;
}

py::dict drive_scene(const SceneDef& scene, const std::string& source, const std::string& text,
                     const std::vector<std::tuple<std::string, double, double, double>>& amounts,
                     bool horizon, double tolerance, int every, std::optional<double> smooth, int iterations,
                     int threads, const py::object& on_iteration) {
  drive::Targets targets =
      need(text.empty() ? drive::read_targets(source, scene) : drive::parse_targets(text, source, scene));
  std::vector<drive::Actuator> actuators;
  for (const auto& [name, least, most, rate] : amounts) {
    if (!(least < most)) throw Refused("drive: \"" + name + "\": the least amount is not below the largest");
    if (!(rate > 0)) throw Refused("drive: \"" + name + "\": the rate must be positive");
    actuators.push_back({name, least, most, rate});
  }
  Interruption interruption;
  drive::HorizonOptions options;
  options.tolerance = tolerance;
  options.max_iterations = iterations;
  options.threads = threads;
  options.every = every;
  options.smooth = smooth;
  options.stop = [&] { return interruption.asked(); };
  options.on_iteration = watching(interruption, on_iteration);
  const drive::Drive found = need(released(interruption, [&] {
    return horizon ? drive::drive_over_horizon(scene, std::move(actuators), std::move(targets), options)
                   : drive::drive(scene, std::move(actuators), std::move(targets), options);
  }));
  py::dict out;
  out["json"] = drive::drive_json(found);
  const auto driven = drive::driven_scene(scene, found);
  out["scene"] = driven ? py::cast(shared(driven.value())) : py::none();
  return out;
}

py::dict design_scene(const SceneDef& scene, const std::string& source, const std::string& text,
                      const std::vector<std::string>& moves, const py::dict& field, const py::dict& limits,
                      const std::vector<std::string>& hold, const std::string& folder, int iterations,
                      int threads, const py::object& on_iteration) {
  const inverse::Data data = need(data_of(source, text, scene));
  design::DesignOptions options;
  for (const std::string& move : moves) options.moves.push_back(need(design::parse_move(move, scene)));
  options.hold = hold;
  if (field.size() > 0) {
    options.stiffness = design::StiffnessField{field["body"].cast<std::string>(),
                                               field["length"].cast<double>(), field["spread"].cast<double>(),
                                               field["least"].cast<double>(), field["most"].cast<double>()};
  }
  options.least_volume = limits["volume_least"].cast<std::optional<double>>();
  options.most_volume = limits["volume_most"].cast<std::optional<double>>();
  options.least_quality = limits["quality"].cast<double>();
  options.noise = limits["noise"].cast<std::optional<double>>();
  options.folder = folder;
  options.max_iterations = iterations;
  options.threads = threads;
  Interruption interruption;
  options.stop = [&] { return interruption.asked(); };
  options.on_iteration = watching(interruption, on_iteration);
  design::Design found = need(released(interruption, [&] { return design::design(scene, data, options); }));
  py::dict out;
  out["json"] = design::design_json(found);
  out["factor"] = array_of(std::move(found.factor), 0);
  out["deviation"] = array_of(std::move(found.deviation), 0);
  py::list history;
  for (const design::DesignStep& s : found.history)
    history.append(py::make_tuple(s.iteration, s.error * found.noise, s.quality, s.volume, s.moves));
  out["history"] = history;
  out["scene"] = py::cast(shared(std::move(found.scene)));
  return out;
}

}  // namespace

void bind_inverse(py::module_& module) {
  module.def("fit_laws", [](const std::vector<std::tuple<std::string, std::string, std::string>>& curves,
                            const std::vector<std::string>& laws, std::optional<double> lowest,
                            std::optional<double> highest, const std::string& strain,
                            const std::string& stress, const std::string& unit, bool relative) {
    fit::CurveOptions how;
    how.lowest = lowest;
    how.highest = highest;
    how.strain_column = strain;
    how.stress_column = stress;
    how.stress_unit = unit;
    return fit_laws(curves, laws, how, relative);
  });
  module.def("fit_scene", &fit_scene);
  module.def("drive", &drive_scene);
  module.def("design", &design_scene);
}

}  // namespace isochor::python
