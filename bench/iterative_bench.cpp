// Time and memory of the iterative linear solver beside the direct one, on growing meshes.
//
//   isochor_bench_iterative [--quick] [--element] [--tet10] [iterative|mumps|cholmod|multifrontal|automatic
//   ...]
//
// A block of Tet4 at nu = 0.4999 bends under its weight, in one static step: nodal volume rows, stabilized,
// or element rows with --element; of Tet10 with --tet10. Each case runs in a process of its own, so that its
// peak of memory is its own.
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/schemes.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "must.h"
#include "options.h"

namespace {

using namespace isochor;
using bench::must;

struct Outcome {
  int cells = 0, unknowns = 0, iterations = 0, factorizations = 0, newton = 0, linear = 0, shifted = 0,
      ok = 0;
  std::uint64_t hash = 0;
  double total = 0, factor = 0, solve = 0, tip = 0;
};

struct Form {
  Element element = Element::tet4;
  VolumeSpace space = VolumeSpace::node;
};

Outcome run(Solver solver, int width, const Form& form) {
  BoxMeshDef box;
  box.upper = {0.3, 0.1, 0.1};
  box.divisions = {3 * width, width, width};
  WorldOptions options;
  options.scheme = statics();
  options.gravity = {0, 0, -9.81};
  options.solver = solver;
  World world = must(World::create(options));
  BodyDef def;
  def.mesh = must(box_mesh(box));
  if (form.element == Element::tet10) def.mesh = to_tet10(def.mesh);
  def.element = form.element;
  def.materials = {{"", must(neo_hookean({.young = 1e6, .poisson = 0.4999})), 1000}};
  const BodyId body = must(world.add_body(def));
  VolumeDef rows;
  rows.body = body;
  rows.space = form.space;
  must(world.add(volume(rows)));
  DirichletDef fixed;
  fixed.where.body = body;
  fixed.where.surfaces = {"x0"};
  must(world.add(dirichlet(fixed)));
  const StepReport r = world.step(1);
  Outcome out;
  out.cells = world.mesh(body).cell_count();
  out.unknowns = world.size().matrix_size;
  out.iterations = r.iterations;
  out.factorizations = r.factorizations;
  out.newton = r.iterations + r.corrections;
  out.linear = static_cast<int>(r.krylov.iterations);
  out.shifted = r.shifted;
  out.ok = r.status == StepStatus::converged;
  if (!out.ok) std::fprintf(stderr, "%s\n", r.reason.c_str());
  out.total = r.seconds.total;
  out.factor = r.seconds.factor + r.seconds.analyze;
  out.solve = r.seconds.solve;
  out.hash = world.state_hash();
  for (const Vec3& x : world.positions(body)) out.tip = std::min(out.tip, x.z);
  return out;
}

bool run_apart(Solver solver, const char* name, int width, const Form& form) {
  int ends[2];
  if (pipe(ends) != 0) return false;
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    const Outcome out = run(solver, width, form);
    _exit(write(ends[1], &out, sizeof out) == static_cast<ssize_t>(sizeof out) ? 0 : 1);
  }
  close(ends[1]);
  Outcome out;
  const bool got = read(ends[0], &out, sizeof out) == static_cast<ssize_t>(sizeof out);
  close(ends[0]);
  rusage usage{};
  int status = 0;
  wait4(child, &status, 0, &usage);
  if (!got) {
    std::printf("%-10s %3d: the process ended with status %d\n", name, width, status);
    return false;
  }
  // Processor time means something on a shared machine, too.
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  const double cpu = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  std::printf(
      "%-10s %8d tets %8d unknowns  %2d directions of %2d iterations and %2d matrices, %5d Krylov, %d mended "
      "  total %7.1f s  cpu %7.1f s  setup or "
      "factor %7.1f s  "
      "solve %7.1f s  peak %6.2f GiB  lowest z %.9f  state %016llx%s\n",
      name, out.cells, out.unknowns, out.newton, out.iterations, out.factorizations, out.linear, out.shifted,
      out.total, cpu, out.factor, out.solve, static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0),
      out.tip, static_cast<unsigned long long>(out.hash), out.ok ? "" : "  NOT CONVERGED");
  std::fflush(stdout);
  return out.ok != 0;
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {"--quick", "--element", "--tet10"}, {}, true);
  bool quick = false;
  Form form;
  std::vector<std::string> names;
  std::vector<int> widths;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0)
      quick = true;
    else if (std::strcmp(argv[i], "--element") == 0)
      form.space = VolumeSpace::element;
    else if (std::strcmp(argv[i], "--tet10") == 0)
      form.element = Element::tet10;
    else if (std::atoi(argv[i]) > 0)
      widths.push_back(std::atoi(argv[i]));
    else
      names.emplace_back(argv[i]);
  }
  if (names.empty()) names = {"iterative", "mumps"};
  // 30,000 to 250,000 tets: 5 or 6 to a cube.
  if (widths.empty()) widths = quick ? std::vector<int>{4, 6, 8} : std::vector<int>{12, 16, 20, 24};
  bool all = true;
  for (const int width : widths) {
    for (const std::string& name : names) {
      const Solver solver = name == "mumps"          ? Solver::mumps
                            : name == "cholmod"      ? Solver::cholmod
                            : name == "multifrontal" ? Solver::multifrontal
                            : name == "automatic"    ? Solver::automatic
                                                     : Solver::iterative;
      all = run_apart(solver, name.c_str(), width, form) && all;
    }
  }
  return all ? 0 : 1;
}
