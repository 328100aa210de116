#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "scenes/scene.h"

namespace isochor {

namespace {

constexpr int kMostSteps = 1'000'000;

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", v);
  return text;
}

std::string place(const char* list, std::size_t i) {
  return std::string(list) + "[" + std::to_string(i) + "]";
}

// A name fit for a message: what would end or garble a line is shown as a question mark.
std::string printable(std::string text) {
  for (char& c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x20 || u == 0x7f) c = '?';
  }
  return text;
}

// Names become file names, CSV columns and keys of the summary.
Result<void> check_name(const std::string& where, const std::string& name) {
  if (name.empty()) return Error{where + ".name is empty; give it a name"};
  if (name.size() > 100)
    return Error{where + ".name has " + std::to_string(name.size()) + " characters; 100 are allowed"};
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x20 || u == 0x7f) {
      char code[8];
      std::snprintf(code, sizeof code, "U+%04X", u);
      return Error{where + ".name = \"" + printable(name) + "\" has the control character " + code +
                   ", which file names and tables cannot hold; remove it"};
    }
    if (c == '/' || c == '\\' || c == '"' || c == ',') {
      return Error{where + ".name = \"" + printable(name) + "\" has the character '" + c +
                   "', which file names or tables cannot hold; take another"};
    }
  }
  return {};
}

template <class T, class Name>
Result<void> check_names(const char* list, const std::vector<T>& items, Name name_of,
                         std::set<std::string>& seen) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string& name = name_of(items[i]);
    if (auto r = check_name(place(list, i), name); !r) return r;
    if (!seen.insert(name).second) {
      return Error{place(list, i) + ".name = \"" + name + "\" is used already; names must differ"};
    }
  }
  return {};
}

template <class T>
Result<void> check_names(const char* list, const std::vector<T>& items) {
  std::set<std::string> seen;
  return check_names(
      list, items, [](const T& t) -> const std::string& { return t.name; }, seen);
}

Result<void> check_all_names(const SceneDef& s) {
  if (auto r = check_name("scene", s.name); !r) return r;
  if (auto r = check_names("bodies", s.bodies); !r) return r;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const std::string body = place("bodies", b);
    if (auto r = check_names((body + ".surfaces").c_str(), s.bodies[b].surfaces); !r) return r;
    if (auto r = check_names((body + ".node_sets").c_str(), s.bodies[b].node_sets); !r) return r;
  }
  if (auto r = check_names("probes", s.probes); !r) return r;
  if (auto r = check_names("metrics", s.metrics); !r) return r;
  // Effects share one set of names: reactions and gauges are told apart by them.
  std::set<std::string> seen;
  const auto plain = [](const auto& t) -> const std::string& { return t.name; };
  if (s.volumes) {
    const auto inner = [](const VolumeRows& v) -> const std::string& { return v.def.name; };
    if (auto r = check_names("volumes", *s.volumes, inner, seen); !r) return r;
  }
  if (auto r = check_names("dirichlet", s.dirichlet, plain, seen); !r) return r;
  if (auto r = check_names("cavities", s.cavities, plain, seen); !r) return r;
  if (auto r = check_names("tractions", s.tractions, plain, seen); !r) return r;
  if (auto r = check_names("pressures", s.pressures, plain, seen); !r) return r;
  if (auto r = check_names("damping", s.damping, plain, seen); !r) return r;
  if (auto r = check_names("epidermis", s.epidermis, plain, seen); !r) return r;
  if (auto r = check_names("membranes", s.membranes, plain, seen); !r) return r;
  if (auto r = check_names("ties", s.ties, plain, seen); !r) return r;
  if (auto r = check_names("cables", s.cables, plain, seen); !r) return r;
  if (auto r = check_names("windings", s.windings, plain, seen); !r) return r;
  if (auto r = check_names("layers", s.layers, plain, seen); !r) return r;
  if (auto r = check_names("valves", s.valves, plain, seen); !r) return r;
  if (auto r = check_names("rigid_bodies", s.rigid_bodies, plain, seen); !r) return r;
  if (auto r = check_names("contacts", s.contacts, plain, seen); !r) return r;
  if (auto r = check_names("surface_contacts", s.surface_contacts, plain, seen); !r) return r;
  if (auto r = check_names("orientations", s.orientations, plain, seen); !r) return r;
  return check_names("forces", s.forces, plain, seen);
}

Result<void> check_curve(const std::string& where, const Curve& curve) {
  if (curve.points.empty()) return Error{where + " is empty; give a number or points [[time, value], ...]"};
  double last = -std::numeric_limits<double>::infinity();
  for (const auto& p : curve.points) {
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
      return Error{where + " has a value that is no finite number"};
    if (p[0] < last) {
      return Error{where + " goes back in time from " + number(last) + " to " + number(p[0]) +
                   "; list its points by ascending time"};
    }
    last = p[0];
  }
  return {};
}

template <class T>
Result<void> check_curves(const char* list, const std::vector<T>& items) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (auto r = check_curve(place(list, i) + ".amount", items[i].amount); !r) return r;
  }
  return {};
}

Result<void> check_all_curves(const SceneDef& s) {
  if (auto r = check_curve("gravity_amount", s.gravity_amount); !r) return r;
  if (auto r = check_curves("dirichlet", s.dirichlet); !r) return r;
  if (auto r = check_curves("cavities", s.cavities); !r) return r;
  if (auto r = check_curves("tractions", s.tractions); !r) return r;
  if (auto r = check_curves("pressures", s.pressures); !r) return r;
  if (auto r = check_curves("cables", s.cables); !r) return r;
  if (auto r = check_curves("valves", s.valves); !r) return r;
  return check_curves("forces", s.forces);
}

Result<void> check_analysis(const AnalysisDef& a) {
  if (!(a.duration > 0) || !std::isfinite(a.duration)) {
    return Error{"analysis.duration = " + number(a.duration) + "; it must be positive and finite"};
  }
  if (a.step && (!(*a.step > 0) || *a.step > a.duration * (1 + 1e-9))) {
    return Error{"analysis.step = " + number(*a.step) + " s; it must be positive and at most the duration, " +
                 number(a.duration)};
  }
  if (a.step && a.duration / *a.step > kMostSteps) {
    return Error{"analysis.step = " + number(*a.step) + " s asks for more than " +
                 std::to_string(kMostSteps) + " steps; take a longer one"};
  }
  // Steps are of one length and end with the duration; to the digits that people type.
  if (a.step && std::abs(std::round(a.duration / *a.step) * *a.step - a.duration) > 1e-5 * a.duration) {
    const double fewer = std::max(1.0, std::floor(a.duration / *a.step));
    return Error{"analysis.step = " + number(*a.step) + " s does not divide the duration, " +
                 number(a.duration) + ": " + number(fewer) + " steps take " + number(a.duration / fewer) +
                 " s each and " + number(fewer + 1) + " take " + number(a.duration / (fewer + 1)) +
                 "; give one of these numbers as analysis.steps, or another duration"};
  }
  if (!a.step && (a.steps < 1 || a.steps > kMostSteps)) {
    return Error{"analysis.steps = " + std::to_string(a.steps) + "; it must lie between 1 and " +
                 std::to_string(kMostSteps)};
  }
  if (!(a.spectral_radius >= 0 && a.spectral_radius <= 1)) {
    return Error{"analysis.spectral_radius = " + number(a.spectral_radius) +
                 "; it must lie between 0 (damps the fastest motion at once) and 1 (not at all)"};
  }
  if (a.type == AnalysisType::statics && a.scheme != SchemeWord::implicit_euler) {
    return Error{"analysis.scheme belongs to dynamics; remove it or set analysis.type to \"dynamic\""};
  }
  if (a.path_step && (!(*a.path_step > 0) || !std::isfinite(*a.path_step))) {
    return Error{"analysis.path_step = " + number(*a.path_step) + " m; it must be positive and finite"};
  }
  if (a.path_step && a.type != AnalysisType::statics) {
    return Error{"analysis.path_step belongs to statics; remove it or set analysis.type to \"static\""};
  }
  if (!(a.time_error >= 0) || !std::isfinite(a.time_error)) {
    return Error{"analysis.time_error = " + number(a.time_error) +
                 "; it must be zero (no control) or a positive part of the scene's length"};
  }
  if (a.type == AnalysisType::statics && (a.time_error > 0 || a.consistent_mass)) {
    return Error{"analysis." + std::string(a.time_error > 0 ? "time_error" : "consistent_mass") +
                 " belongs to dynamics; remove it or set analysis.type to \"dynamic\""};
  }
  if (!(a.smallest_fraction > 0) || a.smallest_fraction > 1) {
    return Error{"analysis.smallest_fraction = " + number(a.smallest_fraction) +
                 "; it must be positive and at most 1"};
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

Result<void> check_lattice(const std::string& where, const LatticeMesh& lattice, Element element) {
  if (lattice.surface.empty()) return Error{where + ".surface is empty; name a file with a closed surface"};
  if (!(lattice.scale > 0) || !std::isfinite(lattice.scale)) {
    return Error{where + ".scale = " + number(lattice.scale) + "; it must be a positive number"};
  }
  if (!std::isfinite(dot(lattice.offset, lattice.offset)))
    return Error{where + ".offset has a coordinate that is no finite number"};
  if (!(lattice.spacing > 0) || !std::isfinite(lattice.spacing)) {
    return Error{where + ".spacing = " + number(lattice.spacing) +
                 " m; it must be a positive number, the edge of a cube"};
  }
  if (element != Element::hex8)
    return Error{where + ": its cells are hexahedra; set \"element\" of the body to \"hex8\""};
  return {};
}

Result<void> check_bodies(const SceneDef& s) {
  if (s.bodies.empty()) return Error{"bodies is empty; a scene needs at least one body"};
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    if (s.bodies[b].materials.empty()) {
      return Error{place("bodies", b) + ".materials is empty; give the body a material"};
    }
    if (const auto* lattice = std::get_if<LatticeMesh>(&s.bodies[b].mesh)) {
      if (auto r = check_lattice(place("bodies", b) + ".mesh.lattice", *lattice, s.bodies[b].element); !r)
        return r;
    }
    const auto* file = std::get_if<MeshFile>(&s.bodies[b].mesh);
    if (!file) continue;
    if (file->path.empty()) return Error{place("bodies", b) + ".mesh.file is empty; name a mesh file"};
    if (!(file->scale > 0) || !std::isfinite(file->scale)) {
      return Error{place("bodies", b) + ".mesh.scale = " + number(file->scale) +
                   "; it must be a positive number"};
    }
    if (!std::isfinite(dot(file->turn, file->turn))) {
      return Error{place("bodies", b) + ".mesh.turn has a component that is no finite number"};
    }
    if (!std::isfinite(dot(file->offset, file->offset))) {
      return Error{place("bodies", b) + ".mesh.offset has a coordinate that is no finite number"};
    }
  }
  for (std::size_t i = 0; i < s.probes.size(); ++i) {
    const Vec3& p = s.probes[i].point;
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      return Error{place("probes", i) + ".point has a coordinate that is no finite number"};
    }
    const auto b = static_cast<Index>(s.probes[i].body);
    if (b < 0 || static_cast<std::size_t>(b) >= s.bodies.size()) {
      return Error{place("probes", i) + ".body: there is no body number " + std::to_string(b)};
    }
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
  if (auto r = check_all_names(s); !r) return r;
  if (auto r = check_analysis(s.analysis); !r) return r;
  if (auto r = check_all_curves(s); !r) return r;
  if (s.outputs.every < 0) {
    return Error{"outputs.every = " + std::to_string(s.outputs.every) +
                 "; give 0 (no frames) or a number of steps"};
  }
  if (s.outputs.checkpoint_steps < 0) {
    return Error{"outputs.checkpoint_steps = " + std::to_string(s.outputs.checkpoint_steps) +
                 "; give 0 (none) or a number of steps"};
  }
  if (!(s.outputs.checkpoint_seconds >= 0) || !std::isfinite(s.outputs.checkpoint_seconds)) {
    return Error{"outputs.checkpoint_seconds = " + number(s.outputs.checkpoint_seconds) +
                 " s; give 0 (none) or a positive number"};
  }
  return check_metrics(s);
}

}  // namespace isochor
