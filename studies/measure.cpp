// One cell: its runs, their times, its fingerprint.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>

#include "scenes/scene_file.h"
#include "studies/run_study.h"

namespace isochor::studies {

namespace {

class Fnv {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 1099511628211ull;
    // Texts that follow one another must not run together.
    hash_ = (hash_ ^ 0x1f) * 1099511628211ull;
  }
  void add_file(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::vector<char> block(1 << 16);
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0)
      add({block.data(), static_cast<std::size_t>(in.gcount())});
  }
  std::string text() const {
    char buffer[20];
    std::snprintf(buffer, sizeof buffer, "%016llx", static_cast<unsigned long long>(hash_));
    return buffer;
  }

 private:
  std::uint64_t hash_ = 14695981039346656037ull;
};

// Numbers of another build are not mixed with this one's.
const std::string& program_hash() {
  static const std::string hash = [] {
    Fnv fnv;
    fnv.add_file("/proc/self/exe");
    fnv.add(version());
    fnv.add(build_description());
    fnv.add(machine_description());
    return fnv.text();
  }();
  return hash;
}

std::string bits(double v) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%a", v);
  return buffer;
}

double cpu_now() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double wall_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A folder of its own for the outputs of a run, removed with it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "isochor-XXXXXX").string();
    if (const char* made = mkdtemp(name.data())) path_ = made;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code code;
    if (!path_.empty()) std::filesystem::remove_all(path_, code);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

struct Timed {
  double wall = 0, cpu = 0;
  RunResult run;      // of a scene
  std::string error;  // of a probe
  Numbers numbers;    // of a probe
};

Timed run_once(const Cell& cell, int threads, const std::function<bool()>& stop) {
  Timed t;
  std::optional<ScratchFolder> scratch;
  if (cell.outputs) {
    scratch.emplace();
    // Without a folder the run would write nothing, and the cell say that writing costs nothing.
    if (scratch->path().empty()) {
      t.run.status = RunStatus::failed;
      t.run.reason = "no folder for outputs could be made in " +
                     std::filesystem::temp_directory_path().string() +
                     "; set TMPDIR to one that can be written";
      return t;
    }
  }
  const double wall = wall_now(), cpu = cpu_now();
  if (cell.probe) {
    auto numbers = cell.probe(cell.scene, threads);
    if (numbers)
      t.numbers = std::move(numbers).value();
    else
      t.error = numbers.error();
    t.run.status = t.error.empty() ? RunStatus::converged : RunStatus::bad_input;
    t.run.reason = t.error;
    t.run.threads = threads;
  } else {
    RunOptions options;
    options.threads = threads;
    options.stop = stop;
    if (scratch) options.folder = scratch->path();
    t.run = run_scene(cell.scene, options);
  }
  t.cpu = cpu_now() - cpu;
  t.wall = wall_now() - wall;
  return t;
}

void describe(Measured& m, const RunResult& r) {
  m.status = to_string(r.status);
  m.reason = r.reason;
  m.elements = r.elements;
  m.nodes = r.size.nodes;
  m.displacements = r.size.displacement_unknowns;
  m.multipliers = r.size.multipliers;
  m.nonzeros = r.size.matrix_nonzeros;
  m.factor_nonzeros = r.size.factor_nonzeros;
  m.engine_bytes = static_cast<std::int64_t>(r.size.engine_bytes);
  m.steps = r.records.empty() ? 0 : r.records.back().step;
  m.iterations = r.work.iterations;
  m.factorizations = r.work.factorizations;
  m.solves = r.work.solves();
  m.threads = r.threads;
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(r.state_hash));
  m.hash = hash;
  for (const MetricValue& v : r.metrics) {
    if (v.reached) m.values[v.def.name] = v.value;
  }
  if (r.records.empty()) return;
  m.values["min J"] = r.records.back().min_J;
  m.values["max J"] = r.records.back().max_J;
}

void compare(Measured& m, const Cell& cell) {
  const auto it = m.values.find(cell.metric);
  if (cell.metric.empty() || it == m.values.end()) return;
  m.value = it->second;
  m.reference = cell.reference;
  if (!m.good() || !m.reference) return;
  const double difference = std::abs(*m.value - *m.reference);
  m.error = *m.reference == 0 ? difference : difference / std::abs(*m.reference);
}

}  // namespace

double Measured::number(const std::string& key) const {
  const auto it = values.find(key);
  return it == values.end() ? std::nan("") : it->second;
}

std::string fingerprint(const Cell& cell, int threads, int repeats) {
  Fnv fnv;
  fnv.add(program_hash());
  fnv.add(cell.id);
  fnv.add(cell.metric);
  fnv.add(cell.reference ? bits(*cell.reference) : "");
  fnv.add(bits(cell.uncertainty));
  fnv.add(cell.source);
  for (const auto& [key, value] : cell.labels) fnv.add(key + "=" + value);
  for (const auto& [key, value] : cell.knobs) fnv.add(key + "=" + bits(value));
  fnv.add(to_json(cell.scene));
  for (const SceneBody& body : cell.scene.bodies) {
    if (const auto* file = std::get_if<MeshFile>(&body.mesh))
      fnv.add_file(std::filesystem::path(cell.scene.folder) / file->path);
    if (const auto* lattice = std::get_if<LatticeMesh>(&body.mesh))
      fnv.add_file(std::filesystem::path(cell.scene.folder) / lattice->surface);
  }
  if (cell.outputs) fnv.add("outputs");
  fnv.add(std::to_string(cell.threads > 0 ? cell.threads : threads) + " " + std::to_string(repeats));
  return fnv.text();
}

Measured measure(const Cell& cell, int threads, int repeats, double budget,
                 const std::function<bool()>& stop) {
  const int used = cell.threads > 0 ? cell.threads : threads;
  Measured m;
  m.id = cell.id;
  m.labels = cell.labels;
  m.knobs = cell.knobs;
  m.source = cell.source;
  m.uncertainty = cell.uncertainty;
  m.fingerprint = fingerprint(cell, threads, repeats);
  const double start = wall_now();
  Timed first = run_once(cell, used, stop);
  m.values = first.numbers;
  describe(m, first.run);
  compare(m, cell);
  m.seconds = m.seconds_median = first.wall;
  m.cpu_seconds = first.cpu;
  m.stages = first.run.stages;
  if (!m.good() || cell.probe) return m;
  std::vector<double> walls;
  while (static_cast<int>(walls.size()) < repeats && wall_now() - start < budget) {
    const Timed t = run_once(cell, used, stop);
    if (t.run.status == RunStatus::interrupted) {
      m.status = to_string(t.run.status);
      return m;
    }
    if (t.run.state_hash != first.run.state_hash) {
      m.status = "failed";
      m.reason = "a repeated run of the same scene gave another state";
      return m;
    }
    if (walls.empty() || t.wall < m.seconds) {
      m.seconds = t.wall;
      m.stages = t.run.stages;
    }
    m.cpu_seconds = walls.empty() ? t.cpu : std::min(m.cpu_seconds, t.cpu);
    walls.push_back(t.wall);
  }
  m.repeats = static_cast<int>(walls.size());
  if (walls.empty()) return m;
  std::sort(walls.begin(), walls.end());
  m.seconds_median = walls[walls.size() / 2];
  return m;
}

}  // namespace isochor::studies
