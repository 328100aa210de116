// A row kept in the saddle point, condensed into the stiffness or bordered around it: one answer.
#include <cmath>
#include <string>

#include "support/worlds.h"

namespace {

using namespace isochor;

struct Outcome {
  StepReport report;
  std::vector<Vec3> x;
  WorldSize size;
};

Mesh beam() {
  BoxMeshDef def;
  def.upper = {0.4, 0.1, 0.1};
  def.divisions = {8, 2, 2};
  return test::value(box_mesh(def));
}

// A beam that bends under its weight; `zone` adds a row over all of it.
Outcome bend(VolumeDef rows, double poisson, bool zone, RowTreatment zone_treatment,
             double compliance_of_zone = 0) {
  WorldOptions options = test::static_options();
  options.gravity = {0, 0, -9.81};
  World world = test::make_world(options);
  const BodyId body =
      test::add_body(world, beam(), Element::tet4_edge_smoothed, test::neo_hookean(30e3, poisson));
  rows.body = body;
  test::value(world.add(volume(rows)));
  if (zone) {
    VolumeDef whole;
    whole.name = "whole";
    whole.body = body;
    whole.space = VolumeSpace::body;
    whole.hard = compliance_of_zone == 0;
    whole.carries_bulk = false;
    whole.treatment = zone_treatment;
    test::value(world.add(volume(whole)));
  }
  test::hold(world, body, {"x0"});
  Outcome out;
  out.report = world.advance(1);
  out.x.assign(world.positions(body).begin(), world.positions(body).end());
  out.size = world.size();
  return out;
}

double distance(const Outcome& a, const Outcome& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const Vec3 d = a.x[i] - b.x[i];
    most = std::max(most, std::sqrt(dot(d, d)));
  }
  return most;
}

VolumeDef per_element(RowTreatment treatment) {
  VolumeDef def;
  def.space = VolumeSpace::element;
  def.treatment = treatment;
  return def;
}

}  // namespace

TEST_CASE("element rows give one answer kept and condensed") {
  for (const double poisson : {0.3, 0.45, 0.4999}) {
    INFO("nu = " << poisson);
    const Outcome kept = bend(per_element(RowTreatment::saddle), poisson, false, {});
    const Outcome condensed = bend(per_element(RowTreatment::condensed), poisson, false, {});
    REQUIRE(kept.report.status == StepStatus::converged);
    REQUIRE(condensed.report.status == StepStatus::converged);
    CHECK(distance(kept, condensed) < 1e-9);
    CHECK(kept.report.iterations == condensed.report.iterations);
    CHECK(kept.report.negative_pivots == kept.report.expected_negative_pivots);
    CHECK(condensed.report.negative_pivots == condensed.report.expected_negative_pivots);
    CHECK(condensed.size.matrix_nonzeros < kept.size.matrix_nonzeros);
  }
}

TEST_CASE("lumped nodal rows give one answer kept and condensed, and another than consistent ones") {
  VolumeDef def;
  def.lumped_compliance = true;
  def.treatment = RowTreatment::saddle;
  const Outcome kept = bend(def, 0.45, false, {});
  def.treatment = RowTreatment::condensed;
  const Outcome condensed = bend(def, 0.45, false, {});
  const Outcome consistent = bend({}, 0.45, false, {});
  REQUIRE(kept.report.status == StepStatus::converged);
  REQUIRE(condensed.report.status == StepStatus::converged);
  CHECK(distance(kept, condensed) < 1e-9);
  CHECK(distance(kept, consistent) > 1e-6);
}

TEST_CASE("a row over a whole body gives one answer kept and bordered") {
  for (const double poisson : {0.3, 0.45}) {
    for (const RowTreatment local : {RowTreatment::saddle, RowTreatment::condensed}) {
      const Outcome kept = bend(per_element(local), poisson, true, RowTreatment::saddle);
      const Outcome bordered = bend(per_element(local), poisson, true, RowTreatment::bordered);
      INFO("nu = " << poisson << ", local rows " << (local == RowTreatment::saddle ? "kept" : "condensed"));
      INFO(kept.report.reason << bordered.report.reason);
      REQUIRE(kept.report.status == StepStatus::converged);
      REQUIRE(bordered.report.status == StepStatus::converged);
      CHECK(distance(kept, bordered) < 1e-9);
      CHECK(bordered.report.negative_pivots == bordered.report.expected_negative_pivots);
      CHECK(bordered.size.matrix_nonzeros < kept.size.matrix_nonzeros);
    }
  }
}

TEST_CASE("a compliant row over a whole body may be bordered too") {
  const Outcome kept = bend(per_element(RowTreatment::condensed), 0.4, true, RowTreatment::saddle, 1);
  const Outcome bordered = bend(per_element(RowTreatment::condensed), 0.4, true, RowTreatment::bordered, 1);
  REQUIRE(bordered.report.status == StepStatus::converged);
  CHECK(distance(kept, bordered) < 1e-9);
}

TEST_CASE("a treatment that cannot be is refused with the reason") {
  const Outcome hard = bend(per_element(RowTreatment::condensed), 0.5, false, {});
  CHECK(hard.report.status == StepStatus::invalid);
  CHECK(hard.report.reason.find("hard") != std::string::npos);
  VolumeDef nodal;
  nodal.treatment = RowTreatment::condensed;
  const Outcome coupled = bend(nodal, 0.45, false, {});
  CHECK(coupled.report.status == StepStatus::invalid);
  CHECK(coupled.report.reason.find("lumped") != std::string::npos);
  const Outcome many = bend(per_element(RowTreatment::bordered), 0.45, false, {});
  CHECK(many.report.status == StepStatus::invalid);
  CHECK(many.report.reason.find("saddle") != std::string::npos);
}
