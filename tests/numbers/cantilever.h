// The cantilever of the reference values: 0.1 x 0.1 x 1 m along x, E = 266 kPa, gravity along -y.
#pragma once

#include <cmath>

#include "support/worlds.h"

namespace test {

inline constexpr Vec3 kTipFull{-0.7553, -0.9395, 0};   // g = 9.8, nu = 0.5
inline constexpr Vec3 kTipTenth{-0.1381, -0.4763, 0};  // g = 0.98, nu = 0.5

inline Mesh beam(int nx, int ny, int nz) {
  Mesh mesh = box({nx, ny, nz}, {1, 0.1, 0.1});
  for (auto& s : mesh.surfaces) {
    if (s.name == "x0") s.name = "clamped";
  }
  return mesh;
}

struct Cantilever {
  isochor::World world;
  isochor::BodyId body{};

  static isochor::WorldOptions options(double g) {
    isochor::WorldOptions o = static_options();
    o.gravity = {0, -g, 0};
    return o;
  }
  Cantilever(const Mesh& mesh, isochor::Element element, double poisson, double g)
      : world(make_world(options(g))) {
    body = add_body(world, mesh, element, neo_hookean(266e3, poisson), 1070);
    add_volume(world, body);
    hold(world, body, {"clamped"});
  }
  isochor::StepReport one_step() {
    const isochor::StepReport r = world.step(1);
    INFO(r.reason);
    REQUIRE(r.status == isochor::StepStatus::converged);
    return r;
  }
  Vec3 tip() const { return displacement_at(world, body, {1, 0.05, 0.05}); }
  int unknowns() const { return world.size().displacement_unknowns + world.size().multipliers; }
};

}  // namespace test
