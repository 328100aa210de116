// A fixed sample of the torture suite, each case on ten meshes or starts that differ a little: every one must
// end at a solution, or say that there is none where there is none.
#include "studies/torture.h"

#include <map>
#include <string>

#include "support/worlds.h"

namespace {

using namespace isochor;
using namespace isochor::studies;

struct Sample {
  const char* name;
  TortureSettings settings;
};

TortureSettings settings(double poisson, double step, double load, Element element,
                         Method method = Method::automatic) {
  TortureSettings s;
  s.poisson = poisson;
  s.step = step;
  s.load = load;
  s.element = element;
  s.method = method;
  return s;
}

constexpr Element kEdge = Element::tet4_edge_smoothed, kTet4 = Element::tet4;

void all_solved(const Sample& sample, int repeats = 10, bool at_once = false) {
  const TortureCase* c = find_torture_case(sample.name);
  REQUIRE(c != nullptr);
  for (int k = 0; k < repeats; ++k) {
    TortureSettings s = sample.settings;
    s.seed = static_cast<unsigned>(k + 1);
    const TortureResult r = c->run(s);
    INFO(sample.name << " nu " << s.poisson << " step " << s.step << " load " << s.load << " seed " << s.seed
                     << ": " << to_string(r.verdict) << " " << r.reason << ", iterations " << r.iterations
                     << ", cutbacks " << r.cutbacks << ", shifted " << r.shifted << ", projected "
                     << r.projected << ", rescues " << r.rescues << ", min J " << r.min_J
                     << ", volume row residual " << r.volume_row_residual);
    CHECK(r.verdict == TortureVerdict::solved);
    CHECK(r.rescues == 0);
    if (at_once) CHECK(r.cutbacks == 0);
  }
}

}  // namespace

TEST_CASE("large deformations in one load step at nu 0.5") {
  all_solved({"cantilever", settings(0.5, 0, 1, kEdge)});
  all_solved({"cantilever", settings(0.5, 0, 10, kTet4)});
  all_solved({"twist", settings(0.5, 0, 1, kEdge)});
  all_solved({"stretch", settings(0.5, 0, 1, kEdge)});
  all_solved({"compression", settings(0.5, 0, 0.6, kTet4)});
  all_solved({"puck", settings(0.5, 0, 0.6, kTet4)});
}

TEST_CASE("long prescribed ways are made within one increment at nu 0.5") {
  all_solved({"stretch", settings(0.5, 0, 1, Element::tet10)}, 2, true);
  all_solved({"stretch", settings(0.5, 0, 1, kEdge)}, 5, true);
  all_solved({"compression", settings(0.5, 0, 1, kTet4)}, 5, true);
  all_solved({"compression", settings(0.5, 0, 1, kEdge)}, 3, true);
  all_solved({"compression", settings(0.5, 0, 1, kEdge, Method::dual_gradients)}, 1, true);
}

TEST_CASE("a body in motion gets past a fold without shorter increments at nu 0.5") {
  all_solved({"compression", settings(0.5, 0.033, 1, Element::tet10)}, 1, true);
}

TEST_CASE("stiff parts turn within one increment at nu 0.5") {
  all_solved({"stiffness_jump", settings(0.5, 0, 3, kEdge)}, 4, true);
  // Three of eight random meshes take this load at once, the others in two or three increments.
  all_solved({"stiffness_jump", settings(0.5, 0, 10, kEdge)}, 2);
  all_solved({"stiffness_jump", settings(0.5, 0, 3, Element::tet10)}, 1, true);
}

TEST_CASE("balls bounce without a node below the floor and without energy from nowhere") {
  for (const Element element : {kTet4, kEdge, Element::tet10})
    all_solved({"ball", settings(0.5, 8e-3, 1, element)}, 1);
  all_solved({"ball", settings(0.5, 1e-3, 1, kEdge)}, 1);
}

TEST_CASE("a bar swings undamped for a thousand steps without a pattern from node to node") {
  for (const Element element : {kTet4, kEdge}) all_solved({"swing", settings(0.5, 1e-3, 1, element)}, 1);
}

TEST_CASE("time steps from a tenth of a millisecond to a tenth of a second") {
  for (const double step : {1e-4, 1e-3, 8e-3, 33e-3, 0.1}) {
    all_solved({"cantilever", settings(0.5, step, 1, kEdge)}, 3);
    all_solved({"standing", settings(0.5, step, 1, kTet4)}, 2);
    all_solved({"drop", settings(0.5, step, 1, kTet4)}, 2);
  }
}

TEST_CASE("ends that move within short steps") {
  for (const double step : {1e-4, 1e-3}) {
    all_solved({"stretch", settings(0.5, step, 1, kEdge)}, 2);
    all_solved({"twist", settings(0.4999, step, 1, kTet4)}, 2);
    all_solved({"puck", settings(0.49, step, 1, kTet4)}, 1);
  }
}

TEST_CASE("incompressibility from nearly to fully") {
  for (const double poisson : {0.45, 0.49, 0.499, 0.4999, 0.5}) {
    all_solved({"twist", settings(poisson, 0.033, 1, kTet4)}, 2);
    all_solved({"slivers", settings(poisson, 0, 1, kEdge)}, 2);
    all_solved({"graded", settings(poisson, 0, 1, kTet4)}, 2);
    all_solved({"stiffness_jump", settings(poisson, 0, 1, kEdge)}, 2);
  }
}

TEST_CASE("other methods on the same cases") {
  for (const Method method :
       {Method::dual_gradients, Method::augmented_gradients, Method::augmented_ascent}) {
    all_solved({"cantilever", settings(0.5, 0.033, 1, kTet4, method)}, 2);
    all_solved({"stretch", settings(0.499, 0.033, 1, kTet4, method)}, 2);
  }
}

TEST_CASE("crushed and mirrored starts come back") {
  all_solved({"crushed", settings(0.49, 0, 1, kTet4)});
  all_solved({"mirrored", settings(0.49, 0, 1, kTet4)});
  all_solved({"scrambled", settings(0.49, 0, 1, kTet4)}, 3);
  all_solved({"crushed", settings(0.5, 0, 1, kEdge)});
  all_solved({"mirrored", settings(0.5, 0, 1, kEdge)});
}

TEST_CASE("nothing moves at rest, bad loads are refused, a free body keeps its momentum") {
  for (const Element element : {kTet4, kEdge, Element::tet10, Element::hex8}) {
    all_solved({"at_rest", settings(0.5, 0, 1, element)}, 1);
    all_solved({"at_rest", settings(0.5, 0.01, 1, element)}, 1);
    all_solved({"poisoned", settings(0.5, 0.01, 1, element)}, 1);
  }
  all_solved({"spin", settings(0.5, 0.005, 1, kEdge)}, 1);
}

TEST_CASE("what has no equilibrium is told") {
  for (const char* name : {"sphere"}) {
    const TortureResult r = find_torture_case(name)->run(settings(0.5, 0, 2, kTet4));
    INFO(r.reason);
    CHECK(r.verdict == TortureVerdict::told);
    CHECK(r.reason.find("no equilibrium") != std::string::npos);
    CHECK(r.reached > 0.2);
  }
  TortureSettings locked = settings(0.5, 0, 1, kTet4);
  locked.one_field = true;
  const TortureResult r = find_torture_case("cantilever")->run(locked);
  CHECK(r.verdict == TortureVerdict::told);
  CHECK(r.reason.find("0.5") != std::string::npos);
}
