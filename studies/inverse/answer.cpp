#include "studies/inverse/answer.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/text.h"
#include "scenes/effects/kind.h"
#include "scenes/schedule.h"

namespace isochor::inverse {

using Kind = Quantity::Kind;

namespace {

const char* gauge_word(Kind kind) {
  switch (kind) {
    case Kind::volume:
      return "volume";
    case Kind::pressure:
      return "pressure";
    case Kind::length:
      return "length";
    default:
      return "tension";
  }
}

Vec3 axis_of(int component) {
  Vec3 axis{};
  axis[component] = 1;
  return axis;
}

bool changes_count(Kind kind) {
  return kind == Kind::position || kind == Kind::volume || kind == Kind::length;
}

bool touches(Kind kind) {
  return kind == Kind::contact || kind == Kind::surface_contact;
}

bool has_components(Kind kind) {
  return kind == Kind::position || kind == Kind::force || kind == Kind::moment || touches(kind);
}

double size_of(const BuiltScene& built) {
  Vec3 lower{HUGE_VAL, HUGE_VAL, HUGE_VAL}, upper = -1.0 * lower;
  for (const BodyId body : built.bodies) {
    for (const Vec3& x : built.world.rest_positions(body)) {
      for (int k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], x[k]);
        upper[k] = std::max(upper[k], x[k]);
      }
    }
  }
  const Vec3 size = upper - lower;
  return std::sqrt(dot(size, size));
}

}  // namespace

Watched::Watched(const SceneDef& scene, const BuiltScene& built, const std::vector<Quantity>& quantities)
    : length_(size_of(built)) {
  for (const Quantity& q : quantities) {
    Place place;
    place.quantity = q;
    switch (q.kind) {
      case Kind::position: {
        const std::size_t body = q.marker ? q.of : static_cast<std::size_t>(scene.probes[q.of].body);
        place.body = built.bodies[body];
        place.point = locate(built.world.mesh(place.body), q.marker ? *q.marker : scene.probes[q.of].point);
        break;
      }
      case Kind::volume:
      case Kind::pressure:
        place.effect = built.ids(cavities_kind)[q.of];
        place.effect_name = scene.cavities[q.of].name;
        break;
      case Kind::length:
      case Kind::tension:
        place.effect = built.ids(cables_kind)[q.of];
        place.effect_name = scene.cables[q.of].name;
        break;
      case Kind::contact:
        place.effect = built.ids(contacts_kind)[q.of];
        place.effect_name = scene.contacts[q.of].name;
        place.body = built.bodies[static_cast<std::size_t>(scene.contacts[q.of].body)];
        break;
      case Kind::surface_contact:
        place.effect = built.ids(surface_contacts_kind)[q.of];
        place.effect_name = scene.surface_contacts[q.of].name;
        place.body = built.bodies[static_cast<std::size_t>(scene.surface_contacts[q.of].body)];
        break;
      default:
        place.effect = built.ids(dirichlet_kind)[q.of];
    }
    places_.push_back(std::move(place));
  }
}

Vec3 Watched::vector(const World& world, const Place& place) const {
  const Kind kind = place.quantity.kind;
  if (kind == Kind::position) return place.point.at(world.positions(place.body));
  if (!touches(kind)) return world.reaction(place.effect)[kind == Kind::force ? 0 : 1];
  return {gauge(world, place, "force_x"), gauge(world, place, "force_y"), gauge(world, place, "force_z")};
}

double Watched::gauge(const World& world, const Place& place, std::string_view word) {
  for (const Gauge& one : world.gauges()) {
    if (one.effect == place.effect_name && one.quantity == word) return one.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double Watched::value(const World& world, std::size_t quantity) const {
  const Place& place = places_[quantity];
  if (has_components(place.quantity.kind)) return vector(world, place)[place.quantity.component];
  return gauge(world, place, gauge_word(place.quantity.kind));
}

double Watched::size(const World& world, std::size_t quantity) const {
  const Place& place = places_[quantity];
  const Kind kind = place.quantity.kind;
  if (kind == Kind::position) return length_;
  if (!has_components(kind)) return std::abs(value(world, quantity));
  const Vec3 whole = vector(world, place);
  return std::sqrt(dot(whole, whole));
}

Output Watched::output(std::size_t quantity) const {
  const Place& place = places_[quantity];
  const Vec3 axis = axis_of(place.quantity.component);
  switch (place.quantity.kind) {
    case Kind::position: {
      const MaterialPoint& p = place.point;
      std::vector<Vec3> weights;
      for (int k = 0; k < p.count; ++k) weights.push_back(p.weights[static_cast<std::size_t>(k)] * axis);
      return Output::positions(place.body, {p.nodes.begin(), p.nodes.begin() + p.count}, std::move(weights));
    }
    case Kind::force:
      return Output::reaction(place.effect, axis);
    case Kind::moment:
      return Output::reaction(place.effect, {}, axis);
    case Kind::contact:
    case Kind::surface_contact:
      return Output::effect_force(place.effect, place.body, axis);
    default:
      return Output::gauge(place.effect, gauge_word(place.quantity.kind));
  }
}

namespace {

// The rows of one time.
Result<void> differentiate(World& world, const Watched& watched, const Data& data,
                           const std::vector<Parameter>& parameters, std::size_t first, std::size_t last,
                           Answer& out) {
  GradientQuery query;
  query.parameters = parameters;
  for (std::size_t i = first; i < last; ++i) query.outputs.push_back(watched.output(data.values[i].quantity));
  auto told = world.gradients(query);
  if (!told) return told.failure();
  if (!told.value().regular) {
    out.regular = false;
    out.note = told.value().note;
  }
  for (std::size_t i = first; i < last; ++i) {
    Eigen::Index column = 0;
    for (const std::vector<double>& numbers : told.value().by[i - first]) {
      for (const double d : numbers) {
        if (column >= out.jacobian.cols())
          out.jacobian.conservativeResize(static_cast<Eigen::Index>(data.values.size()), column + 1);
        out.jacobian(static_cast<Eigen::Index>(i), column++) = d;
      }
    }
  }
  return {};
}

std::size_t numbers_of(const std::vector<Parameter>& parameters, const World& world) {
  std::size_t n = 0;
  for (const Parameter& p : parameters)
    n += p.kind == Parameter::Kind::cells ? static_cast<std::size_t>(world.mesh(p.body).cell_count()) : 1;
  return n;
}

}  // namespace

Result<Answer> answer(const SceneDef& scene, const Data& data, const ParametersOf& parameters, int threads) {
  if (auto r = no_schedule(scene, "a search for constants"); !r) return r.failure();
  auto made = build(scene, {.threads = threads});
  if (!made) return made.failure();
  BuiltScene built = std::move(made).value();
  std::vector<Parameter> asked;
  if (parameters) {
    auto list = parameters(built);
    if (!list) return list.failure();
    asked = std::move(list).value();
  }
  const Watched watched(scene, built, data.quantities);
  const auto n = static_cast<Eigen::Index>(data.values.size());
  Answer out;
  out.rest.resize(n);
  out.values.resize(n);
  out.sizes.setZero(n);
  out.jacobian.setZero(n, static_cast<Eigen::Index>(numbers_of(asked, built.world)));
  for (std::size_t i = 0; i < data.values.size(); ++i)
    out.rest[static_cast<Eigen::Index>(i)] = watched.value(built.world, data.values[i].quantity);
  std::size_t at = 0;
  for (std::size_t step = 0; step < data.time.size(); ++step) {
    const StepReport report = built.world.advance(data.time[step] - built.world.time());
    if (report.status != StepStatus::converged) {
      out.reason = "at time " + number(data.time[step]) + ": " + report.reason;
      return out;
    }
    const std::size_t first = at;
    for (; at < data.values.size() && data.values[at].step == step; ++at) {
      const auto row = static_cast<Eigen::Index>(at);
      out.values[row] = watched.value(built.world, data.values[at].quantity);
      out.sizes[row] = watched.size(built.world, data.values[at].quantity);
    }
    if (!parameters || at == first) continue;
    if (auto r = differentiate(built.world, watched, data, asked, first, at, out); !r) return r.failure();
  }
  out.found = true;
  return out;
}

Eigen::VectorXd scales(const Data& data, const Answer& first) {
  constexpr double rounding = 1e-9;
  std::map<Kind, double> largest;
  const auto kind_of = [&](std::size_t i) { return data.quantities[data.values[i].quantity].kind; };
  for (std::size_t i = 0; i < data.values.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double from = changes_count(kind_of(i)) ? first.rest[at] : 0;
    double& most = largest[kind_of(i)];
    most = std::max({most, std::abs(data.values[i].value - from), rounding * first.sizes[at]});
  }
  Eigen::VectorXd out(first.rest.size());
  for (std::size_t i = 0; i < data.values.size(); ++i) {
    const double most = largest[kind_of(i)];
    out[static_cast<Eigen::Index>(i)] = most > 0 ? most : 1;
  }
  return out;
}

Result<void> check_units(const SceneDef& scene, const Data& data, const Answer& first) {
  constexpr double farthest = 10, differs = 300;
  auto built = build(scene, {.threads = 1});
  if (!built) return built.failure();
  const double length = size_of(built.value());
  std::map<Kind, std::pair<double, double>> largest;  // measured, computed
  for (std::size_t i = 0; i < data.values.size(); ++i) {
    const Datum& datum = data.values[i];
    const Quantity& q = data.quantities[datum.quantity];
    const auto at = static_cast<Eigen::Index>(i);
    const std::string what = data.source + ": " + q.name + " = " + number(datum.value) +
                             " at t = " + number(data.time[datum.step]);
    const double away = std::abs(datum.value - first.rest[at]);
    if (q.kind == Kind::position && away > farthest * length) {
      return Error{what + " is " + number(away) + " m from where it is at rest, and the scene is " +
                   number(length) + " m across; positions are in meters"};
    }
    const double ratio = datum.value / first.rest[at];
    if ((q.kind == Kind::volume || q.kind == Kind::length) && !(ratio > 0.01 && ratio < 100)) {
      return Error{what + ", and at rest it is " + number(first.rest[at]) + " " + unit_of(q.kind) +
                   "; give " + unit_of(q.kind)};
    }
    if (changes_count(q.kind)) continue;
    auto& [measured, computed] = largest[q.kind];
    measured = std::max(measured, std::abs(datum.value));
    computed = std::max(computed, std::abs(first.values[at]));
  }
  for (const auto& [kind, pair] : largest) {
    const auto [measured, computed] = pair;
    if (!(computed > 0) || !(measured > 0) ||
        (measured < differs * computed && computed < differs * measured))
      continue;
    return Error{data.source + ": the largest measured number in " + unit_of(kind) + " is " +
                 number(measured) + ", and the scene answers " + number(computed) +
                 "; give SI units, or begin closer with --set"};
  }
  return {};
}

Result<void> check_statics(const SceneDef& scene, const char* who) {
  if (scene.analysis.type == AnalysisType::statics && !scene.analysis.path_step) return {};
  return Error{std::string(who) + ": the analysis of scene \"" + scene.name +
               "\" is not statics with fixed loads; set analysis.type to \"static\" and leave path_step out"};
}

}  // namespace isochor::inverse
