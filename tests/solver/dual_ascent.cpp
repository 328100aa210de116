// How fast dual ascent brings the volume back: the experiment of Francu et al. 2021, figure 8, on our bubble.
#include "engine/solve/dual_ascent.h"

#include <cmath>

#include "support/compiled.h"
#include "support/worlds.h"

namespace {

using namespace isochor;
using namespace test;

struct Climb {
  int most = 0;  // dual steps until `level` of volume error, the largest number of all load steps
  int all = 0;   // of all load steps together
  SaddleStatus status = SaddleStatus::converged;
};

// `load_steps` to 4 kPa. `moderate`: a complete material with Poisson's ratio 0.4 under hard rows, as in
// the paper; otherwise a distortional one whose rows are augmented.
Climb inflate(bool moderate, DualAscentOptions ascent, int load_steps = 10, double level = 0.01) {
  BodyDef body;
  body.mesh = scene_mesh("bubble");
  body.element = Element::tet4;
  body.materials = {{"", neo_hookean(100e3, moderate ? 0.4 : 0.5), 1070}};
  VolumeDef rows;
  rows.hard = true;
  rows.carries_bulk = !moderate;
  DirichletDef base;
  base.where.surfaces = {"clamped"};
  CavityDef chamber;
  chamber.surfaces = {"chamber"};
  chamber.amount = Curve::ramp(4000);
  const Compiled c = compile({body}, {volume(rows), dirichlet(base), cavity(chamber)}, true,
                             ascent.augmented ? RowTreatment::augmented : RowTreatment::dual);
  INFO(c.error);
  REQUIRE(c.system);
  const System& s = *c.system;
  double volume = 0;
  for (const double v : s.row_measure()) volume += v;
  TbbParallel parallel(1);
  DualAscent method(c.system, parallel, make_linear_solver(Solver::automatic), ascent);
  std::vector<Vec3> x = s.parts().rest;
  std::vector<double> lambda(at(s.rows()), 0.0), phi(at(s.rows()));
  ProblemData data(s);
  Climb out;
  for (int step = 1; step <= load_steps; ++step) {
    data.at_time(s, static_cast<double>(step) / load_steps);
    int steps = 0;
    bool close = false;
    method.progress = [&](int k, double, double) {
      method.assembly().row_values(phi);
      double error = 0;
      for (const double p : phi) error += std::abs(p);
      if (!close) steps = k;
      close = close || error < level * volume;
    };
    method.set_interrupt([&] { return close; });
    const SaddleReport r = method.solve(data.problem(), {}, x, lambda);
    if (r.status != SaddleStatus::cancelled) out.status = r.status;
    out.most = std::max(out.most, steps);
    out.all += steps;
  }
  return out;
}

}  // namespace

TEST_CASE("conjugate directions need fewer steps than steepest ones") {
  // The whole pressure at once, where the steepest ascent has some way to go.
  for (const bool moderate : {true, false}) {
    DualAscentOptions steepest{.augmented = !moderate, .scaled = !moderate}, conjugate = steepest;
    conjugate.conjugate = true;
    for (const double level : {1e-2, 1e-4}) {
      const Climb a = inflate(moderate, steepest, 1, level), b = inflate(moderate, conjugate, 1, level);
      INFO((moderate ? "moderate Poisson's ratio" : "augmented rows")
           << ", volume error " << level << ": steepest " << a.most << ", conjugate " << b.most);
      CHECK(b.status == SaddleStatus::converged);
      CHECK(b.most <= a.most);
      if (moderate || level < 1e-2) CHECK(b.most < a.most);
    }
  }
}

TEST_CASE("dual ascent reaches one percent of volume error within six steps") {
  const Climb paper = inflate(true, {.augmented = false, .scaled = false});
  const Climb ours = inflate(false, {.augmented = true, .scaled = true});
  INFO("moderate Poisson's ratio " << paper.most << ", augmented rows " << ours.most);
  CHECK(paper.status == SaddleStatus::converged);
  CHECK(ours.status == SaddleStatus::converged);
  CHECK(paper.most <= 6);
  CHECK(ours.most <= 6);
}
