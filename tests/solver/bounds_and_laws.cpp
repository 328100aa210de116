// Rows with bounds on their multipliers and rows with a law of their own, through effects written here: what
// the stepper offers to any effect.
#include <cmath>
#include <numeric>

#include "engine/scene/builder.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

// One stencil a node: its coordinate along z above a height [m].
class HeightPool final : public StencilPool {
 public:
  HeightPool(std::span<const Index> nodes, double height) : height_(height) {
    for (const Index n : nodes) nodes_.push(std::span(&n, 1));
    finish_topology();
  }
  std::string_view name() const override { return "height"; }
  StencilShape shape() const override { return {.functions = 1}; }
  bool sees_rigid_motion() const override { return true; }
  void evaluate(const StencilRequest& q, const StencilSlots& slots) const override {
    for (Index s = q.begin; s < q.end; ++s) {
      slots.value[at(s)] = q.x[at(nodes_[s][0])].z - height_;
      if (q.want == Want::value) continue;
      slots.gradient[at(s)] = {0, 0, q.function_multiplier[at(s)]};
      slots.jacobian[at(s)] = {0, 0, 1};
      if (q.want == Want::hessian) slots.hessian[static_cast<std::size_t>(hessian_offset()[at(s)])] = Mat3{};
    }
  }

 private:
  double height_;
};

constexpr double kScale = 1e-3, kForce = 0.8;  // of the law: c(lambda) = kScale sinh(lambda / kForce)

struct HeightRows final : RowPool, LawRows, RememberingRows {
  bool with_law = false;
  std::string_view name() const override { return "height"; }
  RowFacets facets() const override {
    if (!with_law) return {};
    return {.law = this, .remembering = this};
  }
  double evaluate_law(const RowIncrement&, std::span<const double> lambda, std::span<double> strain,
                      std::span<double> tangent) const override {
    double potential = 0;
    for (std::size_t r = 0; r < lambda.size(); ++r) {
      strain[r] = kScale * std::sinh(lambda[r] / kForce);
      potential += kScale * kForce * (std::cosh(lambda[r] / kForce) - 1);
    }
    for (std::size_t r = 0; r < tangent.size(); ++r) {
      tangent[r] = kScale / kForce * std::cosh(lambda[r] / kForce);
    }
    return potential;
  }
  int memory() const override { return 1; }
  void start(std::span<double> memory) const override { memory[0] = 7; }
  void accept(const RowIncrement& increment, std::span<const double>,
              std::span<double> memory) const override {
    memory[0] = increment.memory[0] + (increment.t1 - increment.t0);
  }
};

enum class Kind { floor, spring };

class HeightEffect final : public EffectSource {
 public:
  HeightEffect(Kind kind, BodyId body, std::vector<std::string> surfaces, double height, double compliance)
      : kind_(kind), body_(body), surfaces_(std::move(surfaces)), height_(height), compliance_(compliance) {}
  const std::string& name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(kind_, body_, surfaces_, height_, compliance_); }
  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    Selection where;
    where.body = body_;
    where.surfaces = surfaces_;
    auto nodes = builder.select(where, name_);
    if (!nodes) return Error{nodes.error()};
    auto rows = std::make_shared<HeightRows>();
    rows->with_law = kind_ == Kind::spring;
    rows->stencil_pool = builder.add_stencils(std::make_shared<HeightPool>(nodes.value(), height_));
    const auto count = static_cast<Index>(nodes.value().size());
    for (Index r = 0; r < count; ++r) {
      rows->map.push(std::span(&r, 1));
      rows->weight.push_back(1);
      rows->metric.push_back(1e-3);
      rows->measure.push_back(1);
      if (compliance_ > 0 || kind_ == Kind::spring) rows->compliance.push_back({r, r, compliance_});
    }
    if (kind_ == Kind::floor) rows->upper.assign(at(count), 0.0);
    if (kind_ == Kind::floor) rows->lower.assign(at(count), -std::numeric_limits<double>::infinity());
    builder.add_rows(rows);
    return std::make_unique<EffectInstance>();
  }

 private:
  std::string name_ = "height";
  Kind kind_;
  BodyId body_;
  std::vector<std::string> surfaces_;
  double height_, compliance_;
};

struct Fixture {
  World world;
  BodyId body;
};

Mesh box(const Vec3& size, std::array<int, 3> cells) {
  BoxMeshDef def;
  def.upper = size;
  def.divisions = cells;
  return test::value(box_mesh(def));
}

// A soft block that is held against sliding and falls on what the effect provides.
Fixture block(Kind kind, double height, double compliance, double poisson = 0.5) {
  WorldOptions options = test::static_options();
  options.gravity = {0, 0, -9.81};
  Fixture f{test::make_world(options), {}};
  f.body = test::add_body(f.world, box({0.2, 0.1, 0.1}, {4, 2, 2}), Element::tet4_edge_smoothed,
                          test::neo_hookean(20e3, poisson));
  test::add_volume(f.world, f.body);
  test::hold(f.world, f.body, {"x0"}, {{1, 0, 0}});
  test::hold(f.world, f.body, {"y0"}, {{0, 1, 0}});
  test::value(f.world.add(
      std::make_shared<HeightEffect>(kind, f.body, std::vector<std::string>{"z0"}, height, compliance)));
  return f;
}

constexpr double kWeight = 0.2 * 0.1 * 0.1 * 1000 * 9.81;

}  // namespace

TEST_CASE("a block rests on bounded rows that only push") {
  for (const double compliance : {0.0, 1e-4}) {
    INFO("compliance " << compliance);
    Fixture f = block(Kind::floor, 0, compliance);
    // Rows without a hold along z: statics must take the floor as what carries the block.
    const StepReport report = f.world.step(1);
    INFO(report.reason);
    REQUIRE(report.status == StepStatus::converged);
    CHECK(report.iterations <= 10);
    double lowest = 1;
    for (const Vec3& x : f.world.positions(f.body)) lowest = std::min(lowest, x.z);
    if (compliance == 0)
      CHECK(std::abs(lowest) < 1e-9);
    else
      CHECK(lowest < -1e-6);
  }
}

TEST_CASE("bounded rows let go where they would pull") {
  // Clamped at x0 and too high for the floor to reach: the tip sags until the floor carries it, the rest
  // stays clear of it.
  WorldOptions options = test::static_options();
  options.gravity = {0, 0, -9.81};
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, box({0.4, 0.05, 0.05}, {16, 2, 2}), Element::tet4_edge_smoothed,
                                     test::neo_hookean(50e3, 0.5));
  test::add_volume(world, body);
  test::hold(world, body, {"x0"});
  test::value(world.add(
      std::make_shared<HeightEffect>(Kind::floor, body, std::vector<std::string>{"z0"}, -0.05, 0.0)));
  const StepReport report = test::must_advance(world);
  CHECK(report.iterations <= 25);
  int touching = 0, clear = 0;
  const auto rest = world.rest_positions(body);
  const auto x = world.positions(body);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (rest[i].z > 1e-9) continue;
    CHECK(x[i].z >= -0.05 - 1e-9);
    if (x[i].z < -0.05 + 1e-9) ++touching;
    if (x[i].z > -0.04) ++clear;
  }
  CHECK(touching >= 3);
  CHECK(clear >= 3);
  CHECK(world.constitutive_residual() < 1e-9);
}

TEST_CASE("a law takes the place of the compliance, quadratically convergent") {
  Fixture f = block(Kind::spring, 0, 0);
  const StepReport report = test::must_advance(f.world);
  CHECK(report.iterations <= 9);
  // The law gives each node's force from its height: together they carry the weight.
  double sum = 0;
  const auto rest = f.world.rest_positions(f.body);
  const auto x = f.world.positions(f.body);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (rest[i].z < 1e-9) sum += kForce * std::asinh(x[i].z / kScale);
  }
  CHECK(sum == Approx(-kWeight).epsilon(1e-8));
}

TEST_CASE("what a pool keeps is part of the state") {
  Fixture a = block(Kind::spring, 0, 0), b = block(Kind::spring, 0, 0);
  test::must_advance(a.world, 0.5);
  const auto saved = a.world.save();
  REQUIRE(b.world.load(saved));
  CHECK(a.world.state_hash() == b.world.state_hash());
  test::must_advance(a.world, 0.5);
  CHECK(a.world.state_hash() != b.world.state_hash());
  test::must_advance(b.world, 0.5);
  CHECK(a.world.state_hash() == b.world.state_hash());
}
