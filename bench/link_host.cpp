// A host that bends a beam, with one effect linked that it does not use, or none: what does it cost to have
// it in the program? Built once an effect by bench/CMakeLists.txt, run in pairs by bench/link_cost.sh.
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "isochor/contact.h"
#include "isochor/effects.h"
#include "isochor/generate.h"
#include "isochor/materials.h"
#include "isochor/schemes.h"
#include "isochor/world.h"

using namespace isochor;

namespace {

template <class T>
T need(Result<T> result) {
  if (result) return std::move(result).value();
  std::fprintf(stderr, "%s\n", result.error().c_str());
  std::exit(2);
}

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// The compiler cannot know that nobody calls through these.
#ifdef LINK_DEFINITION
EffectPtr (*volatile kept)(LINK_DEFINITION) = LINK_EFFECT;
bool linked() {
  return kept != nullptr;
}
#elif defined(LINK_ALL)
EffectPtr (*volatile kept_epidermis)(EpidermisDef) = epidermis;
EffectPtr (*volatile kept_membrane)(MembraneDef) = membrane;
EffectPtr (*volatile kept_tie)(TieDef) = tie;
EffectPtr (*volatile kept_cable)(CableDef) = cable;
EffectPtr (*volatile kept_winding)(WindingDef) = winding;
EffectPtr (*volatile kept_layer)(StrainLimitDef) = strain_limit;
EffectPtr (*volatile kept_cavity)(CavityDef) = cavity;
EffectPtr (*volatile kept_damping)(DampingDef) = damping;
EffectPtr (*volatile kept_traction)(TractionDef) = traction;
EffectPtr (*volatile kept_contact)(ContactDef) = contact;
EffectPtr (*volatile kept_rigid)(RigidBodyDef) = rigid_body;
bool linked() {
  return kept_epidermis && kept_membrane && kept_tie && kept_cable && kept_winding && kept_layer &&
         kept_cavity && kept_damping && kept_traction && kept_contact && kept_rigid;
}
#else
bool linked() {
  return true;
}
#endif

}  // namespace

int main() {
  if (!linked()) return 1;
  const double start = processor_seconds();
  WorldOptions options;
  options.scheme = implicit_euler();
  options.threads = 1;
  options.gravity = {0, -9.8, 0};
  World world = need(World::create(options));
  BodyDef body;
  BoxMeshDef box;
  box.upper = {1, 0.1, 0.1};
  box.divisions = {30, 3, 3};
  body.mesh = need(box_mesh(box));
  ElasticConstants rubber;
  rubber.young = 266e3;
  rubber.poisson = 0.5;
  body.materials = {{"", need(neo_hookean(rubber)), 1070}};
  const BodyId beam = need(world.add_body(std::move(body)));
  VolumeDef rows;
  rows.body = beam;
  need(world.add(volume(rows)));
  DirichletDef wall;
  wall.where.body = beam;
  wall.where.surfaces = {"x0"};
  need(world.add(dirichlet(wall)));
  for (int step = 0; step < 12; ++step) {
    const StepReport report = world.advance(1.0 / 60);
    if (report.status != StepStatus::converged) {
      std::fprintf(stderr, "%s\n", report.reason.c_str());
      return 3;
    }
  }
  std::printf("%016llx %.6f\n", static_cast<unsigned long long>(world.state_hash()),
              processor_seconds() - start);
  return 0;
}
