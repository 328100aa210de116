#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "scenes/check_parts.h"
#include "scenes/effects/kind.h"

namespace isochor {

namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", v);
  return text;
}

// Of a list whose items have names; `seen`: what is used already.
template <class NameOf>
Result<void> check_names(const std::string& list, std::size_t size, NameOf name_of,
                         std::set<std::string>& seen) {
  for (std::size_t i = 0; i < size; ++i) {
    const std::string& name = name_of(i);
    if (auto r = check_name(place(list, i), name); !r) return r;
    if (!seen.insert(name).second)
      return Error{place(list, i) + ".name = \"" + name + "\" is used already; names must differ"};
  }
  return {};
}

template <class T>
Result<void> check_names(const std::string& list, const std::vector<T>& items) {
  std::set<std::string> seen;
  return check_names(
      list, items.size(), [&](std::size_t i) -> const std::string& { return items[i].name; }, seen);
}

Result<void> check_all_names(const SceneDef& s) {
  if (auto r = check_name("scene", s.name); !r) return r;
  if (auto r = check_names("bodies", s.bodies); !r) return r;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const std::string body = place("bodies", b);
    if (auto r = check_names(body + ".surfaces", s.bodies[b].surfaces); !r) return r;
    if (auto r = check_names(body + ".node_sets", s.bodies[b].node_sets); !r) return r;
  }
  if (auto r = check_names("probes", s.probes); !r) return r;
  if (auto r = check_names("metrics", s.metrics); !r) return r;
  // Effects and orientations share one set of names: reactions and gauges are told apart by them.
  std::set<std::string> seen;
  for (const EffectKind* kind : effect_kinds) {
    const auto name_of = [&](std::size_t i) -> const std::string& { return kind->name(s, i); };
    if (auto r = check_names(kind->key, kind->size(s), name_of, seen); !r) return r;
  }
  const auto name_of = [&](std::size_t i) -> const std::string& { return s.orientations[i].name; };
  return check_names("orientations", s.orientations.size(), name_of, seen);
}

Result<void> check_all_curves(const SceneDef& s) {
  if (auto r = check_curve("gravity_amount", s.analysis.options.gravity_curve); !r) return r;
  for (const EffectKind* kind : effect_kinds) {
    if (auto r = kind->check(*kind, s); !r) return r;
  }
  return {};
}

template <class T>
bool has(const std::vector<T>& items, const std::string& name) {
  return std::any_of(items.begin(), items.end(), [&](const T& t) { return t.name == name; });
}

template <class T>
Result<void> require(const std::string& where, const char* what, const std::vector<T>& items,
                     const std::string& name) {
  if (has(items, name)) return {};
  std::string known;
  for (const T& t : items) known += (known.empty() ? "" : ", ") + ("\"" + t.name + "\"");
  return Error{where + ".of = \"" + name + "\" names no " + what + "; the scene has " +
               (known.empty() ? "none" : known)};
}

// "body.region" names a body too; names of bodies may have dots.
std::string body_of_part(const SceneDef& s, const std::string& of) {
  for (const SceneBody& b : s.bodies) {
    if (of.starts_with(b.name + ".")) return b.name;
  }
  return of;
}

Result<void> check_metric(const SceneDef& s, const MetricDef& m, const std::string& where) {
  switch (m.quantity) {
    case Quantity::displacement:
      if (has(s.orientations, m.of)) return {};
      return require(where, "probe", s.probes, m.of);
    case Quantity::orientation_angle:
    case Quantity::orientation_axis:
    case Quantity::orientation_normal:
      return require(where, "orientation", s.orientations, m.of);
    case Quantity::linear_momentum:
    case Quantity::angular_momentum:
      return m.of.empty() ? Result<void>{} : require(where, "body", s.bodies, m.of);
    case Quantity::volume_change:
    case Quantity::volume:
    case Quantity::min_J:
    case Quantity::max_J:
      // Regions are known when the meshes are read: build() looks at them.
      return m.of.empty() ? Result<void>{} : require(where, "body", s.bodies, body_of_part(s, m.of));
    case Quantity::cavity_pressure:
    case Quantity::cavity_volume:
      return require(where, "cavity", s.cavities, m.of);
    case Quantity::cable_tension:
    case Quantity::cable_length:
      return require(where, "cable", s.cables, m.of);
    case Quantity::rigid_x:
    case Quantity::rigid_y:
    case Quantity::rigid_z:
      return require(where, "rigid body", s.rigid_bodies, m.of);
    case Quantity::contact_force:
    case Quantity::contact_area:
    case Quantity::contact_pressure:
    case Quantity::contact_gap:
      if (has(s.surface_contacts, m.of)) return {};
      return require(where, "contact", s.contacts, m.of);
    case Quantity::reaction_force:
    case Quantity::reaction_moment:
      return require(where, "dirichlet support", s.dirichlet, m.of);
    default:
      break;
  }
  if (!m.of.empty())
    return Error{where + ".of = \"" + m.of + "\": this quantity is of the whole scene; leave it out"};
  return {};
}

Result<void> check_metrics(const SceneDef& s) {
  const StepPlan plan = plan_steps(s.analysis);
  for (std::size_t i = 0; i < s.metrics.size(); ++i) {
    const MetricDef& m = s.metrics[i];
    const std::string where = place("metrics", i);
    if (auto r = check_metric(s, m, where); !r) return r;
    if (m.tolerance && !(*m.tolerance >= 0 && std::isfinite(*m.tolerance))) {
      return Error{where + ".tolerance = " + number(*m.tolerance) + "; it must be zero or positive"};
    }
    if (!std::isfinite(m.scale) || (m.reference && !std::isfinite(*m.reference)))
      return Error{where + ": scale and reference must be finite numbers"};
    if (!m.time) continue;
    const double steps = *m.time / plan.h;
    if (steps < 0.5 || steps > plan.steps + 0.5 || std::abs(steps - std::round(steps)) > 1e-6) {
      return Error{where + ".time = " + number(*m.time) +
                   " is not the end of a step; steps end at multiples of " + number(plan.h) + " up to " +
                   number(s.analysis.duration)};
    }
  }
  return {};
}

// An effect of the scene, or why it can have no schedule.
Result<void> check_scheduled(const SceneDef& s, const std::string& where, const std::string& name) {
  std::string known;
  for (const EffectKind* kind : effect_kinds) {
    const bool always = kind == &volumes_kind || kind == &rigid_bodies_kind;
    for (std::size_t i = 0; i < kind->size(s); ++i) {
      if (kind->name(s, i) != name) {
        if (!always) known += (known.empty() ? "\"" : ", \"") + kind->name(s, i) + "\"";
        continue;
      }
      if (!always) return {};
      return Error{where + ": \"" + name + "\" is one of " + kind->key +
                   ", which are there from the beginning to the end; take it out of the schedule"};
    }
  }
  return Error{where + ": there is no effect \"" + name + "\"; the scene has " +
               (known.empty() ? "none" : known)};
}

Result<void> check_schedule(const SceneDef& s) {
  if (s.schedule.empty()) return {};
  if (s.analysis.path_step) {
    return Error{
        "schedule: along a path (analysis.path_step) the load factor goes to and fro, so that nothing begins "
        "or "
        "ends at a time; leave one of the two out"};
  }
  const StepPlan plan = plan_steps(s.analysis);
  const auto ends_step = [&](double t) {
    const double steps = t / plan.h;
    return std::abs(steps - std::round(steps)) < 1e-6;
  };
  for (std::size_t i = 0; i < s.schedule.size(); ++i) {
    const ScheduleDef& d = s.schedule[i];
    const std::string where = place("schedule", i);
    if (d.effects.empty()) return Error{where + ".effects is empty; name those that begin or end"};
    for (const std::string& name : d.effects) {
      if (auto r = check_scheduled(s, where + ".effects", name); !r) return r;
    }
    if (!(d.from >= 0) || !std::isfinite(d.from) || (d.to && !(*d.to > d.from))) {
      return Error{where + ": from = " + number(d.from) + (d.to ? ", to = " + number(*d.to) : "") +
                   "; from is 0 or later, and to comes after it"};
    }
    for (const auto& [key, t] : {std::pair(".from", d.from), {".to", d.to.value_or(0)}}) {
      if (ends_step(t)) continue;
      return Error{where + key + " = " + number(t) + " is not the end of a step; steps end at multiples of " +
                   number(plan.h) + ", choose analysis.steps so that they do there"};
    }
  }
  return {};
}

Result<void> check_bodies(const SceneDef& s) {
  if (s.bodies.empty()) return Error{"bodies is empty; a scene needs at least one body"};
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    if (auto r = check_body(place("bodies", b), s.bodies[b]); !r) return r;
  }
  return {};
}

Result<void> check_probes(const SceneDef& s) {
  for (std::size_t i = 0; i < s.probes.size(); ++i) {
    const Vec3& p = s.probes[i].point;
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return Error{place("probes", i) + ".point has a coordinate that is no finite number"};
    const auto b = static_cast<Index>(s.probes[i].body);
    if (b < 0 || static_cast<std::size_t>(b) >= s.bodies.size())
      return Error{place("probes", i) + ".body: there is no body number " + std::to_string(b)};
  }
  return {};
}

Result<void> check_outputs(const OutputDef& o) {
  if (o.every < 0)
    return Error{"outputs.every = " + std::to_string(o.every) + "; give 0 (no frames) or a number of steps"};
  if (o.checkpoint_steps < 0) {
    return Error{"outputs.checkpoint_steps = " + std::to_string(o.checkpoint_steps) +
                 "; give 0 (none) or a number of steps"};
  }
  if (!(o.checkpoint_seconds >= 0) || !std::isfinite(o.checkpoint_seconds)) {
    return Error{"outputs.checkpoint_seconds = " + number(o.checkpoint_seconds) +
                 " s; give 0 (none) or a positive number"};
  }
  return {};
}

}  // namespace

StepPlan plan_steps(const AnalysisDef& a) {
  const int steps = a.step ? std::max(1, static_cast<int>(std::lround(a.duration / *a.step))) : a.steps;
  return {steps, a.duration / steps};
}

Result<void> check_scene(const SceneDef& s) {
  if (auto r = check_bodies(s); !r) return r;
  if (auto r = check_probes(s); !r) return r;
  if (auto r = check_all_names(s); !r) return r;
  if (auto r = check_analysis("analysis", s.analysis); !r) return r;
  if (auto r = check_all_curves(s); !r) return r;
  if (auto r = check_schedule(s); !r) return r;
  if (auto r = check_outputs(s.outputs); !r) return r;
  return check_metrics(s);
}

}  // namespace isochor
