#include "live/dials.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "engine/base/text.h"
#include "isochor/effects.h"
#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"

namespace isochor::live {

namespace {

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

// The largest magnitude of a curve.
double reach(const Curve& curve) {
  double out = 0;
  for (const auto& p : curve.points) out = std::max(out, std::abs(p[1]));
  return out;
}

double lowest(const Curve& curve) {
  double out = 0;
  for (const auto& p : curve.points) out = std::min(out, p[1]);
  return out;
}

// 1, 2 or 5 times a power of ten, not below the value: ends of sliders are to be read.
double round_up(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double m : {1.0, 2.0, 5.0}) {
    if (m * power >= value * (1 - 1e-9)) return m * power;
  }
  return 10 * power;
}

std::string of_body(const SceneDef& scene, const std::string& name, std::size_t body) {
  return scene.bodies.size() < 2 ? name : name + " of " + scene.bodies[body].name;
}

Dial pressure_dial(const std::string& group, const std::string& name, const Curve& amount) {
  const double high = round_up(2 * reach(amount));
  return {group, name, "Pa", lowest(amount) < 0 ? -high : -0.2 * high, high, false};
}

Dial cavity_dial(const CavityDef& c) {
  const double most = reach(c.amount);
  switch (c.control) {
    case CavityControl::pressure:
      return pressure_dial("Chambers", c.name, c.amount);
    case CavityControl::volume:
      return {"Chambers", c.name, "m\u00b3", 0.2 * most, 2 * most, false};
    case CavityControl::volume_ratio:
      return {"Chambers", c.name + ", over its volume at rest", "", 0.2, round_up(1.5 * most), false};
    case CavityControl::gas:
    case CavityControl::liquid:
      break;
  }
  return {"Chambers", c.name + ", supplied", "", 0.2, round_up(1.5 * most), false};
}

Dial cable_dial(const CableDef& c) {
  const double most = reach(c.amount);
  switch (c.control) {
    case CableControl::tension:
      return {"Cables", c.name, "N", 0, round_up(2 * std::max(most, 0.5)), false};
    case CableControl::length:
      return {"Cables", c.name, "m", 0.5 * most, 1.2 * most, false};
    case CableControl::length_ratio:
      break;
  }
  return {"Cables", c.name + ", over its length at rest", "", 0.5, 1.2, false};
}

// The i-th effect of a kind made anew from the scene, in the place of the one that is there.
Result<void> replace(const EffectKind& kind, std::size_t i, const SceneDef& scene, BuiltScene& built) {
  std::vector<EffectPtr> made;
  EffectAdder adder(scene, [&](const EffectKind&, EffectPtr effect) -> Result<void> {
    made.push_back(std::move(effect));
    return {};
  });
  if (auto r = kind.add(kind, adder); !r) return r;
  const auto ids = built.ids(kind);
  if (i >= made.size() || i >= ids.size()) return Error{"there is no such effect any more"};
  if (auto r = built.world.replace(ids[i], std::move(made[i])); !r) return r;
  return built.world.compile();
}

// Of a body's cells those of the mesh before it was refined; empty: it was not.
std::span<const Index> parents_of(const BuiltScene& built, std::size_t body) {
  return body < built.parents.size() ? std::span<const Index>(built.parents[body]) : std::span<const Index>();
}

// Cells of a body's mesh as the scene has it, which its lists of numbers count.
std::size_t cells_given(const BuiltScene& built, std::size_t body) {
  const auto parents = parents_of(built, body);
  if (parents.empty()) return static_cast<std::size_t>(built.world.mesh(built.bodies[body]).cell_count());
  return static_cast<std::size_t>(*std::max_element(parents.begin(), parents.end())) + 1;
}

}  // namespace

double spring_for(const SceneDef& scene, double extent) {
  double softest = 0;
  for (const SceneBody& body : scene.bodies) {
    for (const MaterialDef& m : body.materials) {
      const ElasticConstants& c = m.constants;
      double young = c.young > 0 ? c.young : 3 * c.mu;
      if (!(young > 0)) young = 6 * std::max(m.own.c1 + m.own.c2, 0.0);
      if (young > 0) softest = softest > 0 ? std::min(softest, young) : young;
    }
  }
  return 0.006 * extent * (softest > 0 ? softest : 1e5);
}

Dials::Dials(const SceneDef& scene, Poses& poses, double stiffness, double extent)
    : scene_(scene), poses_(poses), changed_(scene) {
  const double middle = round_up(0.7 * stiffness);
  add(
      {"Hand", "Spring of a pull", "N/m", middle / 50, middle * 50, true},
      [stiffness](double) { return stiffness; },
      [](double, SceneDef&, BuiltScene&) -> Result<void> { return {}; });
  add_amounts();
  add_poses(extent);
  add_gravity();
  add_materials();
  add_friction();
  add_damping();
}

void Dials::add(Dial dial, std::function<double(double)> given, Apply apply) {
  list_.push_back(std::move(dial));
  work_.push_back({std::move(given), std::move(apply), {}});
}

double Dials::value(std::size_t dial, double time) const {
  const Work& w = work_[dial];
  return w.set ? *w.set : w.given(time);
}

Result<void> Dials::set(std::size_t dial, double value, BuiltScene& built) {
  if (dial >= list_.size()) {
    return Error{"control " + std::to_string(dial) + " is not there; there are " +
                 std::to_string(list_.size()) + ", counted from 0"};
  }
  const Dial& d = list_[dial];
  const double slack = 1e-9 * (std::abs(d.low) + std::abs(d.high));
  if (!(value >= d.low - slack && value <= d.high + slack)) {
    return Error{d.group + ", " + d.name + ": " + number(value) + " " + d.unit + " is not between " +
                 number(d.low) + " and " + number(d.high)};
  }
  SceneDef before = changed_;
  if (auto r = work_[dial].apply(value, changed_, built); !r) {
    changed_ = std::move(before);
    return Error{d.group + ", " + d.name + ": " + r.error()};
  }
  work_[dial].set = value;
  return {};
}

void Dials::forget() {
  changed_ = scene_;
  for (Work& w : work_) w.set.reset();
  std::fill(drag_.begin(), drag_.end(), std::nullopt);
}

void Dials::add_amounts() {
  // `unit`: of the dial, for an amount of one.
  const auto amount = [&](Dial dial, const EffectKind& kind, std::size_t i, const Curve& curve,
                          double unit = 1) {
    add(
        std::move(dial), [&curve, unit](double t) { return unit * evaluate(curve, t); },
        [&kind, i, unit](double value, SceneDef&, BuiltScene& built) {
          return built.world.set_amount(built.ids(kind)[i], value / unit);
        });
  };
  const SceneDef& s = scene_;
  for (std::size_t i = 0; i < s.cavities.size(); ++i)
    amount(cavity_dial(s.cavities[i]), cavities_kind, i, s.cavities[i].amount);
  for (std::size_t i = 0; i < s.valves.size(); ++i)
    amount({"Chambers", s.valves[i].name + ", opening", "", 0, 1, false}, valves_kind, i, s.valves[i].amount);
  for (std::size_t i = 0; i < s.cables.size(); ++i)
    amount(cable_dial(s.cables[i]), cables_kind, i, s.cables[i].amount);
  for (std::size_t i = 0; i < s.pressures.size(); ++i)
    amount(pressure_dial("Loads", s.pressures[i].name, s.pressures[i].amount), pressures_kind, i,
           s.pressures[i].amount);
  const auto scale = [&](const char* group, const std::string& name, const EffectKind& kind, std::size_t i,
                         const Curve& curve) {
    const double high = round_up(2 * std::max(reach(curve), 0.5));
    amount({group, name + ", times", "", -high, high, false}, kind, i, curve);
  };
  for (std::size_t i = 0; i < s.tractions.size(); ++i)
    scale("Loads", s.tractions[i].name, tractions_kind, i, s.tractions[i].amount);
  for (std::size_t i = 0; i < s.muscles.size(); ++i)
    amount(pressure_dial("Muscles", s.muscles[i].name, s.muscles[i].amount), muscles_kind, i,
           s.muscles[i].amount);
  for (std::size_t i = 0; i < s.growth.size(); ++i) {
    // From nothing to twice what is said: beyond, and with other signs, cells may turn over.
    const Curve& curve = s.growth[i].amount;
    const double high = round_up(2 * std::max(reach(curve), 0.5));
    amount({"Growth", s.growth[i].name + ", times", "", lowest(curve) < 0 ? -high : 0, high, false},
           growth_kind, i, curve);
  }
  for (std::size_t i = 0; i < s.springs.size(); ++i)
    amount({"Springs", s.springs[i].name + ", over its length without tension", "", 0, 2, false},
           springs_kind, i, s.springs[i].amount);
  for (std::size_t i = 0; i < s.forces.size(); ++i)
    scale("Loads", s.forces[i].name, forces_kind, i, s.forces[i].amount);
  for (std::size_t i = 0; i < s.dirichlet.size(); ++i) {
    const DirichletDef& d = s.dirichlet[i];
    const double way = length(d.displacement);
    if (!d.bone.keys.empty() || !d.bone.file.empty()) continue;
    const double high = round_up(2 * std::max(reach(d.amount), 0.5));
    if (way > 0 && d.angle == 0)
      amount({"Supports", d.name, "m", -high * way, high * way, false}, dirichlet_kind, i, d.amount, way);
    else if (way > 0 || d.angle != 0)
      scale("Supports", d.name, dirichlet_kind, i, d.amount);
  }
}

// Ways and turns, of which each is set with what the others say.
void Dials::add_poses(double extent) {
  constexpr double degree = std::numbers::pi / 180;
  for (std::size_t thing = 0; thing < poses_.count(); ++thing) {
    const double most = round_up(std::max(0.5 * extent, 1.2 * poses_.reach(thing)));
    for (const PoseAxis& axis : poses_.axes(thing)) {
      const double unit = axis.turn ? degree : 1;
      const double high = axis.turn ? 180 : most;
      add(
          {"Pose of " + poses_.name(thing), axis.name, axis.turn ? "\u00b0" : "m", -high, high, false},
          [this, thing, &axis, unit](double t) { return axis.of(poses_.wanted(thing, t)) / unit; },
          [this, thing, &axis, unit](double value, SceneDef&, BuiltScene& built) -> Result<void> {
            Placement p = poses_.wanted(thing, built.world.time());
            axis.set(p, value * unit);
            poses_.want(thing, p);
            return {};
          });
    }
  }
}

void Dials::add_gravity() {
  const std::size_t first = list_.size();
  for (int axis = 0; axis < 3; ++axis) {
    const WorldOptions& o = scene_.analysis.options;
    add(
        {"Gravity", std::string(1, "xyz"[axis]), "m/s\u00b2", -20, 20, false},
        [&o, axis](double t) { return o.gravity[axis] * evaluate(o.gravity_curve, t); },
        // All three are set together, from what each of them says.
        [this, first, axis](double value, SceneDef&, BuiltScene& built) {
          Vec3 g{};
          for (int k = 0; k < 3; ++k)
            g[k] = k == axis ? value : this->value(first + static_cast<std::size_t>(k), built.world.time());
          return built.world.set_gravity(g);
        });
  }
}

void Dials::add_materials() {
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    for (std::size_t m = 0; m < scene_.bodies[b].materials.size(); ++m) {
      const MaterialDef& def = scene_.bodies[b].materials[m];
      std::string group = "Material of " + scene_.bodies[b].name;
      if (!def.region.empty()) group += ", " + def.region;
      // The material made anew of a definition that `change` has changed.
      const auto anew = [b, m](SceneDef& scene, BuiltScene& built, const auto& change) -> Result<void> {
        MaterialDef& here = scene.bodies[b].materials[m];
        change(here);
        auto numbers = refined_numbers(here, scene.folder, parents_of(built, b));
        if (!numbers) return numbers.failure();
        auto made = make_material(numbers.value(), scene.folder, &built.world.mesh(built.bodies[b]));
        if (!made) return made.failure();
        auto r = built.world.set_material(built.bodies[b], here.region, made.value());
        return r ? built.world.compile() : r;
      };
      const auto constant = [&](const char* what, const char* unit, double low, double high, bool logarithmic,
                                double ElasticConstants::*member) {
        add(
            {group, what, unit, low, high, logarithmic},
            [&def, member](double) { return def.constants.*member; },
            [anew, member](double value, SceneDef& scene, BuiltScene& built) {
              return anew(scene, built, [&](MaterialDef& here) { here.constants.*member = value; });
            });
      };
      const ElasticConstants& c = def.constants;
      if (c.young > 0) {
        const double e = round_up(0.7 * c.young);
        constant("Young's modulus", "Pa", e / 20, e * 20, true, &ElasticConstants::young);
      }
      if (c.mu > 0) {
        const double mu = round_up(0.7 * c.mu);
        constant("Shear modulus", "Pa", mu / 20, mu * 20, true, &ElasticConstants::mu);
      }
      // Laws with constants of their own: all of them together.
      if (c.young <= 0 && c.mu <= 0 && !def.stiffness_field.given()) {
        add(
            {group, "Stiffness, times", "", 0.05, 20, true}, [](double) { return 1.0; },
            [anew, b](double value, SceneDef& scene, BuiltScene& built) {
              const std::size_t cells = cells_given(built, b);
              return anew(scene, built,
                          [&](MaterialDef& here) { here.stiffness_field.values.assign(cells, value); });
            });
      }
      const bool by_ratio = c.mu <= 0 && !def.poisson_field.given();
      if (by_ratio) constant("Poisson's ratio", "", 0, 0.5, false, &ElasticConstants::poisson);
    }
  }
}

void Dials::add_friction() {
  const auto friction = [&](const EffectKind& kind, std::size_t i, const std::string& name, auto list) {
    add(
        {"Friction", name, "", 0, 2, false}, [this, i, list](double) { return (scene_.*list)[i].friction; },
        [&kind, i, list](double value, SceneDef& scene, BuiltScene& built) {
          auto& def = (scene.*list)[i];
          def.friction = value;
          // It never takes less to break away.
          if (def.static_friction > 0) def.static_friction = std::max(def.static_friction, value);
          return replace(kind, i, scene, built);
        });
  };
  for (std::size_t i = 0; i < scene_.contacts.size(); ++i)
    friction(contacts_kind, i, scene_.contacts[i].name, &SceneDef::contacts);
  for (std::size_t i = 0; i < scene_.surface_contacts.size(); ++i)
    friction(surface_contacts_kind, i, scene_.surface_contacts[i].name, &SceneDef::surface_contacts);
}

void Dials::add_damping() {
  if (scene_.analysis.type != AnalysisType::dynamics) return;
  for (std::size_t i = 0; i < scene_.damping.size(); ++i) {
    const DampingDef& d = scene_.damping[i];
    const auto part = [&](const char* what, const char* unit, double high, double DampingDef::*member) {
      add(
          {"Damping", d.name + ", " + what, unit, 0, high, false}, [&d, member](double) { return d.*member; },
          [i, member](double value, SceneDef& scene, BuiltScene& built) {
            scene.damping[i].*member = value;
            return replace(damping_kind, i, scene, built);
          });
    };
    part("viscosity", "Pa s", round_up(std::max(4 * d.viscosity, 100.0)), &DampingDef::viscosity);
    part("drag", "1/s", round_up(std::max(4 * d.mass_rate, 20.0)), &DampingDef::mass_rate);
  }
  drag_.resize(scene_.bodies.size());
  for (std::size_t b = 0; b < scene_.bodies.size() && scene_.damping.empty(); ++b) {
    add(
        {"Damping", of_body(scene_, "Drag", b), "1/s", 0, 50, false}, [](double) { return 0.0; },
        [this, b](double value, SceneDef&, BuiltScene& built) -> Result<void> {
          DampingDef def;
          def.name = "live drag " + std::to_string(b + 1);
          def.body = built.bodies[b];
          def.mass_rate = value;
          if (drag_[b]) {
            auto r = built.world.replace(*drag_[b], damping(def));
            return r ? built.world.compile() : r;
          }
          auto added = built.world.add(damping(def));
          if (!added) return added.failure();
          if (auto r = built.world.compile(); !r) return r;
          drag_[b] = added.value();
          return {};
        });
  }
}

}  // namespace isochor::live
