// Worlds: made from keys, bodies and effects added, changed and removed, driven.
#include "hosted_world.h"
#include "parts.h"
#include "reports.h"

namespace isochor::python {

namespace {

std::unique_ptr<HostedWorld> make(const std::string& keys) {
  OptionParts parts = options_from(keys);
  auto world = std::make_unique<HostedWorld>(std::move(parts.options));
  world->names().statics = parts.statics;
  return world;
}

BodyId add_body(HostedWorld& world, const std::shared_ptr<Mesh>& mesh, const std::string& keys) {
  const BodyId id = need(world.work("add_body", [&](World& w) { return w.add_body(body_from(keys, *mesh)); }));
  const auto place = static_cast<std::size_t>(id.number());
  auto& bodies = world.names().bodies;
  if (bodies.size() <= place) bodies.resize(place + 1);
  bodies[place] = need(world.glance("add_body", [&](World& w) { return Result<std::string>(w.body_name(id)); }));
  return id;
}

EffectId add(HostedWorld& world, const std::string& list, const std::string& keys) {
  return need(
      world.work("add", [&](World& w) { return w.add(effect_from(list, keys, world.names())); }));
}

void replace(HostedWorld& world, EffectId id, const std::string& list, const std::string& keys) {
  need(world.work("replace",
                  [&](World& w) { return w.replace(id, effect_from(list, keys, world.names())); }));
}

}  // namespace

void bind_worlds(py::module_& module) {
  py::class_<BodyId>(module, "BodyId");
  py::class_<EffectId>(module, "EffectId");
  HostedWorldClass world(module, "World");
  world.def(py::init(&make))
      .def("compile", [](HostedWorld& w) { need(w.work("compile", [](World& v) { return v.compile(); })); })
      .def("add_body", &add_body)
      .def("add", &add)
      .def("replace", &replace)
      .def("set_amount",
           [](HostedWorld& w, EffectId effect, double amount) {
             need(w.work("set_amount", [&](World& v) { return v.set_amount(effect, amount); }));
           })
      .def("set_positions",
           [](HostedWorld& w, BodyId body, const py::object& values) {
             const std::vector<Vec3> x = points_in(values, "set_positions: positions");
             need(w.work("set_positions", [&](World& v) { return v.set_positions(body, x); }));
           })
      .def("set_velocities", [](HostedWorld& w, BodyId body, const py::object& values) {
        const std::vector<Vec3> x = points_in(values, "set_velocities: velocities");
        need(w.work("set_velocities", [&](World& v) { return v.set_velocities(body, x); }));
      });
  bind_stepping(module, world);
  bind_reading(module, world);
}

}  // namespace isochor::python
