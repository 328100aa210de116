#include "scenes/outputs.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "engine/mesh/atomic_file.h"
#include "scenes/run_page.h"

namespace isochor {

namespace fs = std::filesystem;

namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", v);
  return text;
}

std::string series_name(const SceneDef& scene, std::size_t body) {
  return scene.bodies.size() == 1 ? scene.name : scene.name + "_" + scene.bodies[body].name;
}

std::vector<double> region_of_cells(const Mesh& mesh) {
  std::vector<double> region(static_cast<std::size_t>(mesh.cell_count()), 0);
  for (std::size_t c = 0; c < mesh.cell_region.size(); ++c) region[c] = mesh.cell_region[c];
  return region;
}

// Columns of bodies, regions and momentum come last.
std::string part_columns(const RunResult& r) {
  std::string line;
  if (r.records.empty()) return line;
  for (const VolumeMeasures& p : r.records.front().parts)
    line += "," + p.name + ".body_volume_m3," + p.name + ".volume_change," + p.name + ".min_J," + p.name +
            ".max_J";
  for (const char* of : {"linear_momentum_", "angular_momentum_"}) {
    const char* unit = of[0] == 'l' ? "_kg_m_s" : "_kg_m2_s";
    for (const char* axis : {"x", "y", "z"}) line += std::string(",") + of + axis + unit;
  }
  return line;
}

std::string table_header(const RunResult& r) {
  std::string line =
      "step,time,iterations,substeps,rejected,stand_ins,force_residual,row_residual,constitutive_residual,"
      "volume_row_residual,volume_change,min_J,max_J,inverted_cells,elastic_energy_J,kinetic_energy_J,"
      "gravity_potential_J,"
      "load_potential_J,total_energy_J,seconds";
  for (const auto& p : r.probes) line += "," + p + ".x_m," + p + ".y_m," + p + ".z_m";
  for (const auto& c : r.cavities) line += "," + c + ".pressure_Pa," + c + ".volume_m3";
  for (const auto& s : r.supports) {
    for (const char* part : {"force", "moment"}) {
      for (const char* axis : {"x", "y", "z"}) line += "," + s + "." + part + "_" + axis;
    }
  }
  if (!r.records.empty()) {
    for (const Gauge& g : r.records.front().gauges) {
      line += "," + g.effect + "." + g.quantity + (g.unit == "1" ? "" : "_" + g.unit);
    }
  }
  line += part_columns(r);
  return line + "\n";
}

std::string table_row(const StepRecord& r) {
  std::string line = std::to_string(r.step);
  for (const double v :
       {r.time, static_cast<double>(r.iterations), static_cast<double>(r.substeps),
        static_cast<double>(r.rejected), static_cast<double>(r.stand_ins), r.force_residual, r.row_residual,
        r.constitutive_residual, r.volume_row_residual, r.total.volume_change(), r.min_J, r.max_J,
        static_cast<double>(r.inverted_cells), r.elastic_energy, r.kinetic_energy, r.gravity_potential,
        r.load_potential, r.total_energy(), r.seconds}) {
    line += "," + number(v);
  }
  const auto add = [&](const Vec3& v) { line += "," + number(v.x) + "," + number(v.y) + "," + number(v.z); };
  for (const Vec3& p : r.probes) add(p);
  for (const auto& c : r.cavities) line += "," + number(c.pressure) + "," + number(c.volume);
  for (const auto& s : r.reactions) {
    add(s.force);
    add(s.moment);
  }
  for (const Gauge& g : r.gauges) line += "," + number(g.value);
  for (const VolumeMeasures& p : r.parts) {
    for (const double v : {p.volume, p.volume_change(), p.min_J, p.max_J}) line += "," + number(v);
  }
  for (const Vec3& v : r.momentum) add(v);
  return line + "\n";
}

// Frames of an earlier run beside new ones would be shown as one movie.
void remove_old(const fs::path& folder, const SceneDef& scene) {
  std::error_code code;
  for (const char* file : {"summary.json", "steps.csv", "index.html"}) fs::remove(folder / file, code);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const std::string series = series_name(scene, b);
    fs::remove(folder / (series + ".pvd"), code);
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(folder / "frames", code)) {
      const std::string file = entry.path().filename().string();
      if (file.starts_with(series + "_") && file.ends_with(".vtu")) old.push_back(entry.path());
    }
    for (const auto& path : old) fs::remove(path, code);
  }
}

}  // namespace

Result<void> write_text(const std::string& path, const std::string& text) {
  mesh_files::AtomicFile file(path);
  file.write(text);
  return file.commit();
}

RunOutputs::RunOutputs(std::string folder, const SceneDef& scene)
    : folder_(std::move(folder)), name_(scene.name), frames_(scene.bodies.size()) {}
RunOutputs::RunOutputs(RunOutputs&&) noexcept = default;
RunOutputs& RunOutputs::operator=(RunOutputs&&) noexcept = default;
RunOutputs::~RunOutputs() = default;

Result<RunOutputs> RunOutputs::open(const std::string& folder, const SceneDef& scene) {
  std::error_code code;
  fs::create_directories(fs::path(folder) / "frames", code);
  if (code)
    return Error{"output folder " + folder + " cannot be made: " + code.message() +
                 "; name another with --out"};
  // Tried here: later would be after the solve.
  const std::string probe = (fs::path(folder) / "summary.json").string();
  const std::string frame_probe = (fs::path(folder) / "frames" / ".try").string();
  for (const auto& path : {probe, frame_probe}) {
    if (auto r = write_text(path, "{}\n"); !r) {
      return Error{"output folder " + folder + " cannot be written: " + r.error() +
                   "; name another with --out"};
    }
  }
  fs::remove(frame_probe, code);
  remove_old(folder, scene);
  return RunOutputs(folder, scene);
}

Result<void> RunOutputs::write_frame(const RunView& view, std::size_t b, const BodyFields& fields) {
  const World& world = view.built.world;
  const BodyId id = view.built.bodies[b];
  const Mesh& mesh = world.mesh(id);
  const auto x = world.positions(id), rest = world.rest_positions(id), v = world.velocities(id);
  const auto flat = [](std::span<const Vec3> s) {
    return std::span<const double>(reinterpret_cast<const double*>(s.data()), 3 * s.size());
  };
  std::vector<Vec3> displacement(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) displacement[i] = x[i] - rest[i];
  const std::vector<double> region = region_of_cells(mesh);
  VtkGrid grid;
  grid.cell_type = mesh.cell_type;
  // Points stay at rest; the displacement warps them, so that both states can be seen.
  grid.points = rest;
  grid.cells = mesh.cells;
  grid.point_fields = {{"displacement", 3, flat(displacement)},
                       {"pressure", 1, fields.node_pressure},
                       {"stress", 6, fields.node_stress}};
  if (view.scene.analysis.type == AnalysisType::dynamics)
    grid.point_fields.push_back({"velocity", 3, flat(v)});
  if (!fields.node_contact_pressure.empty()) {
    grid.point_fields.push_back({"contact_pressure", 1, fields.node_contact_pressure});
    grid.point_fields.push_back({"friction", 3, fields.node_friction});
  }
  grid.cell_fields = {{"J", 1, fields.cell_J},
                      {"von_mises", 1, fields.cell_von_mises},
                      {"pressure", 1, fields.cell_pressure},
                      {"stress", 6, fields.cell_stress},
                      {"max_stretch", 1, fields.cell_max_stretch},
                      {"region", 1, region}};
  const StepRecord& record = view.result.records.back();
  char suffix[24];
  std::snprintf(suffix, sizeof suffix, "_%05d.vtu", record.step);
  const std::string series = series_name(view.scene, b);
  const std::string file = "frames/" + series + suffix;
  if (auto r = write_vtu((fs::path(folder_) / file).string(), grid); !r) return r;
  frames_[b].push_back({record.time, file});
  return write_pvd((fs::path(folder_) / (series + ".pvd")).string(), frames_[b]);
}

Result<void> RunOutputs::append_row(const RunView& view) {
  if (table_.empty()) table_ = table_header(view.result);
  table_ += table_row(view.result.records.back());
  return write_text((fs::path(folder_) / "steps.csv").string(), table_);
}

Result<void> RunOutputs::record(const RunView& view, bool last) {
  const int step = view.result.records.back().step;
  const int every = view.scene.outputs.every;
  const bool due = every > 0 && (step % every == 0 || last) && step != last_frame_;
  if (due) {
    last_frame_ = step;
    if (!page_ && view.scene.outputs.page) page_ = RunPage::start(view);
    std::vector<BodyFields> fields;
    for (std::size_t b = 0; b < view.built.bodies.size(); ++b) {
      fields.push_back(view.built.world.fields(view.built.bodies[b]));
      if (auto r = write_frame(view, b, fields.back()); !r) return r;
    }
    if (page_) page_->append(view, fields);
  }
  if (auto r = append_row(view); !r) return r;
  return write_text((fs::path(folder_) / "summary.json").string(), summary_json(view.result));
}

Result<void> RunOutputs::finish(const RunView& view) {
  if (page_) {
    // The page is a view of the run; without it the numbers still stand.
    if (auto r = page_->write(view, (fs::path(folder_) / "index.html").string()); !r) {
      view.result.warnings.push_back("no results page: " + r.error());
    }
  }
  return write_text((fs::path(folder_) / "summary.json").string(), summary_json(view.result));
}

}  // namespace isochor
