// A world that changes while it lives: what is driven, replaced, removed, and its other lives.
#include <cmath>

#include "hosted_world.h"
#include "reports.h"

namespace isochor::python {

namespace {

// A setter of World by what it is called, with its argument converted from an array.
template <class Value, class Set>
void change(HostedWorld& world, const char* call, const Value& value, const Set& set) {
  need(world.work(call, [&](World& w) { return set(w, value); }));
}

void set_positions(HostedWorld& world, BodyId body, const py::object& values) {
  change(world, "set_positions", points_in(values, "set_positions: positions"),
         [&](World& w, const auto& x) { return w.set_positions(body, x); });
}
void set_velocities(HostedWorld& world, BodyId body, const py::object& values) {
  change(world, "set_velocities", points_in(values, "set_velocities: velocities"),
         [&](World& w, const auto& v) { return w.set_velocities(body, v); });
}
void set_forces(HostedWorld& world, BodyId body, const py::object& values) {
  change(world, "set_forces", points_in(values, "set_forces: forces"),
         [&](World& w, const auto& f) { return w.set_forces(body, f); });
}
void add_force(HostedWorld& world, BodyId body, Index node, const py::object& force) {
  change(world, "add_force", vector_in(force, "add_force: force"),
         [&](World& w, const Vec3& f) { return w.add_force(body, node, f); });
}
void add_force_at(HostedWorld& world, BodyId body, const py::object& point, const py::object& force) {
  const Vec3 at = vector_in(point, "add_force_at: point");
  change(world, "add_force_at", vector_in(force, "add_force_at: force"),
         [&](World& w, const Vec3& f) { return w.add_force_at(body, at, f); });
}
void set_gravity(HostedWorld& world, const py::object& gravity) {
  const Vec3 given = vector_in(gravity, "set_gravity: gravity");
  change(world, "set_gravity", given, [](World& w, const Vec3& g) { return w.set_gravity(g); });
  world.meaning().gravity = given;
  world.meaning().gravity_curve = Curve::constant(1);
}
void set_amount(HostedWorld& world, EffectId effect, double amount) {
  change(world, "set_amount", amount, [&](World& w, double a) { return w.set_amount(effect, a); });
}

// `turn`: axis times angle [rad].
void set_pose(HostedWorld& world, EffectId effect, const py::object& position, const py::object& turn) {
  Pose pose;
  pose.position = vector_in(position, "set_pose: position");
  const Vec3 v = vector_in(turn, "set_pose: turn");
  const double angle = std::sqrt(dot(v, v));
  const double s = angle > 0 ? std::sin(angle / 2) / angle : 0.0;
  pose.rotation = {std::cos(angle / 2), s * v.x, s * v.y, s * v.z};
  change(world, "set_pose", pose, [&](World& w, const Pose& p) { return w.set_pose(effect, p); });
}

void set_material(HostedWorld& world, BodyId body, const std::string& region, const std::string& keys) {
  need(world.work("set_material", [&](World& w) {
    return w.set_material(body, region, need(material_from_keys(keys, "")).material);
  }));
}
void set_density(HostedWorld& world, BodyId body, const std::string& region, double density) {
  change(world, "set_density", density, [&](World& w, double d) { return w.set_density(body, region, d); });
}

void remove_effect(HostedWorld& world, EffectId effect) {
  need(world.work("remove", [&](World& w) { return w.remove(effect); }));
}
void remove_body(HostedWorld& world, BodyId body) {
  need(world.work("remove", [&](World& w) { return w.remove(body); }));
}

}  // namespace

void bind_changing(HostedWorldClass& world) {
  world.def("set_positions", &set_positions)
      .def("set_velocities", &set_velocities)
      .def("set_forces", &set_forces)
      .def("add_force", &add_force)
      .def("add_force_at", &add_force_at)
      .def("clear_forces", [](HostedWorld& w) { w.work("clear_forces", [](World& v) { v.clear_forces(); }); })
      .def("set_gravity", &set_gravity)
      .def("set_amount", &set_amount)
      .def("set_pose", &set_pose)
      .def("set_material", &set_material)
      .def("set_density", &set_density)
      .def("remove_effect", &remove_effect)
      .def("remove_body", &remove_body)
      .def("reset", [](HostedWorld& w) { need(w.work("reset", [](World& v) { return v.reset(); })); })
      .def("clone", &HostedWorld::clone);
}

}  // namespace isochor::python
