// Scene files: read, changed, run; records of a run as arrays over time.
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <map>

#include "hosted_world.h"
#include "interruption.h"
#include "reports.h"
#include "scene_runs.h"
#include "scenes/library.h"
#include "scenes/scene_file.h"
#include "scenes/schedule.h"

namespace isochor::python {

namespace {

using ScenePtr = std::shared_ptr<SceneDef>;

ScenePtr share(Result<SceneDef> scene) {
  return std::make_shared<SceneDef>(need(std::move(scene)));
}

ScenePtr from_library(const std::string& name, const Overrides& overrides) {
  const LibraryScene* known = find_scene(name);
  if (!known) return nullptr;
  SceneDef scene = known->make({});
  return share(overrides.empty() ? Result<SceneDef>(std::move(scene)) : override_scene(scene, overrides));
}

py::list library() {
  py::list out;
  for (const LibraryScene& scene : scene_library())
    out.append(py::make_tuple(std::string(scene.name), std::string(scene.title)));
  return out;
}

// Columns of a table that grows by a record at a time, in the order in which they are first named.
class Columns {
 public:
  void put(const std::string& name, double value) { column(name, 0).push_back(value); }
  void put(const std::string& name, const Vec3& v) {
    auto& numbers = column(name, 3);
    numbers.insert(numbers.end(), {v.x, v.y, v.z});
  }
  py::dict arrays() && {
    py::dict out;
    for (const std::string& name : order_)
      out[py::str(name)] = array_of(std::move(columns_.at(name).numbers), columns_.at(name).width);
    return out;
  }

 private:
  struct Column {
    Index width = 0;
    std::vector<double> numbers;
  };
  std::vector<double>& column(const std::string& name, Index width) {
    const auto [at, added] = columns_.try_emplace(name, Column{width, {}});
    if (added) order_.push_back(name);
    return at->second.numbers;
  }

  std::vector<std::string> order_;
  std::map<std::string, Column> columns_;
};

void put_solve(const StepRecord& r, Columns& out) {
  out.put("step", r.step);
  out.put("time", r.time);
  out.put("newton_iterations", r.work.iterations);
  out.put("factorizations", r.work.factorizations);
  out.put("substeps", r.substeps);
  out.put("rejected", r.rejected);
  out.put("seconds", r.seconds);
  out.put("force_residual", r.force_residual);
  out.put("row_residual", r.row_residual);
  out.put("constitutive_residual", r.constitutive_residual);
  out.put("volume_row_residual", r.volume_row_residual);
  out.put("min_J", r.min_J);
  out.put("max_J", r.max_J);
  out.put("inverted_cells", r.inverted_cells);
}

void put_volume(const VolumeMeasures& volume, const std::string& name, Columns& out) {
  out.put(name + ".volume", volume.volume);
  out.put(name + ".volume_change", volume.volume_change());
  out.put(name + ".min_J", volume.min_J);
  out.put(name + ".max_J", volume.max_J);
}

void put_whole(const StepRecord& r, Columns& out) {
  out.put("energies.kinetic", r.energy.kinetic);
  out.put("energies.elastic", r.energy.elastic);
  out.put("energies.gravity", r.energy.gravity);
  out.put("energies.loads", r.energy.loads);
  out.put("energies.pressures", r.energy.pressures);
  out.put("linear_momentum", r.momentum[0]);
  out.put("angular_momentum", r.momentum[1]);
  out.put("volume", r.total.volume);
  out.put("volume_change", r.total.volume_change());
  for (const VolumeMeasures& part : r.parts) put_volume(part, "volumes." + part.name, out);
}

py::dict arrays_of(const RunResult& result) {
  Columns out;
  for (const StepRecord& r : result.records) {
    put_solve(r, out);
    put_whole(r, out);
    for (std::size_t p = 0; p < r.probes.size(); ++p) out.put("probes." + result.probes[p], r.probes[p]);
    for (std::size_t c = 0; c < r.cavities.size(); ++c) {
      out.put("cavities." + result.cavities[c] + ".pressure", r.cavities[c].pressure);
      out.put("cavities." + result.cavities[c] + ".volume", r.cavities[c].volume);
    }
    for (std::size_t s = 0; s < r.reactions.size(); ++s) {
      out.put("reactions." + result.supports[s] + ".force", r.reactions[s].force);
      out.put("reactions." + result.supports[s] + ".moment", r.reactions[s].moment);
    }
    for (const Gauge& g : r.gauges) out.put("gauges." + g.effect + "." + g.quantity, g.value);
  }
  return std::move(out).arrays();
}

py::list metrics_of(const RunResult& result) {
  py::list out;
  for (const MetricValue& m : result.metrics) {
    py::dict one;
    one["name"] = m.def.name;
    one["value"] = m.value;
    one["unit"] = m.def.unit;
    one["reached"] = m.reached;
    one["reference"] = m.def.reference;
    one["error"] = m.error;
    one["within_tolerance"] = m.within;
    one["source"] = m.def.source;
    out.append(one);
  }
  return out;
}

}  // namespace

py::dict dict_of(const RunResult& result) {
  py::dict out;
  out["status"] = to_string(result.status);
  out["reason"] = result.reason;
  out["scene"] = result.scene;
  out["steps_asked"] = result.steps_asked;
  out["wall_s"] = result.wall_s;
  out["state_hash"] = result.state_hash;
  out["warnings"] = py::cast(result.warnings);
  out["metrics"] = metrics_of(result);
  out["arrays"] = arrays_of(result);
  const bool ran = result.status != RunStatus::bad_input;
  out["summary"] = ran ? summary_json(result) : failure_json(result);
  return out;
}

namespace {

py::dict run(const SceneDef& scene, const std::string& folder, int threads, std::optional<double> budget,
             bool resume, const py::object& on_step) {
  Interruption interruption;
  RunOptions options;
  options.folder = folder;
  options.threads = threads;
  options.budget = budget;
  options.resume = resume;
  options.stop = [&] { return interruption.asked(); };
  if (!on_step.is_none()) {
    options.on_step = [&](const StepRecord& record, int steps) {
      interruption.call([&] { on_step(record.step, steps, record.time); });
    };
  }
  RunResult result;
  interruption.begin();
  {
    const py::gil_scoped_release free;
    result = run_scene(scene, options);
  }
  interruption.end();
  if (result.status == RunStatus::bad_input) throw Refused(result.reason);
  return dict_of(result);
}

// A compiled world, and its bodies and effects: (world, [id], [(name, id)]).
py::tuple world_of(const SceneDef& scene, int threads) {
  if (threads < 0)
    throw Refused("Scene.world: threads = " + std::to_string(threads) +
                  "; give a positive number, or 0 for all");
  if (auto r = no_schedule(scene, "a world of a scene"); !r) throw Refused(r.error());
  LogLines log;
  SceneDef logged = scene;
  logged.analysis.options.log = log.writer();
  std::optional<BuiltScene> built;
  {
    const py::gil_scoped_release free;
    built.emplace(need(build(logged, {threads})));
  }
  log.pass_on();
  KeyMeaning meaning;
  meaning.analysis = scene.analysis.type;
  meaning.gravity = scene.analysis.options.gravity;
  meaning.gravity_curve = scene.analysis.options.gravity_curve;
  py::list effects;
  for (const EffectId id : built->world.effects())
    effects.append(py::make_tuple(std::string(built->world.effect_name(id)), id));
  const std::vector<BodyId> bodies = built->bodies;
  return py::make_tuple(std::make_shared<HostedWorld>(std::move(built->world), std::move(meaning), log),
                        py::cast(bodies), effects);
}

}  // namespace

void bind_scenes(py::module_& module) {
  py::class_<SceneDef, ScenePtr>(module, "Scene")
      .def_static("read", [](const std::string& path,
                             const Overrides& overrides) { return share(read_scene_file(path, overrides)); })
      .def_static("from_library", &from_library)
      .def_static(
          "parse",
          [](const std::string& text, const std::string& source, const std::string& folder,
             const Overrides& overrides) { return share(parse_scene(text, source, folder, overrides)); })
      .def("override", [](const SceneDef& scene,
                          const Overrides& overrides) { return share(override_scene(scene, overrides)); })
      .def("json", [](const SceneDef& scene) { return to_json(scene); })
      .def_readonly("name", &SceneDef::name)
      .def_readonly("title", &SceneDef::title)
      .def_readonly("folder", &SceneDef::folder)
      .def("plan",
           [](const SceneDef& scene) {
             const StepPlan plan = plan_steps(scene.analysis);
             return py::make_tuple(plan.steps, plan.h, scene.analysis.path_step);
           })
      .def("world", &world_of)
      .def("run", &run)
      .def("solve_to", &solve_to);
  module.def("library", &library);
  module.def("scenes_folder", &scenes_folder);
}

}  // namespace isochor::python
