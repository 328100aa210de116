// Cubes that are twisted, scrambled and crushed (Smith, de Goes & Kim 2018, section 6). Shared by the study,
// which runs all seeds, and the tests, which run a few.
#pragma once

#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/schemes.h>
#include <isochor/world.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "must.h"

namespace robustness {

using namespace isochor;
using bench::must;

// A number in [0, 1) made by hand, so that every standard library draws the same.
inline double draw(std::mt19937& random) {
  return static_cast<double>(random()) / 4294967296.0;
}

// How the cube is made and solved. Stable neo-Hookean throughout: it has a value for inverted elements.
struct Formulation {
  std::string name;
  Element element = Element::hex8;
  double poisson = 0.49;
  bool rows = false;  // volume rows carry the bulk modulus; else the complete one-field energy
  VolumeSpace space = VolumeSpace::node;
  Definiteness definiteness = Definiteness::exact;
};

inline Mesh unit_cube(Element element, int divisions) {
  const CellType cells = element == Element::hex8 ? CellType::hex8 : CellType::tet4;
  Mesh mesh = must(box_mesh({{0, 0, 0}, {1, 1, 1}, {divisions, divisions, divisions}, cells}));
  return mesh;
}

struct Cube {
  World world;
  BodyId body{};

  Cube(const Formulation& f, int divisions, int max_iterations, bool absolute_tolerance = false)
      : world(must(World::create(options(f, max_iterations, absolute_tolerance)))) {
    BodyDef def;
    def.mesh = unit_cube(f.element, divisions);
    def.element = f.element;
    def.guard_stiffness = 0;  // a barrier has no value for inverted tets
    ElasticConstants constants;
    constants.young = 1;
    constants.poisson = f.poisson;
    def.materials = {{"", must(stable_neo_hookean(constants)), 1}};
    body = must(world.add_body(def));
    if (f.rows) {
      VolumeDef volume_def;
      volume_def.body = body;
      volume_def.space = f.space;
      must(world.add(volume(volume_def)));
    }
  }

  static WorldOptions options(const Formulation& f, int max_iterations, bool loose) {
    WorldOptions o;
    o.scheme = statics();
    o.definiteness = f.definiteness;
    o.threads = 1;
    o.max_iterations = max_iterations;
    if (loose) o.force_tolerance = 1e-6;
    return o;
  }

  // Four corners that no plane holds.
  void pin_corners() {
    DirichletDef pins;
    pins.name = "pins";
    pins.where.body = body;
    pins.where.nearest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    must(world.add(dirichlet(pins)));
  }

  // Largest distance of a node from its rest position, over the edge of the cube.
  double off_rest() const {
    double worst = 0;
    const auto x = world.positions(body), rest = world.rest_positions(body);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 d = x[i] - rest[i];
      worst = std::max(worst, std::sqrt(dot(d, d)));
    }
    return worst;
  }
};

// Every node anywhere in a cube of twice the volume around the same center.
inline std::vector<Vec3> scrambled(std::span<const Vec3> rest, unsigned seed) {
  std::mt19937 random(seed);
  const double half = 0.5 * std::cbrt(2.0);
  const auto place = [&] { return 0.5 + half * (2 * draw(random) - 1); };
  std::vector<Vec3> x(rest.size());
  for (Vec3& p : x) {
    for (int k = 0; k < 3; ++k) p[k] = place();
  }
  return x;
}

enum class Crushed { plane, line, point, mirrored };
inline constexpr Crushed kCrushed[] = {Crushed::plane, Crushed::line, Crushed::point, Crushed::mirrored};
inline const char* name_of(Crushed c) {
  constexpr const char* names[] = {"plane", "line", "point", "mirrored"};
  return names[static_cast<int>(c)];
}

// All nodes in a plane, on a line, in a point, or mirrored at a plane; with a seed the plane or line is
// turned at random, seed 0 is along the axes.
inline std::vector<Vec3> crushed(std::span<const Vec3> rest, Crushed how, unsigned seed) {
  std::mt19937 random(seed);
  Vec3 n{0, 0, 1};
  if (seed > 0) {
    for (int k = 0; k < 3; ++k) n[k] = draw(random) - 0.5;
    n = (1 / std::sqrt(dot(n, n))) * n;
  }
  const Vec3 center{0.5, 0.5, 0.5};
  std::vector<Vec3> x(rest.begin(), rest.end());
  for (Vec3& p : x) {
    const Vec3 d = p - center;
    switch (how) {
      case Crushed::plane:
        p = center + d - dot(d, n) * n;
        break;
      case Crushed::line:
        p = center + dot(d, n) * n;
        break;
      case Crushed::point:
        p = center;
        break;
      case Crushed::mirrored:
        p = center + d - 2 * dot(d, n) * n;
        break;
    }
  }
  return x;
}

struct Outcome {
  StepReport report;
  double off_rest = 0;
  // No force is left: at rest, or folded into another place where nothing moves it.
  bool converged() const { return report.status == StepStatus::converged; }
  bool recovered() const { return converged() && off_rest < 1e-5; }
};

template <class Start>
Outcome recover_from(const Formulation& f, int divisions, int max_iterations, const Start& start) {
  Cube cube(f, divisions, max_iterations);
  cube.pin_corners();
  must(cube.world.set_positions(cube.body, start(cube.world.rest_positions(cube.body))));
  Outcome o;
  o.report = cube.world.step(1);
  o.off_rest = cube.off_rest();
  return o;
}

struct Twist {
  std::vector<StepReport> solves;
  std::vector<std::vector<double>> residuals;  // of force, after each iteration of each solve
  BodyMeasures measures;
};

// One face held, the opposite one turned about its normal by pi/2, twice.
inline Twist twist(const Formulation& f, int divisions, int max_iterations) {
  Cube cube(f, divisions, max_iterations, true);
  DirichletDef held;
  held.name = "held";
  held.where.body = cube.body;
  held.where.surfaces = {"z0"};
  must(cube.world.add(dirichlet(held)));
  DirichletDef turned;
  turned.name = "turned";
  turned.where.body = cube.body;
  turned.where.surfaces = {"z1"};
  turned.axis_point = {0.5, 0.5, 0};
  turned.axis = {0, 0, 1};
  turned.angle = std::numbers::pi;
  turned.amount = Curve::ramp(1, 2);
  must(cube.world.add(dirichlet(turned)));
  Twist t;
  cube.world.on_progress([&](const ProgressInfo& p) { t.residuals.back().push_back(p.force_residual); });
  for (int solve = 0; solve < 2; ++solve) {
    t.residuals.emplace_back();
    t.solves.push_back(cube.world.step(1));
    if (t.solves.back().status != StepStatus::converged) break;
  }
  t.measures = cube.world.measures(cube.body);
  return t;
}

}  // namespace robustness
