// What `automatic` chooses, against every fixed choice that a scene accepts: processor seconds for the first
// steps of each scene of the library.
//
//   isochor_bench_chooser [--steps 3] [--repeats 2] [--scenes a,b] [--element WORD] [--markdown]
//
// One thread, since threads that wait count as work. A choice counts when every step converges and ends where
// the others do, to 1e-6 of the scene's length. Choices take turns, the fastest of the repeats counts.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "isochor/threads.h"
#include "scenes/library.h"
#include "scenes/scene.h"

namespace {

using namespace isochor;

struct Choice {
  const char* name;
  Method method;
  Solver solver;
};
constexpr Choice kChoices[] = {
    {"automatic", Method::automatic, Solver::automatic},
    {"saddle_point, multifrontal", Method::saddle_point, Solver::multifrontal},
    {"condensation, multifrontal", Method::condensation, Solver::multifrontal},
    {"dual_gradients, multifrontal", Method::dual_gradients, Solver::multifrontal},
    {"augmented_gradients, multifrontal", Method::augmented_gradients, Solver::multifrontal},
    {"saddle_point, iterative", Method::saddle_point, Solver::iterative},
    {"saddle_point, mumps", Method::saddle_point, Solver::mumps},
    {"condensation, cholmod_supernodal", Method::condensation, Solver::cholmod_supernodal}};

struct Run {
  bool refused = false, converged = true;
  double seconds = 0;
  int iterations = 0;
  WorldSize size;
  std::vector<Vec3> x;
  std::string method, reason;
};

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Run run(SceneDef def, const Choice& choice, int steps) {
  Run out;
  AnalysisDef& a = def.analysis;
  a.options.method = choice.method;
  a.options.solver = choice.solver;
  const double h = a.step ? *a.step : a.duration / a.steps;
  const double start = processor_seconds();
  Result<BuiltScene> built = build(def, {.threads = 1});
  if (!built) {
    out.refused = true;
    out.reason = built.error();
    return out;
  }
  World& world = built.value().world;
  for (int k = 0; k < std::min(steps, a.steps) && out.converged; ++k) {
    const StepReport r = a.path_step ? world.follow(*a.path_step) : world.advance(h);
    out.iterations += r.iterations;
    out.converged = r.status == StepStatus::converged;
    out.refused = out.refused || r.status == StepStatus::invalid;
    if (!out.converged) out.reason = r.reason;
  }
  out.seconds = processor_seconds() - start;
  out.size = world.size();
  out.method = world.method();
  for (const BodyId body : built.value().bodies) {
    const auto x = world.positions(body);
    out.x.insert(out.x.end(), x.begin(), x.end());
  }
  return out;
}

double distance(const Run& a, const Run& b) {
  double most = 0, extent = 0;
  for (std::size_t i = 0; i < std::min(a.x.size(), b.x.size()); ++i) {
    const Vec3 d = a.x[i] - b.x[i], e = a.x[i] - a.x[0];
    most = std::max(most, std::sqrt(dot(d, d)));
    extent = std::max(extent, std::sqrt(dot(e, e)));
  }
  return extent > 0 ? most / extent : most;
}

struct Row {
  std::string scene;
  Index unknowns = 0;
  std::string best;
  double automatic = 0, fastest = 0;
};

Row compare(const LibraryScene& scene, const SceneVariant& variant, int steps, int repeats, bool verbose) {
  const SceneDef def = scene.make(variant);
  std::vector<Run> best;
  for (int r = 0; r < repeats; ++r) {
    for (std::size_t k = 0; k < std::size(kChoices); ++k) {
      if (r > 0 && (best[k].refused || !best[k].converged || best[k].seconds > 6 * best[0].seconds)) continue;
      Run now = run(def, kChoices[k], steps);
      if (r == 0)
        best.push_back(std::move(now));
      else if (now.seconds < best[k].seconds)
        best[k] = std::move(now);
    }
  }
  Row row;
  row.scene = scene.name;
  row.unknowns = best[0].size.displacement_unknowns + best[0].size.multipliers;
  row.automatic = best[0].seconds;
  row.fastest = HUGE_VAL;
  if (verbose) std::printf("%s: %d unknowns, %s\n", row.scene.c_str(), row.unknowns, best[0].method.c_str());
  for (std::size_t k = 0; k < best.size(); ++k) {
    const Run& b = best[k];
    const double off = distance(best[0], b);
    const bool counts = !b.refused && b.converged && off < 1e-6;
    if (verbose) {
      std::printf("    %-36s %8.3f s, %3d iterations%s\n", kChoices[k].name, b.seconds, b.iterations,
                  b.refused      ? (", refused: " + b.reason).c_str()
                  : !b.converged ? (", NOT CONVERGED: " + b.reason).c_str()
                  : off > 1e-6   ? ", ends elsewhere"
                                 : "");
    }
    if (k == 0 || !counts || b.seconds >= row.fastest) continue;
    row.fastest = b.seconds;
    row.best = kChoices[k].name;
  }
  std::fflush(stdout);
  return row;
}

std::vector<std::string> split(const char* text) {
  std::vector<std::string> words(1);
  for (; *text != '\0'; ++text) {
    if (*text == ',')
      words.emplace_back();
    else
      words.back() += *text;
  }
  return words;
}

}  // namespace

int main(int argc, char** argv) {
  int steps = 3, repeats = 2;
  bool markdown = false;
  std::vector<std::string> only;
  SceneVariant variant;
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (more && std::strcmp(argv[i], "--steps") == 0) {
      steps = std::max(1, std::atoi(argv[++i]));
    } else if (more && std::strcmp(argv[i], "--repeats") == 0) {
      repeats = std::max(1, std::atoi(argv[++i]));
    } else if (more && std::strcmp(argv[i], "--scenes") == 0) {
      only = split(argv[++i]);
    } else if (more && std::strcmp(argv[i], "--element") == 0 && std::strcmp(argv[i + 1], "tet4") == 0) {
      variant.element = Element::tet4;
      ++i;
    } else if (std::strcmp(argv[i], "--markdown") == 0) {
      markdown = true;
    } else {
      std::fprintf(stderr,
                   "usage: isochor_bench_chooser [--steps N] [--repeats N] [--scenes a,b] [--element tet4] "
                   "[--markdown]\n");
      return 2;
    }
  }
  set_blas_threads(1);  // threads that wait count as work
  if (markdown) {
    std::printf("| scene | unknowns | `automatic` [s] | best fixed choice | [s] | ratio |\n");
    std::printf("|---|---|---|---|---|---|\n");
  }
  double worst = 0;
  for (const LibraryScene& scene : scene_library()) {
    if (!only.empty() && std::find(only.begin(), only.end(), scene.name) == only.end()) continue;
    const Row row = compare(scene, variant, steps, repeats, !markdown);
    const double ratio = row.automatic / row.fastest;
    worst = std::max(worst, ratio);
    std::printf(markdown ? "| `%s` | %d | %.2f | %s | %.2f | %.2f |\n"
                         : "  %s: %d unknowns, automatic %.3f s, best %s %.3f s, ratio %.2f\n",
                row.scene.c_str(), row.unknowns, row.automatic, row.best.c_str(), row.fastest, ratio);
    std::fflush(stdout);
  }
  std::printf("\nlargest ratio %.2f\n", worst);
  return 0;
}
