// Worlds: made from keys, bodies and effects added and replaced.
#include "hosted_world.h"
#include "reports.h"

namespace isochor::python {

namespace {

std::shared_ptr<HostedWorld> make(const std::string& keys) {
  KeyMeaning meaning;
  WorldOptions options = options_from(keys, meaning);
  return std::make_shared<HostedWorld>(std::move(options), std::move(meaning));
}

BodyId add_body(HostedWorld& world, const std::shared_ptr<Mesh>& mesh, const std::string& keys) {
  return need(world.work("add_body",
                         [&](World& w) { return w.add_body(need(body_from_keys(keys, "", mesh.get()))); }));
}

EffectId add(HostedWorld& world, const std::string& list, const std::string& keys) {
  return need(world.work(
      "add", [&](World& w) { return w.add(need(effect_from_keys(list, keys, world.meaning().in(w)))); }));
}

void replace(HostedWorld& world, EffectId id, const std::string& list, const std::string& keys) {
  need(world.work("replace", [&](World& w) -> Result<void> {
    if (auto r = w.check(id); !r) return r;
    // Its own name is free for what takes its place.
    PartContext context = world.meaning().in(w);
    std::erase(context.names_taken, w.effect_name(id));
    return w.replace(id, need(effect_from_keys(list, keys, context)));
  }));
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
  bind_gradients(world);
}

}  // namespace isochor::python
