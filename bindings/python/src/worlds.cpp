// Worlds: made from keys, bodies and effects added and driven.
#include "hosted_world.h"
#include "isochor/schemes.h"
#include "reports.h"

namespace isochor::python {

void bind_worlds(py::module_& module) {
  py::class_<BodyId>(module, "BodyId");
  py::class_<EffectId>(module, "EffectId");
  HostedWorldClass world(module, "World");
  world.def(py::init([](const py::object& gravity) {
    WorldOptions options;
    options.scheme = implicit_euler();
    options.gravity = vector_in(gravity, "World: gravity");
    return std::make_unique<HostedWorld>(std::move(options));
  }));
  bind_stepping(module, world);
  bind_reading(module, world);
}

}  // namespace isochor::python
