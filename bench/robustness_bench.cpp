// How far Newton's method gets from bad starts: iterations of the twist test, and how many scrambled, crushed
// and mirrored cubes come back.
//
//   isochor_bench_robustness [--seeds 100] [--divisions 3] [--twist 15]
//
// Counts only, no seconds: the tables are the same on every machine up to rounding.
#include <algorithm>
#include <cstring>

#include "bench/robustness_cases.h"

namespace {

using namespace robustness;

const std::vector<Formulation> kFormulations = {
    {"hex8, one field", Element::hex8, 0.49, false, VolumeSpace::node},
    {"tet4, one field", Element::tet4, 0.49, false, VolumeSpace::node},
    {"edge-smoothed, one field", Element::tet4_edge_smoothed, 0.49, false, VolumeSpace::node},
    {"hex8, element rows", Element::hex8, 0.49, true, VolumeSpace::element},
    {"hex8, nodal rows", Element::hex8, 0.49, true, VolumeSpace::node},
    {"tet4, nodal rows", Element::tet4, 0.49, true, VolumeSpace::node},
    {"edge-smoothed, nodal rows", Element::tet4_edge_smoothed, 0.49, true, VolumeSpace::node},
    {"tet10, nodal rows", Element::tet10, 0.49, true, VolumeSpace::node},
    {"hex8, element rows, nu = 0.5", Element::hex8, 0.5, true, VolumeSpace::element},
    {"hex8, nodal rows, nu = 0.5", Element::hex8, 0.5, true, VolumeSpace::node},
    {"tet4, nodal rows, nu = 0.5", Element::tet4, 0.5, true, VolumeSpace::node},
    {"edge-smoothed, nodal rows, nu = 0.5", Element::tet4_edge_smoothed, 0.5, true, VolumeSpace::node},
};

int number_after(int argc, char** argv, const char* flag, int otherwise) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], flag) == 0) return std::atoi(argv[i + 1]);
  }
  return otherwise;
}

void print_twist(int divisions) {
  std::printf("Twist by pi/2, twice: unit cube of %d^3 cells, force tolerance 1e-6\n", divisions);
  std::printf("%-36s %22s %8s %8s\n", "formulation", "iterations per solve", "volume", "min J");
  for (const Formulation& f : kFormulations) {
    const Twist t = twist(f, divisions, 200);
    std::string counts;
    for (const StepReport& r : t.solves) {
      counts +=
          (counts.empty() ? "" : ", ") + std::to_string(r.iterations) + " + " + std::to_string(r.corrections);
      if (r.status != StepStatus::converged) counts += " (stopped)";
    }
    std::printf("%-36s %22s %+7.2f%% %8.3f\n", f.name.c_str(), counts.c_str(),
                100 * (t.measures.volume / t.measures.rest_volume - 1), t.measures.min_J);
    std::fflush(stdout);
  }
}

template <class Start>
void print_recoveries(const char* title, int divisions, int seeds, const Start& start) {
  std::printf("\n%s: unit cube of %d^3 cells, %d starts\n", title, divisions, seeds);
  std::printf("%-36s %9s %9s %12s %9s\n", "formulation", "recovered", "elsewhere", "not converged",
              "iterations");
  for (const Formulation& f : kFormulations) {
    int recovered = 0, elsewhere = 0;
    std::vector<int> iterations;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Outcome o = recover_from(f, divisions, 500, [&](std::span<const Vec3> rest) {
        return start(rest, static_cast<unsigned>(seed));
      });
      recovered += o.recovered() ? 1 : 0;
      elsewhere += o.converged() && !o.recovered() ? 1 : 0;
      iterations.push_back(o.report.iterations + o.report.corrections);
    }
    std::sort(iterations.begin(), iterations.end());
    std::printf("%-36s %9d %9d %12d %4d..%d\n", f.name.c_str(), recovered, elsewhere,
                seeds - recovered - elsewhere, iterations.front(), iterations.back());
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = number_after(argc, argv, "--seeds", 100);
  const int divisions = number_after(argc, argv, "--divisions", 3);
  if (const int n = number_after(argc, argv, "--twist", 15); n > 0) print_twist(n);
  if (seeds < 1) return 0;
  print_recoveries("Scrambled", divisions, seeds, scrambled);
  for (const Crushed how : kCrushed) {
    const std::string title = std::string("Crushed, ") + robustness::name_of(how);
    print_recoveries(title.c_str(), divisions, std::min(seeds, 10),
                     [&](std::span<const Vec3> rest, unsigned seed) { return crushed(rest, how, seed - 1); });
  }
  return 0;
}
