// `isochor drive --horizon`: amounts of all times together.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "catch.h"
#include "scenes/run/run.h"
#include "scenes/scene_file.h"
#include "studies/drive/horizon.h"
#include "studies/drive/limited.h"
#include "studies/drive/report.h"
#include "support/worlds.h"

using namespace isochor;
using namespace isochor::drive;
using Catch::Matchers::Contains;
using Catch::Matchers::WithinAbs;
using test::value;

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
constexpr double none = std::numeric_limits<double>::infinity();

// How far a point is from being the minimum of |A u - b|^2 / 2 within lower <= C u <= upper, over the size of
// the gradient: what is left of the gradient when rows near their limits may push inward, what these pushes
// times their slacks leave open of the minimum, and what is beyond.
struct Optimality {
  double gradient = 0, beyond = 0, wrong_way = 0, gap = 0;
};
Optimality optimality(const Matrix& A, const Vector& b, const Matrix& C, const Vector& lower,
                      const Vector& upper, const Vector& u) {
  Optimality out;
  const Vector row = C * u, g = A.transpose() * (A * u - b);
  const double size = (A.cwiseAbs().transpose() * ((A * u).cwiseAbs() + b.cwiseAbs())).maxCoeff();
  constexpr double near = 1e-5;
  std::vector<Eigen::Index> held;
  for (Eigen::Index i = 0; i < row.size(); ++i) {
    out.beyond = std::max({out.beyond, lower[i] - row[i], row[i] - upper[i]});
    if (row[i] - lower[i] < near || upper[i] - row[i] < near) held.push_back(i);
  }
  Matrix normals(u.size(), static_cast<Eigen::Index>(held.size()));
  for (std::size_t k = 0; k < held.size(); ++k) {
    const double outward = upper[held[k]] - row[held[k]] < near ? 1 : -1;
    normals.col(static_cast<Eigen::Index>(k)) = outward * C.row(held[k]).transpose();
  }
  Vector rest = g;
  if (!held.empty()) {
    const Vector push = normals.colPivHouseholderQr().solve(-g);
    rest = g + normals * push;
    out.wrong_way = std::max(0.0, -push.minCoeff()) / size;
    for (std::size_t k = 0; k < held.size(); ++k) {
      const double slack = std::min(row[held[k]] - lower[held[k]], upper[held[k]] - row[held[k]]);
      out.gap += std::abs(push[static_cast<Eigen::Index>(k)] * slack) / size;
    }
  }
  out.gradient = rest.norm() / size;
  return out;
}

// A bar of linear material pushed by two dead forces: its way is linear in their amounts, exactly.
SceneDef linear_bar(int steps) {
  return value(parse_scene(R"({
    "bodies": [{"name": "bar", "element": "tet4",
      "mesh": {"box": {"lower": [0, 0, 0], "upper": [0.1, 0.02, 0.02], "divisions": [3, 1, 1]}},
      "materials": [{"law": "linear", "young": 2e5, "poisson": 0.3, "density": 1100}]}],
    "analysis": {"type": "dynamic", "scheme": "implicit_euler", "duration": )" +
                               std::to_string(0.01 * steps) + R"(, "steps": )" + std::to_string(steps) + R"(},
    "dirichlet": [{"name": "root", "where": {"surfaces": "x0"}}],
    "forces": [{"name": "end", "where": {"surfaces": "x1"}, "force": [0, 0, 1], "amount": [[0, 0.02]]},
               {"name": "middle", "where": {"nearest": [[0.0667, 0, 0]]}, "force": [0, 1, 1], "amount": [[0, 0]]}],
    "volumes": [{"space": "none"}],
    "probes": [{"name": "tip", "point": [0.1, 0.01, 0.01]}, {"name": "side", "point": [0.05, 0, 0.01]}]
  })",
                           "bar", "."));
}

std::vector<Vector> probes_on_the_way(const SceneDef& scene) {
  RunOptions run;
  run.threads = 1;
  const RunResult result = run_scene(scene, run);
  REQUIRE(result.status == RunStatus::converged);
  for (const StepRecord& r : result.records) CHECK(r.substeps <= 1);
  std::vector<Vector> out;
  for (const StepRecord& r : result.records) {
    Vector all(6);
    all << r.probes[0].x, r.probes[0].y, r.probes[0].z, r.probes[1].x, r.probes[1].y, r.probes[1].z;
    out.push_back(all);
  }
  return out;
}

HorizonOptions quiet(std::optional<double> smooth = {}, int every = 1) {
  HorizonOptions options;
  options.threads = 1;
  options.smooth = smooth;
  options.every = every;
  options.tolerance = 1e-9;
  return options;
}

}  // namespace

TEST_CASE("least squares with limits on sums meet the conditions of an optimum", "[drive]") {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> flat(0.02, 0.7);
    const Eigen::Index n = 2 + static_cast<Eigen::Index>(random() % 90), seen = 1 + n / 2;
    Matrix A = Matrix::Zero(seen + n, n), C = Matrix::Zero(2 * n, n);
    Vector b = Vector::Zero(seen + n), lower(2 * n), upper(2 * n);
    const double weak = std::pow(10.0, -8.0 * flat(random));
    for (Eigen::Index i = 0; i < seen; ++i) {
      for (Eigen::Index k = 0; k < n; ++k) A(i, k) = normal(random) / static_cast<double>(n);
      b[i] = normal(random);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      A(seen + i, i) = weak;
      if (i > 0) A(seen + i, i - 1) = -weak;
      C(i, i) = C(n + i, i) = 1;
      if (i > 0) C(n + i, i - 1) = -1;
      lower[i] = -flat(random) - 0.01;
      upper[i] = random() % 5 == 0 ? none : flat(random);
      lower[n + i] = random() % 5 == 0 ? -none : -0.31 * flat(random);
      upper[n + i] = 0.23 * flat(random);
    }
    const Limited found = least_squares_within(A, b, C, lower, upper);
    CHECK(found.converged);
    const Optimality o = optimality(A, b, C, lower, upper, found.u);
    CHECK(o.beyond < 1e-9);
    CHECK(o.gradient < 1e-5);
    CHECK(o.wrong_way < 1e-6);
    CHECK(o.gap < 1e-6);
  }
}

TEST_CASE("least squares without limits are those of a factorization", "[drive]") {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Matrix A = Matrix::NullaryExpr(30, 12, [&] { return normal(random); });
  const Vector b = Vector::NullaryExpr(30, [&] { return normal(random); });
  const Limited found = least_squares_within(A, b, Matrix::Identity(12, 12), Vector::Constant(12, -none),
                                             Vector::Constant(12, none));
  REQUIRE(found.converged);
  CHECK((found.u - A.colPivHouseholderQr().solve(b)).norm() < 1e-11 * found.u.norm());
}

namespace {

// The problem as the declaration of drive_over_horizon() says it, in amounts over their sizes, those of two
// actuators at a point beside each other.
struct Quadratic {
  Matrix A;
  Vector b;
  Matrix C;
  Vector lower, upper;
};
Quadratic quadratic(const Matrix& response, const Vector& off, const Drive& d, const Vector& size,
                    const Vector& start, double smooth) {
  const Eigen::Index n = response.cols(), rows = off.size();
  double weight = 0;
  for (Eigen::Index k = 0; k < 2; ++k) {
    Vector sum = Vector::Zero(rows);
    for (Eigen::Index i = k; i < n; i += 2) sum += response.col(i);
    weight = std::max(weight, sum.cwiseAbs().maxCoeff());
  }
  Quadratic q{Matrix::Zero(rows + n, n), Vector::Zero(rows + n), Matrix::Zero(2 * n, n), Vector(2 * n),
              Vector(2 * n)};
  q.A.topRows(rows) = response;
  q.b.head(rows) = -off;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index p = i / 2, k = i % 2;
    const auto& curve = d.curves[static_cast<std::size_t>(k)].points;
    const double h = curve[static_cast<std::size_t>(p + 1)][0] - curve[static_cast<std::size_t>(p)][0];
    const double slow = smooth * weight * std::sqrt(curve.back()[0] / h);
    const Actuator& a = d.actuators[static_cast<std::size_t>(k)];
    q.A(rows + i, i) = slow;
    q.C(i, i) = q.C(n + i, i) = 1;
    if (p > 0)
      q.A(rows + i, i - 2) = -slow, q.C(n + i, i - 2) = -1;
    else
      q.b[rows + i] = slow * start[k];
    q.lower[i] = a.least / size[k];
    q.upper[i] = a.most / size[k];
    const double from = p > 0 ? 0 : start[k];
    q.lower[n + i] = from - a.rate * h / size[k];
    q.upper[n + i] = from + a.rate * h / size[k];
  }
  return q;
}

}  // namespace

// Responses are superposed here from runs of the scene, a point of a curve at a time: the gradients have no
// part in them.
TEST_CASE("of a scene that is linear the horizon finds the minimum of the quadratic problem", "[drive]") {
  const int steps = 9;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> flat(-1, 1);
    const int every = 1 + static_cast<int>(seed % 3);
    const SceneDef scene = linear_bar(steps);
    // Bounds that hold in part, and rates.
    const double most = seed % 4 == 0 ? none : 0.05 + 0.02 * flat(random),
                 rate = seed % 4 == 1 || seed == 8 ? none : 2.1 + flat(random);
    const std::vector<Actuator> actuators{{"end", -most, most, rate},
                                          {"middle", -0.5 * most, most, 2 * rate}};
    std::string csv = "time,tip.z,side.y\n";
    std::vector<std::array<double, 2>> wanted;
    const std::vector<int> at{2, 3, 6, 7, 9};
    for (const int n : at) {
      wanted.push_back({0.01 + 0.01 * flat(random), 0.003 * flat(random)});
      csv += std::to_string(0.01 * n) + "," + std::to_string(wanted.back()[0]) + "," +
             std::to_string(wanted.back()[1]) + "\n";
    }
    const Targets targets = value(parse_targets(csv, "targets", scene));
    const HorizonOptions options = quiet(1e-2, every);
    const Drive d = value(drive_over_horizon(scene, actuators, targets, options));
    CAPTURE(d.reason, d.steps[0].distance, d.steps[0].iterations);
    CHECK(d.reason.empty());
    REQUIRE(d.curves.size() == 2);

    const auto points = static_cast<Eigen::Index>(d.curves[0].points.size()) - 1;
    REQUIRE(points == (steps + every - 1) / every);
    const Eigen::Index n = 2 * points;
    const Vector size =
        Vector{{std::isfinite(most) ? 2 * most : 1.0, std::isfinite(most) ? 1.5 * most : 1.0}};
    const Vector start = Vector{{0.02 / size[0], 0.0}};
    const auto with = [&](const Vector& u) {
      SceneDef out = scene;
      for (Eigen::Index k = 0; k < 2; ++k) {
        Curve curve = d.curves[static_cast<std::size_t>(k)];
        for (Eigen::Index p = 0; p < points; ++p)
          curve.points[static_cast<std::size_t>(p + 1)][1] = size[k] * u[2 * p + k];
        out.forces[static_cast<std::size_t>(k)].amount = curve;
      }
      const auto way = probes_on_the_way(out);
      Vector off(2 * static_cast<Eigen::Index>(at.size()));
      for (std::size_t t = 0; t < at.size(); ++t) {
        const Vector& x = way[static_cast<std::size_t>(at[t])];
        off[2 * static_cast<Eigen::Index>(t)] = 0.01 + x[2] - targets.value[t][0];
        off[2 * static_cast<Eigen::Index>(t) + 1] = x[4] - targets.value[t][1];
      }
      return off;
    };
    const Vector off = with(Vector::Zero(n));
    Matrix response(off.size(), n);
    for (Eigen::Index i = 0; i < n; ++i) response.col(i) = (with(0.01 * Vector::Unit(n, i)) - off) / 0.01;
    const auto [A, b, C, lower, upper] = quadratic(response, off, d, size, start, options.smooth.value());
    Vector found(n);
    for (Eigen::Index i = 0; i < n; ++i)
      found[i] = d.curves[static_cast<std::size_t>(i % 2)].points[static_cast<std::size_t>(i / 2 + 1)][1] /
                 size[i % 2];
    // It is linear, and the search has seen the same way.
    CHECK((with(found) - off - response * found).norm() < 1e-8);
    for (std::size_t t = 0; t < at.size(); ++t) {
      const Vector here = with(found).segment(2 * static_cast<Eigen::Index>(t), 2);
      CHECK_THAT(d.steps[t].distance, WithinAbs(here.norm(), 1e-9));
    }
    const Optimality o = optimality(A, b, C, lower, upper, found);
    CHECK(o.beyond < 1e-12);
    CHECK(o.gradient < 1e-6);
    CHECK(o.wrong_way < 1e-6);
    CHECK(o.gap < 1e-8);
    // One gradient where it starts, and one that finds nothing more.
    CHECK(d.steps[0].iterations <= 3);
    if (!std::isfinite(most) && !std::isfinite(rate)) {
      const Vector exact = (A.transpose() * A).ldlt().solve(A.transpose() * b);
      CHECK((found - exact).norm() < 1e-6 * exact.norm());
    }
  }
}

namespace {

// A bar that two cables along it bend up and down.
SceneDef soft_arm(const Overrides& overrides = {}) {
  return value(parse_scene(R"({
    "bodies": [{"name": "arm", "element": "hex8",
      "mesh": {"box": {"upper": [0.2, 0.02, 0.02], "divisions": [6, 1, 1], "cell_type": "hex8"}},
      "materials": [{"young": 1e5, "poisson": 0.45, "density": 1100}]}],
    "analysis": {"type": "dynamic", "scheme": "bdf2", "duration": 0.6, "steps": 30},
    "dirichlet": [{"name": "root", "where": {"surfaces": "x0"}}],
    "cables": [{"name": "up", "control": "tension", "amount": [[0, 0.5]],
                "points": [[0, 0.01, 0.02], [0.1, 0.01, 0.02], [0.2, 0.01, 0.02]]},
               {"name": "down", "control": "tension", "amount": [[0, 0.5]],
                "points": [[0, 0.01, 0], [0.1, 0.01, 0], [0.2, 0.01, 0]]}],
    "probes": [{"name": "tip", "point": [0.2, 0.01, 0.01]}]
  })",
                           "soft_arm", ".", overrides));
}

// Largest and least height of the tip from a time on.
double swing(const SceneDef& scene, double from) {
  RunOptions run;
  run.threads = 1;
  const RunResult result = run_scene(scene, run);
  REQUIRE(result.status == RunStatus::converged);
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const StepRecord& r : result.records) {
    if (r.time < from - 1e-9) continue;
    least = std::min(least, r.probes[0].z);
    most = std::max(most, r.probes[0].z);
  }
  return most - least;
}

std::string heights(double height, double from, double to) {
  std::string csv = "time,tip.z\n";
  for (double t = from; t < to + 1e-9; t += 0.02)
    csv += std::to_string(t) + "," + std::to_string(0.01 + height) + "\n";
  return csv;
}

const std::vector<Actuator> cables{{"up", 0, 6, 60}, {"down", 0, 6, 60}};

}  // namespace

TEST_CASE("an arm is where it is asked to be at the end, and does not swing", "[drive]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> flat(0.01, 0.03);
  for (const double sign : {1.0, -1.0}) {
    const double height = sign * flat(random);
    CAPTURE(height);
    const SceneDef scene = soft_arm();
    HorizonOptions options = quiet();
    options.tolerance = 1e-6;
    const Drive d = value(drive_over_horizon(
        scene, cables, value(parse_targets(heights(height, 0.4, 0.6), "t", scene)), options));
    CAPTURE(d.reason, d.steps[0].iterations);
    CHECK(d.all_reached());
    CHECK(d.increments == 30);
    CHECK(d.steps[0].iterations < 30);
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& points = d.curves[k].points;
      REQUIRE(points.size() == 31);
      CHECK(points[0][1] == 0.5);
      for (std::size_t p = 1; p < points.size(); ++p) {
        CHECK((points[p][1] >= 0 && points[p][1] <= 6));
        CHECK(std::abs(points[p][1] - points[p - 1][1]) <=
              60 * (points[p][0] - points[p - 1][0]) * (1 + 1e-9));
      }
    }
    // A run with these curves goes that way; one with what statics ask for, brought up as slowly as the
    // horizon allows, swings.
    CHECK(swing(value(driven_scene(scene, d)), 0.4) < 4e-6);
    const SceneDef still = soft_arm({R"(analysis={"type": "static", "steps": 6})"});
    DriveOptions one_by_one;
    one_by_one.threads = 1;
    const Drive rest = value(
        drive::drive(still, cables, value(parse_targets(heights(height, 0.4, 0.4), "t", still)), one_by_one));
    REQUIRE(rest.all_reached());
    SceneDef ramped = scene;
    for (std::size_t k = 0; k < 2; ++k)
      ramped.cables[k].amount.points = {{0, 0.5}, {0.4, rest.steps[0].amount[k]}};
    CHECK(swing(ramped, 0.4) > 0.1 * std::abs(height));
  }
}

TEST_CASE("what a horizon does not reach is come to as near as bounds and rates allow", "[drive]") {
  const SceneDef scene = soft_arm();
  std::vector<Actuator> weak{{"up", 0, 0.6, 2}, {"down", 0, 0.6, 2}};
  HorizonOptions options = quiet({}, 3);
  options.tolerance = 1e-6;
  const Targets targets = value(parse_targets("time,tip.z\n0.24,0.1\n0.3,0.12\n", "t", scene));
  const Drive d = value(drive_over_horizon(scene, weak, targets, options));
  CAPTURE(d.reason);
  REQUIRE(d.steps.size() == 2);
  double found = 0;
  for (const Reached& r : d.steps) {
    CHECK_FALSE(r.reached);
    CHECK(r.nearest);
    CHECK_FALSE(r.at_bound.empty());
    found += r.distance * r.distance;
  }
  CHECK_FALSE(d.all_reached());
  CHECK_THAT(drive_json(d), Contains("\"nearest\"") && Contains("\"curves\""));
  CHECK_THAT(amounts_csv(d), Contains("time,up,down"));
  // No curves nearby that keep bounds and rates come closer.
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 12; ++trial) {
    SceneDef other = value(driven_scene(scene, d));
    for (std::size_t k = 0; k < 2; ++k) {
      auto& points = other.cables[k].amount.points;
      for (std::size_t p = 1; p < points.size(); ++p) {
        const double change = 2 * (points[p][0] - points[p - 1][0]);
        const double least = std::max(0.0, points[p - 1][1] - change),
                     most = std::min(0.6, points[p - 1][1] + change);
        points[p][1] = std::clamp(points[p][1] + 0.03 * normal(random), least, most);
      }
    }
    RunOptions run;
    run.threads = 1;
    const RunResult result = run_scene(other, run);
    REQUIRE(result.status == RunStatus::converged);
    const double a = 0.01 + result.records[12].probes[0].z - 0.1,
                 b = 0.01 + result.records[15].probes[0].z - 0.12;
    CHECK(a * a + b * b > found * (1 - 1e-9));
  }
}

TEST_CASE("statics over a whole horizon meet what step by step meets", "[drive]") {
  const SceneDef scene = soft_arm({R"(analysis={"type": "static", "duration": 0.6, "steps": 6})"});
  const Targets targets = value(parse_targets("time,tip.z\n0.2,0.015\n0.4,0.02\n0.6,0.012\n", "t", scene));
  HorizonOptions options = quiet();
  options.tolerance = 1e-6;
  const Drive d = value(drive_over_horizon(scene, cables, targets, options));
  CAPTURE(d.reason);
  CHECK(d.all_reached());
  CHECK(value(drive::drive(scene, cables, targets, options)).all_reached());
}

TEST_CASE("what has no horizon is refused", "[drive]") {
  const SceneDef scene = soft_arm();
  const auto refused = [&](const SceneDef& of, const std::string& csv, const HorizonOptions& options,
                           std::vector<Actuator> actuators = cables) {
    const auto made =
        drive_over_horizon(of, std::move(actuators), value(parse_targets(csv, "t", of)), options);
    REQUIRE_FALSE(made.ok());
    return made.error();
  };
  CHECK_THAT(refused(scene, "time,tip.z\n0.25,0.01\n", quiet()), Contains("not at the end of an increment"));
  CHECK_THAT(refused(scene, "time,tip.z\n0.2,0.01\n", quiet(0)), Contains("smooth"));
  CHECK_THAT(refused(scene, "time,tip.z\n0.2,0.01\n", quiet({}, 0)), Contains("every"));
  CHECK_THAT(refused(scene, "time,tip.z\n0.2,200\n", quiet()), Contains("in meters"));
  CHECK_THAT(refused(scene, "time,tip.z\n0.2,0.01\n", quiet(), {{"left", 0, 1, 1}}), Contains("\"up\""));
  CHECK_THAT(refused(scene, "time,tip.z\n0.2,0.01\n", quiet(), {{"up", 1, 2, 1}}), Contains("begins at 0.5"));
  CHECK_THAT(refused(soft_arm({R"(analysis={"type": "static", "path_step": 0.01})"}),
                     "time,tip.z\n0.2,0.01\n", quiet()),
             Contains("path"));
  // 30 increments of two amounts are few; 1500 are too many.
  CHECK_THAT(refused(soft_arm({"analysis.steps=1500"}), "time,tip.z\n0.6,0.01\n", quiet()),
             Contains("--every"));
}
