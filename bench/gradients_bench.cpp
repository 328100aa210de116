// What a gradient costs: one output by the stiffness of every cell, against one iteration of Newton's method
// on the same scene; and the same by whole-region parameters.
//
//   isochor_bench_gradients [--divisions 10] [--repeats 7] [--markdown]
//
// A cantilever at nu = 0.5 under its own weight. The iteration is a step whose load is 1 % larger with a
// budget of one: evaluated with Hessians, factored, solved, searched along. Processor time, medians of the
// repeats.
//
// And of ways through time: the cantilever falls and swings for ten steps; the gradient of its tip at the
// end, by the adjoint, against the same steps alone. It makes the steps itself, once.
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/gradients.h>
#include <isochor/schemes.h>
#include <isochor/world.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <type_traits>
#include <vector>

#include "must.h"
#include "options.h"

namespace {

using namespace isochor;
using bench::must;

struct Beam {
  World world;
  BodyId body;
};

Beam beam(Element element, int divisions, bool moves) {
  WorldOptions options;
  options.scheme = moves ? bdf2() : statics();
  options.threads = 1;
  options.gravity = {0, 0, -9.81};
  Beam out{must(World::create(options)), {}};
  BoxMeshDef def;
  def.upper = {0.2, 0.1, 0.1};
  def.divisions = {2 * divisions, divisions, divisions};
  if (element == Element::hex8) def.cell_type = CellType::hex8;
  BodyDef body;
  body.mesh = must(box_mesh(def));
  body.element = element;
  body.materials = {{"", must(neo_hookean({.young = 100e3, .poisson = 0.5})), 1070}};
  out.body = must(out.world.add_body(std::move(body)));
  VolumeDef rows;
  rows.body = out.body;
  must(out.world.add(volume(rows)));
  DirichletDef fixed;
  fixed.where.body = out.body;
  fixed.where.surfaces = {"x0"};
  must(out.world.add(dirichlet(fixed)));
  if (moves) return out;
  const StepReport report = out.world.advance(1);
  if (report.status != StepStatus::converged) {
    std::fprintf(stderr, "%s\n", report.reason.c_str());
    std::exit(2);
  }
  return out;
}

double median(std::vector<double> list) {
  std::sort(list.begin(), list.end());
  return list[list.size() / 2];
}

template <class Work>
double seconds_of(Work&& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

struct Costs {
  Index cells = 0;
  double iteration = 0, by_cells = 0, by_density = 0, by_young = 0;
};

Costs measure(Element element, int divisions, int repeats) {
  Beam b = beam(element, divisions, false);
  Costs out;
  out.cells = b.world.mesh(b.body).cell_count();
  const Index tip = b.world.mesh(b.body).node_count() - 1;
  const auto gradient = [&](Parameter p) {
    GradientQuery query;
    query.outputs = {Output::node(b.body, tip, {0, 0, 1})};
    query.parameters = {std::move(p)};
    query.mode = GradientQuery::Mode::adjoint;
    std::vector<double> all;
    for (int k = 0; k < repeats; ++k) all.push_back(seconds_of([&] { must(b.world.gradients(query)); }));
    return median(std::move(all));
  };
  out.by_cells = gradient(Parameter::cell_stiffness(b.body));
  out.by_density = gradient(Parameter::density(b.body));
  out.by_young = gradient(Parameter::material(
      b.body, "", 100e3, [](double young) { return neo_hookean({.young = young, .poisson = 0.5}); }));
  const std::vector<std::byte> here = b.world.save();
  std::vector<double> all;
  for (int k = 0; k < repeats; ++k) {
    must(b.world.load(here));
    must(b.world.set_gravity({0, 0, -9.81 * 1.01}));
    StepBudget budget;
    budget.iterations = 1;
    all.push_back(seconds_of([&] { b.world.step(0.1, budget); }));
  }
  out.iteration = median(std::move(all));
  return out;
}

struct WayCosts {
  Index cells = 0;
  double forward = 0, by_cells = 0, by_density = 0, by_young = 0, again = 0;
};

WayCosts measure_way(Element element, int divisions, int repeats) {
  const std::vector<double> steps(10, 0.01);
  Beam b = beam(element, divisions, true);
  must(b.world.compile());
  WayCosts out;
  out.cells = b.world.mesh(b.body).cell_count();
  const Index tip = b.world.mesh(b.body).node_count() - 1;
  const auto median_of = [&](auto&& work) {
    std::vector<double> all;
    for (int k = 0; k < repeats; ++k) {
      must(b.world.reset());
      all.push_back(seconds_of(work));
    }
    return median(std::move(all));
  };
  out.forward = median_of([&] {
    for (const double h : steps) {
      const StepReport report = b.world.step(h);
      if (report.status == StepStatus::converged) continue;
      std::fprintf(stderr, "%s\n", report.reason.c_str());
      std::exit(2);
    }
  });
  const auto gradient = [&](const Parameter& p, Index kept) {
    TrajectoryQuery query;
    query.steps = steps;
    query.outputs = {{{{static_cast<Index>(steps.size()), Output::node(b.body, tip, {0, 0, 1})}}}};
    query.parameters = {p};
    query.mode = GradientQuery::Mode::adjoint;
    query.kept_states = kept;
    return median_of([&] { must(b.world.trajectory_gradients(query)); });
  };
  out.by_cells = gradient(Parameter::cell_stiffness(b.body), 0);
  out.again = gradient(Parameter::cell_stiffness(b.body), 2);
  out.by_density = gradient(Parameter::density(b.body), 0);
  out.by_young = gradient(
      Parameter::material(b.body, "", 100e3,
                          [](double young) { return neo_hookean({.young = young, .poisson = 0.5}); }),
      0);
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  bench::check_options(argc, argv, {"--markdown"}, {"--divisions", "--repeats"});
  int divisions = 10, repeats = 7;
  bool markdown = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--markdown") markdown = true;
    if (word == "--divisions") divisions = std::atoi(argv[++i]);
    if (word == "--repeats") repeats = std::atoi(argv[++i]);
  }
  std::printf(markdown
                  ? "| element | cells | iteration [ms] | by all cells | by density | by Young's modulus |\n"
                    "|---|---|---|---|---|---|\n"
                  : "element              cells  iteration [ms]  by all cells  by density  by E\n");
  // As many cells of each, but of quadratic tets, whose matrices are much larger, an eighth.
  struct Case {
    Element element;
    const char* name;
    double divisions;
  };
  const Case cases[] = {{Element::tet4, "tet4", 1.0},
                        {Element::tet4_edge_smoothed, "tet4_edge_smoothed", 1.0},
                        {Element::tet10, "tet10", 0.5},
                        {Element::hex8, "hex8", 1.8}};
  for (const auto& [element, name, per] : cases) {
    const Costs c = measure(element, std::max(1, static_cast<int>(per * divisions)), repeats);
    std::printf(
        markdown ? "| %s | %d | %.0f | %.2f | %.2f | %.2f |\n" : "%-19s %6d %15.1f %13.2f %11.2f %5.2f\n",
        name, c.cells, 1e3 * c.iteration, c.by_cells / c.iteration, c.by_density / c.iteration,
        c.by_young / c.iteration);
  }
  std::printf(
      markdown
          ? "\n| element | cells | ten steps [ms] | by all cells | with two states | by density | by "
            "Young's modulus |\n|---|---|---|---|---|---|---|\n"
          : "\nelement              cells  ten steps [ms]  by all cells  two states  by density  by E\n");
  for (const auto& [element, name, per] : cases) {
    const WayCosts c = measure_way(element, std::max(1, static_cast<int>(0.6 * per * divisions)), repeats);
    std::printf(markdown ? "| %s | %d | %.0f | %.2f | %.2f | %.2f | %.2f |\n"
                         : "%-19s %6d %15.1f %13.2f %11.2f %11.2f %5.2f\n",
                name, c.cells, 1e3 * c.forward, c.by_cells / c.forward, c.again / c.forward,
                c.by_density / c.forward, c.by_young / c.forward);
  }
  return 0;
}
