// Outline of a fit:
//   1. where each constant is now, and how it goes to the search: as its logarithm where it is positive and
//      stays so, else over its size
//   2. at the start: units, constants that nothing depends on
//   3. search: scenes are built with the constants of a trial and go through the times of their data;
//   Jacobians
//      from World::gradients at each time, or from ways beside it where scenes remember theirs
//   4. at the end: intervals, what cannot be told apart, bounds
#include "studies/fit/scene_fit.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "engine/base/text.h"
#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"
#include "scenes/parameters_by_keys.h"
#include "scenes/scene_file.h"
#include "studies/inverse/intervals.h"
#include "studies/inverse/search.h"

namespace isochor::fit {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

std::string override_text(const std::string& path, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return path + "=" + text;
}

// "bodies[0].materials[1].young" or "springs[0].stiffness" in its parts.
struct Place {
  const EffectKind* kind = nullptr;  // of an effect, which is the one of its number
  std::size_t effect = 0;
  std::size_t body = 0, material = 0;
  std::string key;
  bool in(const SceneDef& scene) const {
    if (kind) return effect < kind->size(scene);
    return body < scene.bodies.size() && material < scene.bodies[body].materials.size();
  }
};

Result<Place> place_of(const std::string& path) {
  Place out;
  unsigned body = 0, material = 0;
  int length = 0;
  const auto rest = [&] { return path.size() > static_cast<std::size_t>(length) && length > 0; };
  if (std::sscanf(path.c_str(), "bodies[%u].materials[%u].%n", &body, &material, &length) == 2 && rest()) {
    out.body = body;
    out.material = material;
    out.key = path.substr(static_cast<std::size_t>(length));
    return out;
  }
  for (const EffectKind* kind : effect_kinds) {
    length = 0;
    if (std::sscanf(path.c_str(), (kind->key + std::string("[%u].%n")).c_str(), &body, &length) != 1 ||
        !rest())
      continue;
    out.kind = kind;
    out.effect = body;
    out.key = path.substr(static_cast<std::size_t>(length));
    return out;
  }
  return Error{"fit: --constant " + path +
               " is no number of a material or an effect; give a path such as bodies[0].materials[0].young "
               "or springs[0].stiffness"};
}

// An effect of a scene as its keys make it.
Result<EffectPtr> effect_of(const SceneDef& scene, const Place& place) {
  std::vector<EffectPtr> made;
  EffectAdder adder(scene, [&](const EffectKind&, EffectPtr effect) -> Result<void> {
    made.push_back(std::move(effect));
    return {};
  });
  if (auto r = place.kind->add(*place.kind, adder); !r) return r.failure();
  if (place.effect < made.size()) return made[place.effect];
  return Error{place.kind->key + std::string(" has no entry ") + std::to_string(place.effect)};
}

// What is on the way has a say in what comes later: then gradients at the equilibria are not those of the
// way.
bool remembers(const SceneDef& scene) {
  const auto rubs = [](const auto& contact) { return contact.friction > 0; };
  const auto filled = [](const CavityDef& c) {
    return c.control == CavityControl::gas || c.control == CavityControl::liquid;
  };
  for (const SceneBody& body : scene.bodies) {
    for (const MaterialDef& m : body.materials) {
      if (!m.prony.empty() || m.mullins) return true;
    }
  }
  return std::any_of(scene.contacts.begin(), scene.contacts.end(), rubs) ||
         std::any_of(scene.surface_contacts.begin(), scene.surface_contacts.end(), rubs) ||
         std::any_of(scene.cavities.begin(), scene.cavities.end(), filled);
}

Result<double> value_now(const SceneDef& scene, const std::string& path, const Place& place) {
  // Scenes leave a density out that is the usual one.
  if (!place.kind && place.key == "density" && place.in(scene))
    return scene.bodies[place.body].materials[place.material].density;
  const auto number = number_in_keys(to_json(scene), path);
  if (!number) return number.failure();
  return number.value().value;
}

// How a constant goes to the search.
struct Unknown {
  std::string path;
  Place place;
  bool logarithm = false;
  double unit = 1, start = 0;  // value = unit exp(x), or unit x
  double least = 0, most = 0;  // of x
  double value(double x) const { return logarithm ? unit * std::exp(x) : unit * x; }
  double slope(double x) const { return logarithm ? value(x) : unit; }
};

Result<Unknown> unknown_of(const Sought& sought, const std::vector<Experiment>& experiments) {
  auto place = place_of(sought.path);
  if (!place) return place.failure();
  Unknown u{sought.path, std::move(place).value()};
  bool found = false;
  std::string why;
  for (const Experiment& e : experiments) {
    auto here = value_now(e.scene, sought.path, u.place);
    if (!here) {
      why = here.error();
      continue;
    }
    const double value = here.value();
    if (found && value != u.start) {
      return Error{"fit: --constant " + sought.path + " begins at " + isochor::number(u.start) + " and at " +
                   isochor::number(value) + " in two scenes; give both the same with --set"};
    }
    u.start = value;
    found = true;
  }
  if (!found) return Error{"fit: --constant " + sought.path + ": no scene has it: " + why};
  const bool ratio = u.place.key == "poisson";
  u.logarithm = u.start > 0 && !ratio && sought.least.value_or(1) > 0;
  const double least = sought.least.value_or(u.logarithm ? 1e-3 * u.start : ratio ? 0 : -HUGE_VAL);
  const double most = sought.most.value_or(u.logarithm ? 1e3 * u.start : ratio ? 0.5 : HUGE_VAL);
  if (!(u.start >= least && u.start <= most)) {
    return Error{"fit: --constant " + sought.path + " begins at " + number(u.start) +
                 ", outside of its bounds " + number(least) + " to " + number(most) +
                 "; widen them, or begin elsewhere with --set"};
  }
  u.unit = u.logarithm || u.start != 0 ? std::abs(u.start) : 1;
  u.least = u.logarithm ? std::log(least / u.unit) : least / u.unit;
  u.most = u.logarithm ? std::log(most / u.unit) : most / u.unit;
  return u;
}

class SceneSearch {
 public:
  SceneSearch(const std::vector<Experiment>& experiments, std::vector<Unknown> unknowns,
              const SceneFitOptions& options)
      : experiments_(experiments), unknowns_(std::move(unknowns)), options_(options) {
    for (const Experiment& e : experiments) rows_ += static_cast<Eigen::Index>(e.data.values.size());
  }

  Result<void> begin();
  SceneFit run();

 private:
  Eigen::Index count() const { return static_cast<Eigen::Index>(unknowns_.size()); }
  Result<SceneDef> scene_at(const Experiment& e, const Vector& x) const;
  inverse::ParametersOf parameters_of(const Experiment& e, const SceneDef& scene, const Vector& x) const;
  // How what is measured changes with the unknowns, a column each that the scene has: of scenes that remember
  // the way from ways beside it.
  Result<inverse::Answer> answer_at(const Experiment& e, const Vector& x, bool with_jacobian) const;
  Result<Matrix> differences(const Experiment& e, const Vector& x) const;
  // Of all experiments: answers over their scales, and errors.
  Result<bool> errors(const Vector& x, Vector& r, Matrix* jacobian);
  void tell(const Vector& x, const Matrix& jacobian, double cost, SceneFit& out) const;

  const std::vector<Experiment>& experiments_;
  std::vector<Unknown> unknowns_;
  const SceneFitOptions& options_;
  Eigen::Index rows_ = 0;
  std::vector<Vector> scale_;  // by experiment
  std::vector<inverse::Answer> last_;
  std::string refused_, note_;
};

Result<SceneDef> SceneSearch::scene_at(const Experiment& e, const Vector& x) const {
  Overrides overrides;
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Unknown& u = unknowns_[static_cast<std::size_t>(i)];
    if (u.place.in(e.scene)) overrides.push_back(override_text(u.path, u.value(x[i])));
  }
  return override_scene(e.scene, overrides);
}

inverse::ParametersOf SceneSearch::parameters_of(const Experiment& e, const SceneDef& scene,
                                                 const Vector& x) const {
  return [this, &e, &scene, x](const BuiltScene& built) -> Result<std::vector<Parameter>> {
    std::vector<Parameter> out;
    for (Eigen::Index i = 0; i < count(); ++i) {
      const Unknown& u = unknowns_[static_cast<std::size_t>(i)];
      if (!u.place.in(e.scene)) continue;
      if (u.place.kind) {
        const EffectId effect = built.ids(*u.place.kind)[u.place.effect];
        out.push_back(
            Parameter::constant_of(effect, u.value(x[i]), [&u, &scene](double value) -> Result<EffectPtr> {
              const auto changed = override_scene(scene, {override_text(u.path, value)});
              if (!changed) return changed.failure();
              return effect_of(changed.value(), u.place);
            }));
        continue;
      }
      const BodyId body = built.bodies[u.place.body];
      const std::string& region = scene.bodies[u.place.body].materials[u.place.material].region;
      if (u.place.key == "density") {
        out.push_back(Parameter::density(body, region));
        continue;
      }
      out.push_back(Parameter::material(
          body, region, u.value(x[i]), [&u, &scene, &built, body](double value) -> Result<MaterialPtr> {
            const auto changed = override_scene(scene, {override_text(u.path, value)});
            if (!changed) return changed.failure();
            auto def = refined_numbers(changed.value().bodies[u.place.body].materials[u.place.material],
                                       scene.folder, built.parents[u.place.body]);
            if (!def) return def.failure();
            return make_material(def.value(), scene.folder, &built.world.mesh(body));
          }));
    }
    return out;
  };
}

Result<inverse::Answer> SceneSearch::answer_at(const Experiment& e, const Vector& x,
                                               bool with_jacobian) const {
  const auto scene = scene_at(e, x);
  if (!scene) return scene.failure();
  const bool beside = remembers(scene.value());
  auto told =
      inverse::answer(scene.value(), e.data,
                      with_jacobian && !beside ? parameters_of(e, scene.value(), x) : inverse::ParametersOf(),
                      options_.threads);
  if (!told || !told.value().found || !with_jacobian || !beside) return told;
  auto jacobian = differences(e, x);
  if (!jacobian) return jacobian.failure();
  told.value().jacobian = std::move(jacobian).value();
  return told;
}

Result<Eigen::MatrixXd> SceneSearch::differences(const Experiment& e, const Vector& x) const {
  constexpr double apart = 1e-4;  // of what goes to the search, which is about 1
  Matrix out(static_cast<Eigen::Index>(e.data.values.size()), count());
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Unknown& u = unknowns_[static_cast<std::size_t>(i)];
    if (!u.place.in(e.scene)) continue;
    Vector less = x, more = x;
    less[i] = std::max(u.least, x[i] - apart);
    more[i] = std::min(u.most, x[i] + apart);
    std::array<Vector, 2> values;
    for (const bool up : {false, true}) {
      const auto scene = scene_at(e, up ? more : less);
      if (!scene) return scene.failure();
      auto told = inverse::answer(scene.value(), e.data, {}, options_.threads);
      if (!told) return told.failure();
      if (!told.value().found) return Error{"beside " + u.path + " " + told.value().reason};
      values[up ? 1 : 0] = std::move(told.value().values);
    }
    out.col(column++) = (values[1] - values[0]) / (u.value(more[i]) - u.value(less[i]));
  }
  return Matrix(out.leftCols(column));
}

Result<bool> SceneSearch::errors(const Vector& x, Vector& r, Matrix* jacobian) {
  r.resize(rows_);
  if (jacobian) jacobian->setZero(rows_, count());
  std::vector<inverse::Answer> answers;
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    const Experiment& e = experiments_[k];
    auto told = answer_at(e, x, jacobian != nullptr);
    if (!told) return Error{e.name + ": " + told.error()};
    inverse::Answer& a = told.value();
    if (!a.found) {
      note_ = e.name + ": " + a.reason;
      return false;
    }
    if (scale_.size() <= k) scale_.push_back(inverse::scales(e.data, a));
    const auto n = static_cast<Eigen::Index>(e.data.values.size());
    const double share = std::sqrt(e.weight / static_cast<double>(n));
    const Vector weight = share * scale_[k].cwiseInverse();
    for (Eigen::Index i = 0; i < n; ++i)
      r[row + i] = weight[i] * (a.values[i] - e.data.values[static_cast<std::size_t>(i)].value);
    Eigen::Index column = 0;
    for (Eigen::Index i = 0; jacobian && i < count(); ++i) {
      const Unknown& u = unknowns_[static_cast<std::size_t>(i)];
      if (!u.place.in(e.scene)) continue;
      jacobian->block(row, i, n, 1) = u.slope(x[i]) * weight.cwiseProduct(a.jacobian.col(column++));
    }
    row += n;
    answers.push_back(std::move(a));
  }
  last_ = std::move(answers);
  return true;
}

// What the data and the start must be for a search to mean something.
Result<void> SceneSearch::begin() {
  if (rows_ < count()) {
    return Error{"fit: the data have " + std::to_string(rows_) + " numbers for " + std::to_string(count()) +
                 " constants; give more data or seek fewer constants"};
  }
  Vector x(count()), r;
  for (Eigen::Index i = 0; i < count(); ++i)
    x[i] = unknowns_[static_cast<std::size_t>(i)].logarithm
               ? 0
               : unknowns_[static_cast<std::size_t>(i)].start / unknowns_[static_cast<std::size_t>(i)].unit;
  Matrix jacobian;
  const auto found = errors(x, r, &jacobian);
  if (!found) return found.failure();
  if (!found.value())
    return Error{"fit: the scene has no equilibrium at the start: " + note_ + "; begin elsewhere with --set"};
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    if (auto u = inverse::check_units(experiments_[k].scene, experiments_[k].data, last_[k]); !u) return u;
  }
  const double most = jacobian.colwise().norm().maxCoeff();
  for (Eigen::Index i = 0; i < count(); ++i) {
    if (jacobian.col(i).norm() > 1e-12 * std::max(most, 1e-300)) continue;
    return Error{"fit: nothing that was measured depends on " + unknowns_[static_cast<std::size_t>(i)].path +
                 "; leave it out, or measure something that does"};
  }
  return {};
}

SceneFit SceneSearch::run() {
  inverse::SearchProblem problem;
  problem.errors = rows_;
  problem.start.resize(count());
  problem.least.resize(count());
  problem.most.resize(count());
  problem.prior = Vector::Zero(count());
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Unknown& u = unknowns_[static_cast<std::size_t>(i)];
    problem.start[i] = u.logarithm ? 0 : u.start / u.unit;
    problem.least[i] = u.least;
    problem.most[i] = u.most;
  }
  problem.evaluate = [&](const Vector& x, Vector& r, Matrix* jacobian) {
    const auto found = errors(x, r, jacobian);
    if (!found) refused_ = found.error();
    return found && found.value();
  };
  inverse::SearchOptions how;
  how.max_iterations = options_.max_iterations;
  how.stop = options_.stop;
  double weights = 0;
  for (const Experiment& e : experiments_) weights += e.weight;
  how.on_iteration = [&](int iteration, double cost, const Vector&) {
    if (options_.on_iteration) options_.on_iteration(iteration, std::sqrt(2 * cost / weights));
  };
  const inverse::Search found = inverse::search(problem, how);
  SceneFit out;
  out.converged = found.converged;
  out.interrupted = found.interrupted;
  out.iterations = found.iterations;
  out.reason = found.converged ? "" : "no minimum was found: " + (refused_.empty() ? found.reason : refused_);
  Vector r;
  Matrix jacobian;
  const auto there = errors(found.x, r, &jacobian);
  if (!there || !there.value()) {
    out.converged = false;
    out.reason = there ? note_ : there.error();
    return out;
  }
  tell(found.x, jacobian, r.squaredNorm(), out);
  return out;
}

void SceneSearch::tell(const Vector& x, const Matrix& jacobian, double squares, SceneFit& out) const {
  double weights = 0;
  for (const Experiment& e : experiments_) weights += e.weight;
  out.rms = std::sqrt(squares / weights);
  std::vector<char> held;
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Unknown& u = unknowns_[static_cast<std::size_t>(i)];
    const double room = 1e-9 * std::max(1.0, std::abs(x[i]));
    const bool at_bound = x[i] <= u.least + room || x[i] >= u.most - room;
    held.push_back(at_bound ? 1 : 0);
    out.constants.push_back({u.path, "", u.value(x[i]), 0, at_bound});
    out.start.push_back(u.start);
    if (at_bound) out.warnings.push_back(u.path + " is at the end of its range");
  }
  const double freedom = static_cast<double>(rows_ - count());
  const inverse::Known known = inverse::known_from(jacobian, freedom > 0 ? squares / freedom : 0, held);
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    out.constants[i].half_width = freedom > 0
                                      ? inverse::student(freedom) * std::sqrt(known.covariance(at, at)) *
                                            std::abs(unknowns_[i].slope(x[at]))
                                      : HUGE_VAL;
  }
  for (const std::vector<std::size_t>& moved : known.not_apart) {
    std::string names;
    for (const std::size_t i : moved) names += (names.empty() ? "" : " and ") + unknowns_[i].path;
    out.warnings.push_back(names +
                           " cannot be told apart by these data; seek fewer constants or measure "
                           "something else");
  }
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    const Experiment& e = experiments_[k];
    double sum = 0;
    for (std::size_t i = 0; i < e.data.values.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const double off = (last_[k].values[at] - e.data.values[i].value) / scale_[k][at];
      sum += off * off;
    }
    out.experiment_rms.push_back(std::sqrt(sum / static_cast<double>(e.data.values.size())));
    out.fitted.push_back(last_[k].values);
    if (!last_[k].regular) out.warnings.push_back(e.name + ": " + last_[k].note);
    if (auto scene = scene_at(e, x)) out.scenes.push_back(std::move(scene).value());
  }
}

}  // namespace

Result<Sought> parse_sought(const std::string& text) {
  Sought out;
  const auto equals = text.find('=');
  out.path = text.substr(0, equals);
  const std::string who = "--constant \"" + text + "\": ";
  if (out.path.empty()) return Error{who + "there is no path; give PATH=LEAST:MOST"};
  if (equals == std::string::npos) return out;
  const auto colon = text.find(':', equals);
  if (colon == std::string::npos) return Error{who + "there is one bound; give PATH=LEAST:MOST"};
  const auto least = inverse::number_in(text.substr(equals + 1, colon - equals - 1), who);
  if (!least) return least.failure();
  const auto most = inverse::number_in(text.substr(colon + 1), who);
  if (!most) return most.failure();
  if (!(least.value() < most.value()))
    return Error{who + "the least value is not below the largest; swap them"};
  out.least = least.value();
  out.most = most.value();
  return out;
}

Result<SceneFit> fit_scenes(const std::vector<Experiment>& experiments, const std::vector<Sought>& constants,
                            const SceneFitOptions& options) {
  if (constants.empty()) return Error{"fit: no constant is sought; name at least one with --constant"};
  std::vector<Unknown> unknowns;
  for (const Experiment& e : experiments) {
    if (auto r = inverse::check_statics(e.scene, "fit"); !r) return r.failure();
  }
  for (const Sought& sought : constants) {
    for (const Unknown& u : unknowns) {
      if (u.path == sought.path) return Error{"fit: --constant " + u.path + " is there twice; keep one"};
    }
    auto u = unknown_of(sought, experiments);
    if (!u) return u.failure();
    unknowns.push_back(std::move(u).value());
  }
  SceneSearch search(experiments, std::move(unknowns), options);
  if (auto r = search.begin(); !r) return r.failure();
  return search.run();
}

}  // namespace isochor::fit
