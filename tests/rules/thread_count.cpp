// Rule: one answer at any thread count, to the last bit.
#ifndef ISOCHOR_WITHOUT_TBB
#include <tbb/global_control.h>
#endif

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

// Hashes after every step of a scene with everything in it: two regions, chamber, gravity, supports,
// traction.
std::vector<std::uint64_t> hashes(Element element, SchemePtr scheme, int threads, double h) {
  WorldOptions options;
  options.scheme = std::move(scheme);
  options.threads = threads;
  options.gravity = {0, 0, -9.8};
  World world = make_world(options);
  // Enough cells that every loop has several chunks.
  const int n = element == Element::tet10 ? 3 : 6;
  Mesh mesh =
      without_cells(box({n, n, n}, {0.1, 0.1, 0.1}), {0.03, 0.03, 0.03}, {0.068, 0.068, 0.068}, "chamber");
  mesh = divided(std::move(mesh), 0.05);
  BodyDef def;
  def.mesh = mesh;
  def.element = element;
  def.materials = {{"low", neo_hookean(5e4, 0.5), 1000}, {"high", neo_hookean(1e5, 0.49), 1200}};
  const BodyId body = value(world.add_body(def));
  add_volume(world, body);
  hold(world, body, {"z0"});
  CavityDef chamber;
  chamber.surfaces = {"chamber"};
  chamber.amount = Curve::ramp(2000, 0.1);
  value(world.add(cavity(chamber)));
  TractionDef push;
  push.surface = "z1";
  push.traction = {300, 0, 0};
  value(world.add(traction(push)));
  std::vector<std::uint64_t> out;
  for (int step = 0; step < 3; ++step) {
    const StepReport r = world.step(h);
    INFO(r.reason);
    REQUIRE(r.status == StepStatus::converged);
    out.push_back(world.state_hash());
  }
  return out;
}

}  // namespace

TEST_CASE("the same bits at 1, 2, 4 and 8 threads") {
#ifndef ISOCHOR_WITHOUT_TBB
  // Eight real threads on a machine with fewer processors too.
  const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 8);
#endif
  for (const Element element : kElements) {
    for (const bool dynamic : {true, false}) {
      INFO(name_of(element) << (dynamic ? ", dynamic" : ", static"));
      const auto scheme = dynamic ? implicit_euler() : statics();
      const auto one = hashes(element, scheme, 1, 0.02);
      CHECK(one[0] != one[1]);
      for (const int threads : {2, 4, 8}) CHECK(hashes(element, scheme, threads, 0.02) == one);
    }
  }
}

TEST_CASE("the same world twice gives the same bits") {
  CHECK(hashes(Element::tet4, implicit_euler(), 0, 0.02) == hashes(Element::tet4, implicit_euler(), 0, 0.02));
}
