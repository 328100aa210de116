// Worlds: made from keys, bodies and effects added and replaced.
#include "hosted_world.h"
#include "reports.h"

namespace isochor::python {

namespace {

std::shared_ptr<HostedWorld> make(const std::string& keys) {
  return std::make_shared<HostedWorld>(options_from(keys));
}

BodyId add_body(HostedWorld& world, const std::shared_ptr<Mesh>& mesh, const std::string& keys) {
  return need(world.work("add_body", [&](World& w) {
    BodyDef def = body_from(keys, *mesh);
    const std::string name = def.name;
    Result<BodyId> id = w.add_body(std::move(def));
    if (id) world.names().put(id.value(), name);
    return id;
  }));
}

EffectId add(HostedWorld& world, const std::string& list, const std::string& keys) {
  return need(world.work("add", [&](World& w) { return w.add(effect_from(list, keys, world.names())); }));
}

void replace(HostedWorld& world, EffectId id, const std::string& list, const std::string& keys) {
  need(
      world.work("replace", [&](World& w) { return w.replace(id, effect_from(list, keys, world.names())); }));
}

py::object why_not(HostedWorld& world, BodyId body) {
  const Result<void> found = world.glance("check", [&](World& w) { return w.check(body); });
  return found ? py::object(py::none()) : py::object(py::str(found.error()));
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
      .def("why_not", &why_not);
  bind_changing(world);
  bind_stepping(world);
  bind_reading(world);
  bind_answers(world);
}

}  // namespace isochor::python
