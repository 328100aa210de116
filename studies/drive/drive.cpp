// Outline of a target:
//   1. the step is tried with the amounts that the last gradient asks for
//   2. gradient of the probes by the amounts at the equilibrium found
//   3. the change of amounts that brings the probes closest to first order, within bounds and rates, and
//      among equals the one closest to the amounts of the target before: bounded least squares
//   4. the step is tried anew with them, from the state of the target before; damped (Levenberg, Marquardt)
//      until it comes closer
//   5. from 2., until the target is reached by amounts that change no more, or nothing comes closer
// Every try begins at the same state, so that what remembers its past (friction, gas) sees one path alone.
#include "studies/drive/drive.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/text.h"
#include "isochor/gradients.h"
#include "scenes/schedule.h"
#include "studies/drive/amounts.h"
#include "studies/drive/bounded.h"
#include "studies/inverse/answer.h"

namespace isochor::drive {

namespace {

// Redundant amounts are told apart by how much they change, weighed with this of what they do.
constexpr double kLeastChange = 1e-6;
constexpr int kMostHalvings = 8;
// Of changes of amounts over their sizes, against what they do: how far a gradient holds. Far from a target
// positions bend more than they follow.
constexpr double kFirstDamping = 0.03;
// Where a target is met, amounts that change less are looked for until they change by no more than this, for
// so many gradients.
constexpr double kStill = 1e-4;
constexpr int kMostPolishing = 6;

class Search {
 public:
  Search(Drive& drive, const SceneDef& scene, BuiltScene& built, const DriveOptions& options)
      : drive_(drive),
        options_(options),
        world_(built.world),
        watched_(scene, built, drive.targets.goals),
        units_(units_of(drive.targets)) {}

  void find_effects(SceneDef& scene, const BuiltScene& built);
  Result<void> check() const {
    return check_distances(world_, drive_.targets, positions().cwiseProduct(units_));
  }
  void run();

 private:
  using Vector = Eigen::VectorXd;
  std::size_t goals() const { return drive_.targets.goals.size(); }
  Eigen::Index amounts() const { return static_cast<Eigen::Index>(effects_.size()); }

  // Over these units.
  Vector positions() const {
    Vector out(static_cast<Eigen::Index>(goals()));
    for (std::size_t g = 0; g < goals(); ++g)
      out[static_cast<Eigen::Index>(g)] = watched_.value(world_, g) / units_[static_cast<Eigen::Index>(g)];
    return out;
  }
  Vector wanted_at(std::size_t step) const {
    return Eigen::Map<const Vector>(drive_.targets.value[step].data(), static_cast<Eigen::Index>(goals()))
        .cwiseQuotient(units_);
  }
  // From the state kept, with amounts `a`; false: no equilibrium.
  bool attempt(const Vector& a, double h);
  Result<void> differentiate();
  // What the amounts are to become, to first order.
  std::optional<Vector> proposal(const Vector& a, const Vector& off, double damping) const;
  // Sum of squares that is made small.
  double merit(const Vector& a, const Vector& off) const {
    return off.squaredNorm() + kLeastChange * kLeastChange * weight_ * weight_ *
                                   ((a - before_).cwiseQuotient(scale_)).squaredNorm();
  }
  // To a target; false: there is no way on.
  bool reach(std::size_t step);
  std::optional<Vector> start_at(std::size_t step, double h, const Vector& wanted);
  bool polish(Vector& a, Vector& off, double h, const Vector& wanted, const Vector& next);
  bool approach(Vector& a, Vector& off, double h, const Vector& wanted, Reached& out);

  Drive& drive_;
  const DriveOptions& options_;
  World& world_;
  inverse::Watched watched_;
  Vector units_;
  std::vector<EffectId> effects_;
  std::vector<std::byte> kept_;
  Vector before_, scale_, least_, most_;  // amounts at the target before, their sizes, bounds at this one
  Eigen::MatrixXd jacobian_;              // of positions by amounts; empty: not known yet
  std::string stuck_;
  double damping_ = 0;
  int polished_ = 0;
  double weight_ = 0;  // its largest entry, by amounts over their sizes [m]
};

void Search::find_effects(SceneDef& scene, const BuiltScene& built) {
  const auto n = static_cast<Eigen::Index>(drive_.actuators.size());
  before_.resize(n);
  scale_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Actuator& a = drive_.actuators[static_cast<std::size_t>(i)];
    const FoundAmount found = find_amount(scene, a.effect);
    effects_.push_back(built.ids(*found.kind)[found.number]);
    before_[i] = evaluate(*found.amount, 0);
    scale_[i] = size_of(a, before_[i]);
  }
}

bool Search::attempt(const Vector& a, double h) {
  if (auto r = world_.load(kept_); !r) {
    stuck_ = r.error();
    return false;
  }
  for (Eigen::Index i = 0; i < amounts(); ++i) {
    if (auto r = world_.set_amount(effects_[static_cast<std::size_t>(i)], a[i]); !r) {
      stuck_ = r.error();
      return false;
    }
  }
  const StepReport report = world_.advance(h);
  const bool found = report.status == StepStatus::converged;
  stuck_ = found ? "" : report.reason;
  return found;
}

Result<void> Search::differentiate() {
  GradientQuery query;
  for (std::size_t g = 0; g < goals(); ++g) query.outputs.push_back(watched_.output(g));
  for (const EffectId e : effects_) query.parameters.push_back(Parameter::amount_of(e));
  auto gradients = world_.gradients(query);
  if (!gradients) return gradients.failure();
  jacobian_.resize(static_cast<Eigen::Index>(goals()), amounts());
  for (std::size_t g = 0; g < goals(); ++g) {
    const auto row = static_cast<Eigen::Index>(g);
    for (Eigen::Index i = 0; i < amounts(); ++i)
      jacobian_(row, i) = gradients.value().of(g, static_cast<std::size_t>(i)) / units_[row];
  }
  weight_ = (jacobian_ * scale_.asDiagonal()).cwiseAbs().maxCoeff();
  return {};
}

std::optional<Eigen::VectorXd> Search::proposal(const Vector& a, const Vector& off, double damping) const {
  // Unknowns are changes of amounts over their sizes; everything over the largest change of a position.
  const auto rows = jacobian_.rows(), n = amounts();
  if (weight_ == 0) return a;  // nothing that may be chosen moves a probe
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd A(rows + 2 * n, n);
  Vector b(rows + 2 * n);
  A << jacobian_ * scale_.asDiagonal() / weight_, kLeastChange * one, damping * one;
  b << -off / weight_, kLeastChange * (before_ - a).cwiseQuotient(scale_), Vector::Zero(n);
  const Bounded found =
      least_squares(A, b, (least_ - a).cwiseQuotient(scale_), (most_ - a).cwiseQuotient(scale_));
  if (!found.converged) return std::nullopt;
  return (a + scale_.cwiseProduct(found.u)).cwiseMax(least_).cwiseMin(most_);
}

// The first try at a target; nothing where none has an equilibrium.
std::optional<Eigen::VectorXd> Search::start_at(std::size_t step, double h, const Vector& wanted) {
  least_.resize(amounts());
  most_.resize(amounts());
  for (Eigen::Index i = 0; i < amounts(); ++i) {
    const Actuator& actuator = drive_.actuators[static_cast<std::size_t>(i)];
    least_[i] = std::max(actuator.least, before_[i] - h * actuator.rate);
    most_[i] = std::min(actuator.most, before_[i] + h * actuator.rate);
  }
  Vector a = before_;
  if (step > 0) a = proposal(a, positions() - wanted, 0).value_or(a);
  for (int k = 0; k <= kMostHalvings; ++k) {
    if (attempt(a, h)) return a;
    a = k + 1 == kMostHalvings ? before_ : Vector(0.5 * (a + before_));
  }
  return std::nullopt;
}

// Towards amounts that change less; on the way a target may be missed by a little until the next gradient.
bool Search::polish(Vector& a, Vector& off, double h, const Vector& wanted, const Vector& next) {
  constexpr double astray = 100;  // times the tolerance
  double part = 1;
  for (int k = 0; k <= kMostHalvings; ++k, part *= 0.5) {
    const Vector trial = a + part * (next - a);
    if (!attempt(trial, h)) continue;
    const Vector there = positions() - wanted;
    if (there.norm() > astray * options_.tolerance) continue;
    a = trial;
    off = there;
    return true;
  }
  if (!attempt(a, h)) stuck_ = "a step that was found is not found again";
  return false;
}

// One gradient and the step that it asks for. False: there is no closer, or the search has to end.
bool Search::approach(Vector& a, Vector& off, double h, const Vector& wanted, Reached& out) {
  if (auto r = differentiate(); !r) {
    stuck_ = r.error();
    return false;
  }
  ++out.iterations;
  const double here = merit(a, off);
  const bool met = off.norm() <= options_.tolerance;
  for (int k = 0; k <= kMostHalvings; ++k) {
    const auto next = proposal(a, off, k == 0 ? 0 : damping_);
    if (!next) {
      stuck_ = "the least-squares problem of the amounts was not solved";
      return false;
    }
    const Vector ahead = off + jacobian_ * (*next - a);
    if (k == 0) {
      const double gain = off.norm() - ahead.norm(), small = 1e-2 * options_.tolerance;
      const double change = (*next - a).cwiseQuotient(scale_).cwiseAbs().maxCoeff();
      // Far from a target the distance itself is known to no better than equilibria are.
      out.nearest = !met && gain <= small;
      if (out.nearest || (met && gain <= small && (change <= kStill || ++polished_ > kMostPolishing)))
        return false;
      if (met) return polish(a, off, h, wanted, *next);
      if (damping_ > 0) continue;
    }
    const bool found = attempt(*next, h);
    const Vector there = positions() - wanted;
    const double share = (here - merit(*next, there)) / (here - merit(*next, ahead));
    if (!found || !(share > 0.25)) damping_ = std::max(kFirstDamping, 4 * damping_);
    if (!found || !(share > 0)) continue;
    if (share > 0.75) damping_ = damping_ > kFirstDamping ? damping_ / 4 : 0;
    a = *next;
    off = there;
    return true;
  }
  if (!attempt(a, h)) stuck_ = "a step that was found is not found again";
  return false;
}

bool Search::reach(std::size_t step) {
  const Targets& targets = drive_.targets;
  const double h = targets.time[step] - (step > 0 ? targets.time[step - 1] : 0);
  const Vector wanted = wanted_at(step);
  const auto start = start_at(step, h, wanted);
  if (!start) return false;
  Vector a = *start, off = positions() - wanted;
  Reached out;
  out.time = targets.time[step];
  stuck_.clear();
  damping_ = 0;
  polished_ = 0;
  while (out.iterations < options_.max_iterations) {
    drive_.interrupted = options_.stop && options_.stop();
    if (drive_.interrupted) return false;
    if (!approach(a, off, h, wanted, out)) break;
  }
  if (!stuck_.empty()) return false;
  const Vector there = positions(), shown = there.cwiseProduct(units_);
  out.amount.assign(a.data(), a.data() + a.size());
  out.position.assign(shown.data(), shown.data() + shown.size());
  out.distance = (there - wanted).norm();
  out.reached = out.distance <= options_.tolerance;
  out.nearest = out.nearest && !out.reached;
  for (Eigen::Index i = 0; i < amounts(); ++i) {
    const double room = 1e-9 * scale_[i];
    if (a[i] - least_[i] <= room || most_[i] - a[i] <= room)
      out.at_bound.push_back(drive_.actuators[static_cast<std::size_t>(i)].effect);
  }
  drive_.steps.push_back(std::move(out));
  before_ = a;
  return true;
}

void Search::run() {
  for (std::size_t step = 0; step < drive_.targets.time.size(); ++step) {
    kept_ = world_.save();
    if (reach(step)) continue;
    drive_.reason = drive_.interrupted ? "interrupted"
                                       : "the target at time " + number(drive_.targets.time[step]) +
                                             " has no equilibrium to go on from: " + stuck_;
    return;
  }
}

}  // namespace

bool Drive::all_reached() const {
  return steps.size() == targets.time.size() &&
         std::all_of(steps.begin(), steps.end(), [](const Reached& r) { return r.reached; });
}

Result<Actuator> parse_actuator(const std::string& text) {
  Actuator out;
  const auto equals = text.rfind('=');
  out.effect = text.substr(0, equals);
  const std::string who = "--amount \"" + text + "\": ";
  if (out.effect.empty()) return Error{who + "there is no name; give NAME=LEAST:MOST:RATE"};
  if (equals == std::string::npos) return out;
  std::vector<double> numbers;
  std::size_t begin = equals + 1;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    double value = 0;
    const auto [last, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    if (error != std::errc() || last != text.data() + end || std::isnan(value))
      return Error{who + "\"" + text.substr(begin, end - begin) +
                   "\" is no number; give NAME=LEAST:MOST:RATE"};
    numbers.push_back(value);
    begin = end + 1;
  }
  if (numbers.size() < 2 || numbers.size() > 3)
    return Error{who + std::to_string(numbers.size()) +
                 " numbers; give NAME=LEAST:MOST or NAME=LEAST:MOST:RATE"};
  out.least = numbers[0];
  out.most = numbers[1];
  if (!(out.least < out.most)) return Error{who + "the least amount is not below the largest; swap them"};
  if (numbers.size() == 3) out.rate = numbers[2];
  if (!(out.rate > 0)) return Error{who + "rate = " + number(out.rate) + "; it must be positive"};
  return out;
}

Result<Drive> drive(const SceneDef& scene, std::vector<Actuator> actuators, Targets targets,
                    const DriveOptions& options) {
  SceneDef said = scene;
  if (auto r = check_actuators(said, actuators); !r) return r.failure();
  if (scene.analysis.type != AnalysisType::statics || scene.analysis.path_step) {
    return Error{
        "drive: the analysis of scene \"" + scene.name +
        "\" is not statics with fixed loads; set analysis.type to \"static\" and leave path_step out, or "
        "choose all amounts at once with --horizon"};
  }
  if (auto r = no_schedule(scene, "drive"); !r) return r.failure();
  auto built = build(scene, {.threads = options.threads});
  if (!built) return built.failure();
  Drive out;
  out.actuators = std::move(actuators);
  out.targets = std::move(targets);
  Search search(out, scene, built.value(), options);
  search.find_effects(said, built.value());
  if (auto r = search.check(); !r) return r.failure();
  search.run();
  return out;
}

Result<SceneDef> driven_scene(const SceneDef& scene, const Drive& drive) {
  if (drive.steps.empty()) return Error{"drive: no target was come to"};
  SceneDef out = scene;
  for (std::size_t i = 0; i < drive.actuators.size(); ++i) {
    Curve& amount = *find_amount(out, drive.actuators[i].effect).amount;
    if (!drive.curves.empty()) {
      amount = drive.curves[i];
      continue;
    }
    amount.points = {{0, evaluate(amount, 0)}};
    for (const Reached& r : drive.steps) amount.points.push_back({r.time, r.amount[i]});
  }
  // Steps of one length that meet all targets, where there is such a length.
  out.analysis.duration = drive.steps.back().time;
  out.analysis.step.reset();
  out.analysis.steps = drive.curves.empty() ? static_cast<int>(drive.steps.size()) : drive.increments;
  return out;
}

}  // namespace isochor::drive
