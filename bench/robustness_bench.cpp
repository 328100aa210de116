// How far Newton's method gets from bad starts: iterations of the twist test, and how many scrambled, crushed
// and mirrored cubes come back.
//
//   isochor_bench_robustness [--seeds 100] [--divisions 3] [--twist 8] [--only "part of a name"]
//
// Counts only, no seconds: the tables are the same on every machine up to rounding.
#include <algorithm>
#include <cstring>

#include "bench/robustness_cases.h"
#include "options.h"

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
    {"hex8, nodal rows, projected", Element::hex8, 0.49, true, VolumeSpace::node, Definiteness::projected},
    {"tet4, nodal rows, projected", Element::tet4, 0.49, true, VolumeSpace::node, Definiteness::projected},
    {"the same hex8, nu = 0.5", Element::hex8, 0.5, true, VolumeSpace::node, Definiteness::projected},
    {"the same tet4, nu = 0.5", Element::tet4, 0.5, true, VolumeSpace::node, Definiteness::projected},
    {"hex8, one field, projected", Element::hex8, 0.49, false, VolumeSpace::node, Definiteness::projected},
    {"hex8, one field, nu = 0.3", Element::hex8, 0.3, false, VolumeSpace::node},
    {"tet4, one field, nu = 0.3", Element::tet4, 0.3, false, VolumeSpace::node},
    {"edge-smoothed, nodal rows, nu = 0.5", Element::tet4_edge_smoothed, 0.5, true, VolumeSpace::node},
};

int number_after(int argc, char** argv, const char* flag, int otherwise) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], flag) == 0) return std::atoi(argv[i + 1]);
  }
  return otherwise;
}

bool chosen(const Formulation& f, const std::string& only) {
  return f.name.find(only) != std::string::npos;
}

// The first iteration after which the residual stays below a threshold for good.
int settled(const std::vector<double>& residuals, double threshold) {
  int count = static_cast<int>(residuals.size());
  while (count > 0 && residuals[static_cast<std::size_t>(count - 1)] < threshold) --count;
  return count + 1;
}

void print_twist(int divisions, const std::string& only) {
  std::printf("Twist by pi/2, twice: unit cube of %d^3 cells, force tolerance 1e-6\n", divisions);
  std::printf("%-36s %22s %16s %8s %8s\n", "formulation", "iterations per solve", "to 1e-2, 1e-3", "volume",
              "min J");
  for (const Formulation& f : kFormulations) {
    if (!chosen(f, only)) continue;
    const Twist t = twist(f, divisions, 200);
    std::string counts, loose;
    for (const auto& residuals : t.residuals) {
      loose += (loose.empty() ? "" : "; ") + std::to_string(settled(residuals, 1e-2)) + ", " +
               std::to_string(settled(residuals, 1e-3));
    }
    for (const StepReport& r : t.solves) {
      counts +=
          (counts.empty() ? "" : ", ") + std::to_string(r.iterations) + " + " + std::to_string(r.corrections);
      if (r.status != StepStatus::converged) counts += " (stopped)";
    }
    std::printf("%-36s %22s %16s %+7.2f%% %8.3f\n", f.name.c_str(), counts.c_str(), loose.c_str(),
                100 * (t.measures.volume / t.measures.rest_volume - 1), t.measures.min_J);
    std::fflush(stdout);
  }
}

template <class Start>
void print_recoveries(const char* title, int divisions, int seeds, const std::string& only,
                      const Start& start) {
  std::printf("\n%s: unit cube of %d^3 cells, %d starts\n", title, divisions, seeds);
  std::printf("%-36s %9s %9s %12s %9s\n", "formulation", "recovered", "elsewhere", "not converged",
              "iterations");
  for (const Formulation& f : kFormulations) {
    if (!chosen(f, only)) continue;
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
  isochor::bench::check_options(argc, argv, {}, {"--seeds", "--divisions", "--only", "--twist"});
  const int seeds = number_after(argc, argv, "--seeds", 100);
  const int divisions = number_after(argc, argv, "--divisions", 3);
  std::string only;
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], "--only") == 0) only = argv[i + 1];
  }
  if (const int n = number_after(argc, argv, "--twist", 8); n > 0) print_twist(n, only);
  if (seeds < 1) return 0;
  print_recoveries("Scrambled", divisions, seeds, only, scrambled);
  for (const Crushed how : kCrushed) {
    const std::string title = std::string("Crushed, ") + robustness::name_of(how);
    print_recoveries(title.c_str(), divisions, std::min(seeds, 10), only,
                     [&](std::span<const Vec3> rest, unsigned seed) { return crushed(rest, how, seed - 1); });
  }
  return 0;
}
