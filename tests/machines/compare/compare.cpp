// Scenes on all ranks of an mpirun against the engine alone, which rank 0 runs first: positions of all nodes
// at the end of every step, and Newton iterations. A program of its own, since test frameworks know nothing
// of ranks.
//
//   mpirun -n 3 isochor_compare_ranks SCENE[@PATH=VALUE]...[@steps N] ...
//
// SCENE: a name of the library or a scene file. Exit code 0 where all agree, 1 where one does not.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "petsc/session.h"
#include "scenes/library.h"
#include "scenes/scene.h"
#include "scenes/scene_file.h"

namespace {

using namespace isochor;

constexpr double kTolerance = 1e-8;  // of the scene's length
constexpr int kIterations = 1;       // a step may take more or fewer

struct Step {
  std::vector<Vec3> x;
  int iterations = 0, substeps = 0, factorizations = 0, shifted = 0;
  StepStatus status = StepStatus::converged;
  std::string reason;
};

struct Run {
  std::vector<Step> steps;
  std::string refusal, method;
  std::size_t slot_bytes = 0, table_bytes = 0;
  double length = 0;
};

Run run(const SceneDef& scene, int most_steps, std::shared_ptr<const Ranks> ranks) {
  Run out;
  BuildOptions options;
  options.threads = 1;
  options.ranks = std::move(ranks);
  auto built = build(scene, options);
  if (!built) {
    out.refusal = built.error();
    return out;
  }
  World& world = built.value().world;
  const StepPlan plan = plan_steps(scene.analysis);
  for (int s = 0; s < std::min(plan.steps, most_steps); ++s) {
    const auto& path_step = scene.analysis.path_step;
    const StepReport report = path_step ? world.follow(*path_step) : world.advance(plan.h);
    Step step;
    for (const BodyId body : built.value().bodies) {
      const auto x = world.positions(body);
      step.x.insert(step.x.end(), x.begin(), x.end());
    }
    step.iterations = report.iterations;
    step.substeps = report.substeps;
    step.factorizations = report.factorizations;
    step.shifted = report.shifted;
    step.status = report.status;
    step.reason = report.reason;
    out.steps.push_back(std::move(step));
    if (report.status != StepStatus::converged || (path_step && world.time() >= scene.analysis.duration))
      break;
  }
  Vec3 low{}, high{};
  bool first = true;
  for (const BodyId body : built.value().bodies) {
    for (const Vec3& x : world.rest_positions(body)) {
      for (int i = 0; i < 3; ++i) {
        low[i] = first ? x[i] : std::min(low[i], x[i]);
        high[i] = first ? x[i] : std::max(high[i], x[i]);
      }
      first = false;
    }
  }
  const Vec3 d = high - low;
  out.length = std::sqrt(dot(d, d));
  out.method = world.method();
  out.slot_bytes = world.size().engine_bytes;
  out.table_bytes = world.size().table_bytes;
  return out;
}

struct Request {
  std::string name;
  std::vector<std::string> overrides;
  int steps = 1 << 30;
};

Request read(const std::string& text) {
  Request r;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t to = std::min(text.find('@', from), text.size());
    const std::string word = text.substr(from, to - from);
    if (from == 0)
      r.name = word;
    else if (word.starts_with("steps "))
      r.steps = std::atoi(word.c_str() + 6);
    else
      r.overrides.push_back(word);
    from = to + 1;
  }
  return r;
}

std::string counts(const Step& s) {
  return std::to_string(s.iterations) + " iterations, " + std::to_string(s.factorizations) +
         " factorizations, " + std::to_string(s.shifted) + " shifts";
}

// What differs; empty: nothing that matters.
std::string difference(const Run& alone, const Run& shared, double& largest) {
  if (!alone.refusal.empty()) return "the engine alone refuses: " + alone.refusal;
  if (!shared.refusal.empty()) return "refused: " + shared.refusal;
  if (alone.steps.size() != shared.steps.size())
    return std::to_string(shared.steps.size()) + " steps, alone " + std::to_string(alone.steps.size()) +
           "; " + shared.steps.back().reason;
  for (std::size_t s = 0; s < alone.steps.size(); ++s) {
    const Step &a = alone.steps[s], &b = shared.steps[s];
    const std::string where = "step " + std::to_string(s + 1) + ": ";
    if (a.status != b.status) return where + "another status: " + b.reason;
    for (std::size_t i = 0; i < a.x.size(); ++i) {
      const Vec3 d = a.x[i] - b.x[i];
      largest = std::max(largest, std::sqrt(dot(d, d)) / alone.length);
    }
    if (!(largest <= kTolerance)) return where + "positions differ";
    if (std::abs(a.iterations - b.iterations) > kIterations * std::max(1, a.substeps))
      return where + counts(b) + ", alone " + counts(a);
  }
  return {};
}

// The first step after which ranks have different bits; 0: none.
std::size_t other_bits(const Run& shared, const Ranks& ranks) {
  for (std::size_t s = 0; s < shared.steps.size(); ++s) {
    const Step& step = shared.steps[s];
    double differs = 0;
    std::vector<double> root(3 * step.x.size(), 0);
    for (std::size_t i = 0; ranks.rank() == 0 && i < step.x.size(); ++i) {
      for (int c = 0; c < 3; ++c) root[3 * i + static_cast<std::size_t>(c)] = step.x[i][c];
    }
    ranks.sum(root);
    for (std::size_t i = 0; i < step.x.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        if (root[3 * i + static_cast<std::size_t>(c)] != step.x[i][c]) differs = 1;
      }
    }
    ranks.sum({&differs, 1});
    if (differs > 0) return s + 1;
  }
  return 0;
}

bool compare(const std::string& text, const std::shared_ptr<const Ranks>& ranks) {
  const Request request = read(text);
  const LibraryScene* known = find_scene(request.name);
  auto scene = known ? override_scene(known->make({}), request.overrides)
                     : read_scene_file(request.name, request.overrides);
  if (!scene) {
    if (ranks->rank() == 0) std::printf("%s: %s\n", text.c_str(), scene.error().c_str());
    return false;
  }
  const bool root = ranks->rank() == 0;
  Run alone;
  if (root) alone = run(scene.value(), request.steps, nullptr);
  const Run shared = run(scene.value(), request.steps, ranks);
  double largest = 0;
  std::string wrong = root ? difference(alone, shared, largest) : "";
  if (const std::size_t step = other_bits(shared, *ranks); step > 0 && wrong.empty())
    wrong = "step " + std::to_string(step) + ": ranks have different bits";
  double failed = wrong.empty() ? 0 : 1;
  ranks->sum({&failed, 1});
  // What a rank holds of what is shared out.
  std::vector<double> bytes(2 * static_cast<std::size_t>(ranks->size()), 0);
  bytes[2 * static_cast<std::size_t>(ranks->rank())] = static_cast<double>(shared.slot_bytes);
  bytes[2 * static_cast<std::size_t>(ranks->rank()) + 1] = static_cast<double>(shared.table_bytes);
  ranks->sum(bytes);
  if (!root) return failed == 0;
  int iterations = 0, iterations_alone = 0;
  for (const Step& s : shared.steps) iterations += s.iterations;
  for (const Step& s : alone.steps) iterations_alone += s.iterations;
  std::printf("%s %s: difference %.1e of the length, %d iterations (alone %d), %zu steps\n",
              wrong.empty() ? "ok  " : "FAIL", text.c_str(), largest, iterations, iterations_alone,
              shared.steps.size());
  std::printf("     %s\n     slots and tables in MB, alone %.1f %.1f, ranks", shared.method.c_str(),
              1e-6 * static_cast<double>(alone.slot_bytes), 1e-6 * static_cast<double>(alone.table_bytes));
  for (std::size_t r = 0; r < bytes.size(); r += 2)
    std::printf(" %.1f %.1f,", 1e-6 * bytes[r], 1e-6 * bytes[r + 1]);
  std::printf("\n");
  if (!wrong.empty()) std::printf("     %s\n", wrong.c_str());
  std::fflush(stdout);
  return failed == 0;
}

}  // namespace

int main(int argc, char** argv) {
  bool good = argc > 1;
  PetscSession session("");
  for (int i = 1; i < argc; ++i) good = compare(argv[i], session.ranks()) && good;
  return good ? 0 : 1;
}
