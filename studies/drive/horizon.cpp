// Outline:
//   1. the way through all increments with the curves of the scene
//   2. its gradients: of what is seen at each target, by each point of each curve
//   3. the change of all points that makes the sum smallest to first order, within bounds and rates
//      (limited.h)
//   4. the way is gone with them; damped (Levenberg, Marquardt) until the sum is smaller
//   5. from 2., until to first order nothing is gained
// Scenes are built anew for every way: that costs about as much as an increment, and a host's curves have no
// other door.
#include "studies/drive/horizon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/text.h"
#include "isochor/gradients.h"
#include "scenes/effects/kind.h"
#include "scenes/schedule.h"
#include "studies/drive/amounts.h"
#include "studies/drive/limited.h"
#include "studies/inverse/answer.h"

namespace isochor::drive {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr int kMostTrials = 14;
// Of changes of amounts, as smoothness counts them, against what they do: how far a gradient holds. The first
// and the least that is not zero, and how it goes on where steps fail or are as good as they promise.
constexpr double kFirstDamping = 1e-3, kLeastDamping = 1e-5, kFails = 4, kHolds = 8;
// Where all targets are met amounts still change, until their smoothness gains no more than this part of
// itself.
constexpr double kSmoothEnough = 1e-2;
// How much that counts where nothing is said, and how often it is made to count a tenth.
constexpr double kSmooth = 1e-4;
constexpr int kMostEased = 4;
// A point of a curve is at its limit within this part of its size.
constexpr double kAtLimit = 1e-8;

std::size_t at(Eigen::Index i) {
  return static_cast<std::size_t>(i);
}

class Horizon {
 public:
  Horizon(const SceneDef& scene, Drive& drive, const HorizonOptions& options)
      : scene_(scene), drive_(drive), options_(options), units_(units_of(drive.targets)) {}

  // Increments, points of the curves, what holds for them; refuses targets between increments.
  Result<void> plan();
  Result<void> check_start() const;
  // The way with the curves of the scene; an error where there is none.
  Result<void> begin();
  void run();

 private:
  Eigen::Index goals() const { return units_.size(); }
  Eigen::Index actuators() const { return static_cast<Eigen::Index>(drive_.actuators.size()); }
  Eigen::Index points() const { return static_cast<Eigen::Index>(when_.size()); }
  // Unknowns are amounts over their sizes; those of one point beside each other.
  Eigen::Index unknowns() const { return actuators() * points(); }
  double before(const Vector& u, Eigen::Index i) const {
    return i < actuators() ? start_[i] : u[i - actuators()];
  }
  double duration(Eigen::Index point) const {
    return when_[at(point)] - (point > 0 ? when_[at(point - 1)] : 0);
  }

  Vector curves_of_scene() const;
  std::vector<Curve> curves(const Vector& u) const;
  SceneDef scene_with(const Vector& u) const;
  // Off the targets, over units, along the way with these amounts; none: there is no such way, stuck_ says
  // why.
  std::optional<Vector> go(const Vector& u);
  Result<Matrix> differentiate(const Vector& u) const;
  std::vector<TimedOutput> outputs(const inverse::Watched& watched) const;
  // Rows that count changes of amounts, and what they are of now.
  Matrix change_rows() const;
  double merit(const Vector& u, const Vector& off) const {
    return off.squaredNorm() + (slow_ * u - steady_).squaredNorm();
  }
  bool met(const Vector& off) const { return off.norm() <= 0.1 * options_.tolerance; }
  void limit();
  std::optional<Vector> proposal(const Vector& u, const Vector& off, const Matrix& jacobian,
                                 double damping) const;
  Vector within(Vector u) const;
  // One gradient and what it asks for; false: the search ends here.
  bool approach(Vector& u, Vector& off);
  bool eased(const Vector& u, const Vector& off, const Matrix& jacobian);
  void tell(const Vector& u, const Vector& off);
  std::vector<std::string> at_limits(const Vector& u, double time) const;

  const SceneDef& scene_;
  Drive& drive_;
  const HorizonOptions& options_;
  Vector units_, size_, start_;  // of goals; of actuators [amount], [size]
  double h_ = 0;                 // [s]
  std::vector<double> when_;     // of the points, the last at the last target [s]
  std::vector<Index> seen_;      // increment at whose end each target is
  Vector u_, off_;               // at the start
  Matrix first_;                 // gradients there
  Matrix changes_;               // change_rows()
  Matrix slow_;                  // change_rows() times their weight; empty: not known yet
  Vector steady_;                // slow_ of an amount that stays where it begins
  double weight_ = 0;            // W of the declaration
  Matrix limited_;               // rows with limits
  Vector lower_, upper_;
  double damping_ = 0;
  int gradients_ = 0, eased_ = 0;
  bool settled_ = false;
  std::string stuck_;
};

Result<void> Horizon::plan() {
  h_ = plan_steps(scene_.analysis).h;
  const double near = 1e-6;
  for (const double t : drive_.targets.time) {
    const double steps = std::round(t / h_);
    if (std::abs(t / h_ - steps) > near || steps < 1) {
      return Error{"drive: the target at time " + number(t) +
                   " is not at the end of an increment, which are " + number(h_) +
                   " long; move it, or give other increments with --set analysis.step"};
    }
    seen_.push_back(static_cast<Index>(steps));
  }
  drive_.increments = seen_.back();
  for (Index n = options_.every; n < seen_.back(); n += options_.every) when_.push_back(n * h_);
  when_.push_back(seen_.back() * h_);
  constexpr Eigen::Index most_unknowns = 2000;
  if (unknowns() > most_unknowns) {
    return Error{"drive: " + std::to_string(points()) + " points of " + std::to_string(actuators()) +
                 " amounts are " + std::to_string(unknowns()) + " unknowns, and " +
                 std::to_string(most_unknowns) + " are the most; set points further apart with --every"};
  }
  size_.resize(actuators());
  start_.resize(actuators());
  SceneDef said = scene_;
  for (Eigen::Index i = 0; i < actuators(); ++i) {
    const Actuator& a = drive_.actuators[at(i)];
    const double start = evaluate(*find_amount(said, a.effect).amount, 0);
    size_[i] = size_of(a, start);
    start_[i] = start / size_[i];
  }
  limit();
  return {};
}

void Horizon::limit() {
  constexpr double none = std::numeric_limits<double>::infinity();
  const Eigen::Index n = unknowns();
  limited_.setZero(2 * n, n);
  lower_.setConstant(2 * n, -none);
  upper_.setConstant(2 * n, none);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index k = i % actuators();
    const Actuator& a = drive_.actuators[at(k)];
    limited_(i, i) = 1;
    lower_[i] = a.least / size_[k];
    upper_[i] = a.most / size_[k];
    const double change = a.rate * duration(i / actuators()) / size_[k];
    const double from = i < actuators() ? start_[k] : 0;
    limited_(n + i, i) = 1;
    if (i >= actuators()) limited_(n + i, i - actuators()) = -1;
    lower_[n + i] = from - change;
    upper_[n + i] = from + change;
  }
}

Eigen::VectorXd Horizon::within(Vector u) const {
  const Eigen::Index n = unknowns();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double from = i < actuators() ? 0 : u[i - actuators()];
    u[i] = std::clamp(u[i], std::max(lower_[i], from + lower_[n + i]),
                      std::min(upper_[i], from + upper_[n + i]));
  }
  return u;
}

Eigen::VectorXd Horizon::curves_of_scene() const {
  Vector u(unknowns());
  SceneDef said = scene_;
  for (Eigen::Index i = 0; i < unknowns(); ++i) {
    const Eigen::Index k = i % actuators();
    u[i] = evaluate(*find_amount(said, drive_.actuators[at(k)].effect).amount, when_[at(i / actuators())]) /
           size_[k];
  }
  return within(u);
}

std::vector<Curve> Horizon::curves(const Vector& u) const {
  std::vector<Curve> out;
  for (Eigen::Index k = 0; k < actuators(); ++k) {
    Curve& curve = out.emplace_back();
    const Actuator& a = drive_.actuators[at(k)];
    curve.points.push_back({0, size_[k] * start_[k]});
    for (Eigen::Index p = 0; p < points(); ++p)
      curve.points.push_back({when_[at(p)], std::clamp(size_[k] * u[p * actuators() + k], a.least, a.most)});
  }
  return out;
}

SceneDef Horizon::scene_with(const Vector& u) const {
  SceneDef out = scene_;
  const std::vector<Curve> amounts = curves(u);
  for (std::size_t k = 0; k < amounts.size(); ++k)
    *find_amount(out, drive_.actuators[k].effect).amount = amounts[k];
  return out;
}

std::optional<Eigen::VectorXd> Horizon::go(const Vector& u) {
  const SceneDef scene = scene_with(u);
  auto built = build(scene, {.threads = options_.threads});
  if (!built) {
    stuck_ = built.error();
    return std::nullopt;
  }
  World& world = built.value().world;
  const inverse::Watched watched(scene, built.value(), drive_.targets.goals);
  Vector off(goals() * static_cast<Eigen::Index>(seen_.size()));
  Eigen::Index row = 0;
  std::size_t target = 0;
  for (Index n = 1; n <= seen_.back(); ++n) {
    drive_.interrupted = drive_.interrupted || (options_.stop && options_.stop());
    if (drive_.interrupted) return std::nullopt;
    const StepReport report = world.step(h_);
    if (report.status != StepStatus::converged) {
      stuck_ = "increment " + std::to_string(n) + ", at " + number(n * h_) + ": " + report.reason;
      return std::nullopt;
    }
    if (n != seen_[target]) continue;
    for (Eigen::Index g = 0; g < goals(); ++g)
      off[row++] = (watched.value(world, at(g)) - drive_.targets.value[target][at(g)]) / units_[g];
    ++target;
  }
  if (off.allFinite()) return off;
  stuck_ = "what is wanted is no number on the way";
  return std::nullopt;
}

std::vector<TimedOutput> Horizon::outputs(const inverse::Watched& watched) const {
  std::vector<TimedOutput> out;
  for (const Index step : seen_) {
    for (Eigen::Index g = 0; g < goals(); ++g) out.push_back({{{step, watched.output(at(g))}}});
  }
  return out;
}

// Over units, by amounts over their sizes.
Result<Eigen::MatrixXd> Horizon::differentiate(const Vector& u) const {
  const SceneDef scene = scene_with(u);
  auto built = build(scene, {.threads = options_.threads});
  if (!built) return built.failure();
  const inverse::Watched watched(scene, built.value(), drive_.targets.goals);
  TrajectoryQuery query;
  query.steps.assign(static_cast<std::size_t>(seen_.back()), h_);
  query.outputs = outputs(watched);
  const std::vector<Curve> amounts = curves(u);
  SceneDef said = scene;
  std::vector<EffectId> effects;
  for (const Actuator& a : drive_.actuators) {
    const FoundAmount found = find_amount(said, a.effect);
    effects.push_back(built.value().ids(*found.kind)[found.number]);
  }
  for (Eigen::Index i = 0; i < unknowns(); ++i) {
    const auto k = at(i % actuators());
    query.parameters.push_back(
        Parameter::curve_point(effects[k], amounts[k], static_cast<Index>(1 + i / actuators())));
  }
  if (options_.stop) built.value().world.stop_when(options_.stop);
  const auto told = built.value().world.trajectory_gradients(query);
  if (!told) return told.failure();
  Matrix jacobian(static_cast<Eigen::Index>(query.outputs.size()), unknowns());
  for (Eigen::Index j = 0; j < jacobian.rows(); ++j) {
    for (Eigen::Index i = 0; i < unknowns(); ++i)
      jacobian(j, i) = told.value().of(at(j), at(i)) * size_[i % actuators()] / units_[j % goals()];
  }
  return jacobian;
}

Eigen::MatrixXd Horizon::change_rows() const {
  Matrix rows = limited_.bottomRows(unknowns());
  for (Eigen::Index i = 0; i < unknowns(); ++i)
    rows.row(i) *= std::sqrt(when_.back() / duration(i / actuators()));
  return rows;
}

Result<void> Horizon::check_start() const {
  auto built = build(scene_, {.threads = options_.threads});
  if (!built) return built.failure();
  const inverse::Watched watched(scene_, built.value(), drive_.targets.goals);
  Vector now(goals());
  for (Eigen::Index g = 0; g < goals(); ++g) now[g] = watched.value(built.value().world, at(g));
  return check_distances(built.value().world, drive_.targets, now);
}

Result<void> Horizon::begin() {
  u_ = curves_of_scene();
  const auto off = go(u_);
  if (!off && drive_.interrupted) return {};
  if (!off) {
    return Error{"drive: with the amounts that the scene begins with there is no way to the last target: " +
                 stuck_ + "; shorter increments, or other curves to begin with"};
  }
  off_ = *off;
  auto jacobian = differentiate(u_);
  if (!jacobian) return jacobian.failure();
  first_ = std::move(jacobian).value();
  weight_ = 0;
  for (Eigen::Index k = 0; k < actuators(); ++k) {
    // All of an amount at once.
    Vector sum = Vector::Zero(first_.rows());
    for (Eigen::Index p = 0; p < points(); ++p) sum += first_.col(p * actuators() + k);
    weight_ = std::max(weight_, sum.cwiseAbs().maxCoeff());
  }
  if (!(weight_ > 0))
    return Error{"drive: nothing that is wanted depends on the amounts; choose others with --amount"};
  changes_ = change_rows();
  slow_ = options_.smooth.value_or(kSmooth) * weight_ * changes_;
  steady_ = Vector::Zero(unknowns());
  for (Eigen::Index k = 0; k < actuators(); ++k)
    steady_[k] =
        options_.smooth.value_or(kSmooth) * weight_ * std::sqrt(when_.back() / duration(0)) * start_[k];
  return {};
}

std::optional<Eigen::VectorXd> Horizon::proposal(const Vector& u, const Vector& off, const Matrix& jacobian,
                                                 double damping) const {
  const Eigen::Index n = unknowns();
  Matrix A(jacobian.rows() + 2 * n, n);
  Vector b(A.rows());
  A << jacobian / weight_, slow_ / weight_, damping * changes_;
  b << -off / weight_, (steady_ - slow_ * u) / weight_, Vector::Zero(n);
  const Vector now = limited_ * u;
  const Limited found = least_squares_within(A, b, limited_, lower_ - now, upper_ - now);
  if (!found.converged) return std::nullopt;
  return within(u + found.u);
}

// Where smoothness alone keeps amounts from targets it counts less from here on; not where it was asked for.
bool Horizon::eased(const Vector& u, const Vector& off, const Matrix& jacobian) {
  if (options_.smooth || off.norm() <= options_.tolerance || eased_ == kMostEased) return false;
  constexpr double less = 0.1;
  const Matrix slow = std::exchange(slow_, less * slow_);
  const Vector steady = std::exchange(steady_, less * steady_);
  const auto next = proposal(u, off, jacobian, 0);
  if (next && off.norm() - (off + jacobian * (*next - u)).norm() > 1e-2 * options_.tolerance) {
    ++eased_;
    --gradients_;
    first_ = jacobian;
    settled_ = false;
    return true;
  }
  slow_ = slow;
  steady_ = steady;
  return false;
}

bool Horizon::approach(Vector& u, Vector& off) {
  const auto jacobian = first_.size() > 0 ? Result<Matrix>(std::exchange(first_, {})) : differentiate(u);
  if (!jacobian) {
    stuck_ = jacobian.error();
    return false;
  }
  ++gradients_;
  if (options_.on_iteration) options_.on_iteration(gradients_, off.norm());
  const double here = merit(u, off);
  for (int k = 0; k <= kMostTrials; ++k) {
    const auto next = proposal(u, off, jacobian.value(), k == 0 ? 0 : damping_);
    if (!next) {
      stuck_ = "the least-squares problem of the amounts was not solved";
      return false;
    }
    const double ahead = merit(*next, off + jacobian.value() * (*next - u));
    if (k == 0) {
      const double gain = std::sqrt(here) - std::sqrt(ahead);
      settled_ = gain <= 1e-2 * options_.tolerance || (met(off) && gain <= kSmoothEnough * std::sqrt(here));
      if (settled_ && eased(u, off, jacobian.value())) return true;
      if (settled_) return false;
      if (damping_ > 0) continue;
    }
    const auto there = go(*next);
    if (drive_.interrupted) return false;
    const double share = there ? (here - merit(*next, *there)) / (here - ahead) : 0;
    if (!(share > 0.25)) damping_ = damping_ > 0 ? kFails * damping_ : kFirstDamping;
    if (!(share > 0)) continue;
    if (share > 0.75) damping_ = damping_ > kHolds * kLeastDamping ? damping_ / kHolds : 0;
    stuck_.clear();
    u = *next;
    off = *there;
    return true;
  }
  return false;
}

void Horizon::run() {
  Vector u = u_, off = off_;
  while (!drive_.interrupted && gradients_ < options_.max_iterations && approach(u, off)) {
  }
  if (drive_.interrupted)
    drive_.reason = "interrupted";
  else if (!settled_)
    drive_.reason = stuck_.empty() ? "no closer within " + std::to_string(gradients_) + " gradients" : stuck_;
  if (off.size() > 0) tell(u, off);
}

// Amounts that are at a bound at a time, or change as fast as they may up to it.
std::vector<std::string> Horizon::at_limits(const Vector& u, double time) const {
  std::vector<std::string> out;
  const auto later = std::lower_bound(when_.begin(), when_.end(), time - 1e-6 * h_);
  const Vector now = limited_ * u;
  const Eigen::Index n = unknowns();
  for (Eigen::Index k = 0; k < actuators(); ++k) {
    const Eigen::Index i = (later - when_.begin()) * actuators() + k;
    bool limited = false;
    for (const Eigen::Index row : {i, n + i})
      limited = limited || now[row] - lower_[row] <= kAtLimit || upper_[row] - now[row] <= kAtLimit;
    if (limited) out.push_back(drive_.actuators[at(k)].effect);
  }
  return out;
}

void Horizon::tell(const Vector& u, const Vector& off) {
  drive_.curves = curves(u);
  const Targets& targets = drive_.targets;
  for (std::size_t t = 0; t < targets.time.size(); ++t) {
    Reached r;
    r.time = targets.time[t];
    for (const Curve& curve : drive_.curves) r.amount.push_back(evaluate(curve, r.time));
    const Vector here = off.segment(static_cast<Eigen::Index>(t) * goals(), goals());
    for (Eigen::Index g = 0; g < goals(); ++g)
      r.position.push_back(targets.value[t][at(g)] + units_[g] * here[g]);
    r.distance = here.norm();
    r.reached = r.distance <= options_.tolerance;
    r.nearest = settled_ && !r.reached;
    r.at_bound = at_limits(u, r.time);
    r.iterations = gradients_;
    drive_.steps.push_back(std::move(r));
  }
}

Result<void> check_scene(const SceneDef& scene, const HorizonOptions& options) {
  if (scene.analysis.path_step)
    return Error{"drive: scene \"" + scene.name + "\" follows a path; leave analysis.path_step out"};
  if (options.every < 1)
    return Error{"drive: every = " + std::to_string(options.every) + "; give a number of increments, from 1"};
  const double smooth = options.smooth.value_or(kSmooth);
  if (!(smooth > 0) || !std::isfinite(smooth))
    return Error{"drive: smooth = " + number(smooth) + "; give a positive number"};
  return no_schedule(scene, "drive");
}

}  // namespace

Result<Drive> drive_over_horizon(const SceneDef& scene, std::vector<Actuator> actuators, Targets targets,
                                 const HorizonOptions& options) {
  if (auto r = check_scene(scene, options); !r) return r.failure();
  SceneDef said = scene;
  if (auto r = check_actuators(said, actuators); !r) return r.failure();
  Drive out;
  out.actuators = std::move(actuators);
  out.targets = std::move(targets);
  Horizon horizon(scene, out, options);
  if (auto r = horizon.plan(); !r) return r.failure();
  if (auto r = horizon.check_start(); !r) return r.failure();
  if (auto r = horizon.begin(); !r) return r.failure();
  horizon.run();
  return out;
}

}  // namespace isochor::drive
