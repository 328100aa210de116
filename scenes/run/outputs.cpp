#include "scenes/run/outputs.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "engine/base/atomic_file.h"
#include "scenes/run/error_places.h"
#include "scenes/run/pieces.h"
#include "scenes/run/run_page.h"
#include "scenes/scene_file.h"

namespace isochor {

namespace fs = std::filesystem;

namespace {

// An empty cell is what readers of tables take for a number that is missing; few of them know inf and nan.
std::string number(double v) {
  if (!std::isfinite(v)) return {};
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
       {r.time, static_cast<double>(r.work.iterations), static_cast<double>(r.substeps),
        static_cast<double>(r.rejected), static_cast<double>(r.work.dual.stand_ins), r.force_residual,
        r.row_residual, r.constitutive_residual, r.volume_row_residual, r.total.volume_change(), r.min_J,
        r.max_J, static_cast<double>(r.inverted_cells), r.energy.elastic, r.energy.kinetic, r.energy.gravity,
        r.load_potential(), r.total_energy(), r.seconds}) {
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

constexpr const char* kCheckpoint = "checkpoint.state";
constexpr const char* kPageJournal = "checkpoint.page";

std::string frame_file(const std::string& series, int step, const char* ending = ".vtu") {
  char suffix[24];
  std::snprintf(suffix, sizeof suffix, "_%05d", step);
  return series + suffix + ending;
}

// Whether a file is that frame, its list of pieces, or one of its pieces.
bool is_of_frame(const std::string& file, const std::string& series, int step) {
  const std::string stem = frame_file(series, step, "");
  if (!file.starts_with(stem)) return false;
  const std::string rest = file.substr(stem.size());
  return rest == ".vtu" || rest == ".pvtu" || (rest.starts_with("_") && rest.ends_with(".vtu"));
}

bool frame_due(const SceneDef& scene, int step) {
  return scene.outputs.every > 0 && step % scene.outputs.every == 0;
}

// Files of a folder for which `of` holds, and what a killed run left of files that were to replace others;
// or that alone.
enum class Remove : std::uint8_t { all, what_was_left };
template <class Of>
void remove_files(const fs::path& folder, Of of, Remove which = Remove::all) {
  std::error_code code;
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string file = entry.path().filename().string();
    const bool left = file.ends_with(".tmp") && of(file.substr(0, file.rfind('.', file.size() - 5)));
    if (left || (which == Remove::all && of(file))) old.push_back(entry.path());
  }
  for (const auto& path : old) fs::remove(path, code);
}

// Frames of an earlier run beside new ones would be shown as one movie. Up to step `kept` they stay.
void remove_frames(const fs::path& folder, const SceneDef& scene, int kept) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const std::string series = series_name(scene, b);
    const auto frame = [&](const std::string& file) {
      return file.starts_with(series + "_") && (file.ends_with(".vtu") || file.ends_with(".pvtu"));
    };
    const auto stays = [&](const std::string& file) {
      int step = 0;
      return std::sscanf(file.c_str() + series.size(), "_%d", &step) == 1 && step <= kept &&
             frame_due(scene, step) && is_of_frame(file, series, step);
    };
    remove_files(folder / "frames", frame, Remove::what_was_left);
    remove_files(folder / "frames", [&](const std::string& file) { return frame(file) && !stays(file); });
  }
}

void remove_outputs(const fs::path& folder, const SceneDef& scene, Remove which) {
  const auto output = [&](const std::string& file) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      if (file == series_name(scene, b) + ".pvd") return true;
    }
    return file == "summary.json" || file == "steps.csv" || file == "index.html" || file == kCheckpoint ||
           file == kPageJournal;
  };
  remove_files(folder, output, which);
}

}  // namespace

Result<void> write_text(const std::string& path, const std::string& text) {
  mesh_files::AtomicFile file(path);
  file.write(text);
  return file.commit();
}

RunOutputs::RunOutputs(std::string folder, const SceneDef& scene)
    : folder_(std::move(folder)),
      name_(scene.name),
      frames_(scene.bodies.size()),
      keeps_(scene.outputs.checkpoint_steps > 0 || scene.outputs.checkpoint_seconds > 0),
      journal_((fs::path(folder_) / kPageJournal).string()) {}
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
  remove_outputs(folder, scene, Remove::all);
  remove_frames(folder, scene, -1);
  return RunOutputs(folder, scene);
}

RunOutputs RunOutputs::silent(const std::string& folder, const SceneDef& scene) {
  RunOutputs outputs(folder, scene);
  outputs.silent_ = true;
  return outputs;
}

Result<std::optional<RunCheckpoint>> RunOutputs::checkpoint_in(const std::string& folder) {
  const fs::path path = fs::path(folder) / kCheckpoint;
  std::error_code code;
  if (!fs::exists(path, code)) return std::optional<RunCheckpoint>();
  auto checkpoint = read_checkpoint(path.string());
  if (!checkpoint) return checkpoint.failure();
  return std::optional(std::move(checkpoint).value());
}

Result<RunOutputs> RunOutputs::reopen(const std::string& folder, const RunView& view,
                                      const RunCheckpoint& checkpoint) {
  const SceneDef& scene = view.scene;
  RunOutputs outputs(folder, scene);
  remove_frames(folder, scene, checkpoint.step);
  remove_outputs(folder, scene, Remove::what_was_left);
  remove_files(folder, [&](const std::string& file) { return file == "index.html"; });
  outputs.table_ = table_header(view.result);
  for (const StepRecord& record : checkpoint.records) {
    outputs.table_ += table_row(record);
    ++outputs.rows_;
    if (!frame_due(scene, record.step)) continue;
    outputs.last_frame_ = record.step;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      // One process may go on with what several began, and the other way round.
      std::string file = "frames/" + frame_file(series_name(scene, b), record.step);
      std::error_code code;
      if (!fs::exists(fs::path(folder) / file, code))
        file = "frames/" + frame_file(series_name(scene, b), record.step, ".pvtu");
      if (fs::exists(fs::path(folder) / file, code))
        outputs.frames_[b].push_back({record.time, file});
      else
        view.result.warnings.push_back("the run is resumed without " + file + ", which is gone");
    }
  }
  // Frames of a page go with frames in files.
  if (outputs.last_frame_ >= 0 && scene.outputs.page) outputs.page_ = RunPage::start(view);
  auto frames = outputs.journal_.restart(checkpoint.page_bytes);
  if (!frames) return frames.failure();
  for (const PageFrame& frame : frames.value()) {
    if (outputs.page_) outputs.page_->append(frame);
  }
  return outputs;
}

Result<void> RunOutputs::keep(const RunCheckpoint& checkpoint) {
  if (silent_) return {};
  return write_checkpoint((fs::path(folder_) / kCheckpoint).string(), checkpoint);
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
  const std::vector<double> share = largest_shares(view.result.origins, b);
  if (!share.empty()) grid.cell_fields.push_back({"error_share", 1, share});
  const StepRecord& record = view.result.records.back();
  const std::string series = series_name(view.scene, b);
  const std::string file = "frames/" + frame_file(series, record.step, ranks_ ? ".pvtu" : ".vtu");
  const std::string path = (fs::path(folder_) / file).string();
  if (auto r = ranks_ ? write_pieces(path, grid, *ranks_) : write_vtu(path, grid); !r) return r;
  frames_[b].push_back({record.time, file});
  Result<void> listed;
  if (!silent_) listed = write_pvd((fs::path(folder_) / (series + ".pvd")).string(), frames_[b]);
  return ranks_ ? on_all(std::move(listed), *ranks_) : listed;
}

Result<void> RunOutputs::append_row(const RunView& view) {
  // A step that led nowhere has no record of its own.
  if (rows_ == view.result.records.size()) return {};
  rows_ = view.result.records.size();
  if (table_.empty()) table_ = table_header(view.result);
  table_ += table_row(view.result.records.back());
  return write_text((fs::path(folder_) / "steps.csv").string(), table_);
}

Result<void> RunOutputs::write_summary(const RunView& view) {
  return write_text((fs::path(folder_) / "summary.json").string(), summary_json(view.result));
}

Result<void> RunOutputs::record(const RunView& view, bool last) {
  const int step = view.result.records.back().step;
  const int every = view.scene.outputs.every;
  const bool due = every > 0 && (frame_due(view.scene, step) || last) && step != last_frame_;
  if (due) {
    last_frame_ = step;
    if (!silent_ && !page_ && view.scene.outputs.page) page_ = RunPage::start(view);
    std::vector<BodyFields> fields;
    for (std::size_t b = 0; b < view.built.bodies.size(); ++b) {
      fields.push_back(view.built.world.fields(view.built.bodies[b]));
      if (auto r = write_frame(view, b, fields.back()); !r) return r;
    }
    if (page_) {
      const PageFrame frame = page_->append(view, fields);
      // One that is due to the end alone is none of a run that goes on.
      if (keeps() && frame_due(view.scene, step)) {
        if (auto r = journal_.append(frame); !r) return r;
      }
    }
  }
  if (silent_) return {};
  if (auto r = append_row(view); !r) return r;
  return write_summary(view);
}

Result<void> RunOutputs::finish(const RunView& view) {
  if (silent_) return {};
  // The page is a view of the run; where it cannot show that, the numbers still stand.
  if (page_ && !page_->failure().empty()) {
    view.result.warnings.push_back("no results page: " + page_->failure());
  } else if (page_) {
    if (auto r = page_->write(view, (fs::path(folder_) / "index.html").string()); !r) return r;
  }
  if (auto r = write_summary(view); !r) return r;
  if (!keeps() || view.result.status != RunStatus::converged) return {};
  RunCheckpoint end;
  end.scene = to_json(view.scene);
  end.step = view.result.records.back().step;
  end.ended = true;
  std::error_code code;
  fs::remove(fs::path(folder_) / kPageJournal, code);
  return keep(end);
}

void RunOutputs::tell_failure(const RunView& view) {
  if (silent_ || write_summary(view)) return;
  // Where there is no room for another file, the one that is there has some.
  const std::string path = (fs::path(folder_) / "summary.json").string();
  std::error_code code;
  const auto size = fs::file_size(path, code);
  if (code) return;
  std::string text = failure_json(view.result);
  if (text.size() > size) return;
  text.resize(size, '\n');
  if (std::FILE* file = std::fopen(path.c_str(), "r+b")) {
    std::fwrite(text.data(), 1, text.size(), file);
    std::fclose(file);
  }
}

}  // namespace isochor
