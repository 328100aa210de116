// A host that names no chamber: nothing of it may be linked in.
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/schemes.h>
#include <isochor/world.h>

#include <cstdio>

int main() {
  isochor::WorldOptions options;
  options.scheme = isochor::statics();
  options.gravity = {0, 0, -9.8};
  auto world = isochor::World::create(options);
  isochor::ElasticConstants rubber;
  rubber.young = 1e5;
  rubber.poisson = 0.5;
  isochor::BodyDef def;
  def.mesh = isochor::box_mesh({{0, 0, 0}, {0.1, 0.1, 0.1}, {2, 2, 2}}).value();
  def.materials = {{"", isochor::neo_hookean(rubber).value(), 1000}};
  const auto body = world.value().add_body(def);
  if (!body || !world.value().add(isochor::volume({}))) return 1;
  isochor::DirichletDef floor;
  floor.where.surfaces = {"z0"};
  if (!world.value().add(isochor::dirichlet(floor))) return 1;
  const auto report = world.value().advance(1);
  std::printf("%s, top at %.6f m\n", report.reason.empty() ? "converged" : report.reason.c_str(),
              world.value().positions(body.value())[26].z);
  return report.status == isochor::StepStatus::converged ? 0 : 1;
}
