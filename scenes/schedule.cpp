// Effects that begin and end while a scene runs.
#include "scenes/schedule.h"

#include <algorithm>
#include <limits>

#include "engine/base/text.h"

namespace isochor {

namespace {

bool wanted(const ScheduledEffect& e, double t) {
  return std::any_of(e.times.begin(), e.times.end(),
                     [t](const std::array<double, 2>& span) { return t >= span[0] && t < span[1]; });
}

// In the world that is asked, without what `built` knows of it; the names of those that changed.
Result<std::string> put(World& world, const std::vector<ScheduledEffect>& effects,
                        const std::vector<bool>& there, const std::vector<bool>& want) {
  std::string changed;
  for (std::size_t k = 0; k < effects.size(); ++k) {
    if (there[k] == want[k]) continue;
    const ScheduledEffect& e = effects[k];
    changed += (changed.empty() ? "\"" : ", \"") + e.name + (want[k] ? "\" begins" : "\" ends");
    if (auto r = world.replace(e.id, want[k] ? e.effect : e.idle); !r) return r.failure();
  }
  if (changed.empty()) return changed;
  if (auto r = world.compile(); !r) return Error{changed + ": " + r.error(), r.failure().kind};
  return changed;
}

std::vector<bool> wanted(const BuiltScene& built, double t) {
  std::vector<bool> out;
  for (const ScheduledEffect& e : built.scheduled) out.push_back(wanted(e, t));
  return out;
}

void add_columns(const World& world, std::vector<Gauge>& columns) {
  for (const Gauge& g : world.gauges()) {
    const bool known = std::any_of(columns.begin(), columns.end(), [&](const Gauge& c) {
      return c.effect == g.effect && c.quantity == g.quantity;
    });
    if (!known) columns.push_back(g);
  }
}

}  // namespace

bool is_scheduled(const SceneDef& scene, const std::string& name) {
  return std::any_of(scene.schedule.begin(), scene.schedule.end(), [&](const ScheduleDef& s) {
    return std::find(s.effects.begin(), s.effects.end(), name) != s.effects.end();
  });
}

ScheduledEffect scheduled_effect(const SceneDef& scene, const std::string& name, EffectPtr effect) {
  ScheduledEffect out;
  out.name = name;
  out.effect = std::move(effect);
  out.idle = idle(name);
  for (const ScheduleDef& s : scene.schedule) {
    if (std::find(s.effects.begin(), s.effects.end(), name) == s.effects.end()) continue;
    out.times.push_back({s.from, s.to.value_or(std::numeric_limits<double>::infinity())});
  }
  return out;
}

// A copy of the world goes through all changes where it begins, so that what is refused later is refused now.
Result<void> rehearse(const SceneDef& scene, BuiltScene& built) {
  if (built.scheduled.empty()) return {};
  std::vector<double> times;
  for (const ScheduledEffect& e : built.scheduled) {
    for (const auto& span : e.times) times.insert(times.end(), span.begin(), span.end());
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  const double half = 0.5 * plan_steps(scene.analysis).h;
  auto copy = built.world.clone();
  if (!copy) return copy.failure();
  std::vector<bool> there = wanted(built, half);
  add_columns(copy.value(), built.gauge_columns);
  for (const double t : times) {
    if (!(t + half < scene.analysis.duration)) continue;
    const std::vector<bool> next = wanted(built, t + half);
    if (auto r = put(copy.value(), built.scheduled, there, next); !r)
      return Error{"schedule, at t = " + number(t) + ": " + r.error(), r.failure().kind};
    add_columns(copy.value(), built.gauge_columns);
    there = next;
  }
  return {};
}

Result<bool> follow_schedule(BuiltScene& built, double t) {
  std::vector<bool> there;
  for (const ScheduledEffect& e : built.scheduled) there.push_back(e.there);
  const std::vector<bool> want = wanted(built, t);
  auto changed = put(built.world, built.scheduled, there, want);
  if (!changed)
    return Error{"schedule, at t = " + number(built.world.time()) + ": " + changed.error(),
                 changed.failure().kind};
  for (std::size_t k = 0; k < want.size(); ++k) built.scheduled[k].there = want[k];
  return !changed.value().empty();
}

Result<void> no_schedule(const SceneDef& scene, const std::string& who) {
  if (scene.schedule.empty()) return {};
  return Error{"schedule: " + who + " does not follow one; leave it out" +
               (who == "a world of a scene" ? ", and put effects and idle() in each other's place" : "")};
}

}  // namespace isochor
