// Scenes of contact that several tests start from.
#pragma once

#include "engine/solve/newton/unsymmetric_newton.h"
#include "isochor/contact.h"
#include "support/compiled.h"
#include "support/worlds.h"

namespace test {

// A ball of radius 0.12 m that comes down on z = 0.1 m by `depth` and is dragged along x, from time 0 to 1.
inline isochor::ContactDef dragging_ball(const Vec3& position, double depth, double friction) {
  isochor::ContactDef tool;
  tool.surfaces = {"z1"};
  tool.friction = friction;
  tool.obstacle.shape = isochor::ObstacleShape::sphere;
  tool.obstacle.radius = 0.12;
  tool.obstacle.position = position;
  tool.obstacle.motion.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {0.012, 0, -depth}, {1, 0, 0, 0}}};
  return tool;
}

// Incompressible rubber under such a tool, held from below.
inline Compiled rubber_under(const isochor::ContactDef& tool, const Mesh& mesh, double poisson = 0.5) {
  isochor::BodyDef def;
  def.mesh = mesh;
  def.materials = {{"", neo_hookean(1e5, poisson), 1000}};
  isochor::DirichletDef clamp;
  clamp.where.surfaces = {"z0"};
  Compiled scene =
      compile({def}, {isochor::volume({}), isochor::dirichlet(clamp), isochor::contact(tool)}, true);
  INFO(scene.error);
  REQUIRE(scene.system);
  return scene;
}
inline Compiled rubber_under_ball(double compliance, double friction, isochor::FrictionCoupling coupling) {
  isochor::ContactDef tool = dragging_ball({0.003, 0.002, 0.22}, 0.01, friction);
  tool.compliance = compliance;
  tool.coupling = coupling;
  return rubber_under(tool, block({-0.1, -0.1, 0}, {0.1, 0.1, 0.1}, {5, 5, 3}));
}

// What a world would take for the scene.
inline std::unique_ptr<isochor::SaddlePoint> newton_of(const Compiled& scene,
                                                       const isochor::Parallel& parallel) {
  using namespace isochor;
  auto solver = make_linear_solver(Solver::automatic);
  if (!scene.system->couples()) return std::make_unique<Newton>(scene.system, parallel, std::move(solver));
  return std::make_unique<UnsymmetricNewton>(scene.system, parallel, std::move(solver),
                                             make_unsymmetric_solver(Solver::automatic));
}

}  // namespace test
