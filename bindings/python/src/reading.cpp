// What is read from a world: views of its numbers, energies, measures, fields, its saved state.
#include "hosted_world.h"
#include "reports.h"

namespace isochor::python {

namespace {

using Span = std::span<const Vec3>;

// Views of the numbers of a compiled world. They hold those numbers and not the world.
template <Span (World::*numbers)(BodyId) const>
py::array view(HostedWorld& world, const char* call, BodyId body) {
  need(world.work(call, [](World& w) { return w.compile(); }));
  return world.glance(call, [&](World& w) {
    if (const auto r = w.check(body); !r) throw Refused(std::string(call) + ": " + r.error());
    return array_of((w.*numbers)(body), w.keep_views());
  });
}

py::array positions(HostedWorld& world, BodyId body) {
  return view<&World::positions>(world, "positions", body);
}
py::array velocities(HostedWorld& world, BodyId body) {
  return view<&World::velocities>(world, "velocities", body);
}

py::dict volume_dict(const VolumeMeasures& m) {
  py::dict out;
  out["name"] = m.name;
  out["volume"] = m.volume;
  out["rest_volume"] = m.rest_volume;
  out["min_J"] = m.min_J;
  out["max_J"] = m.max_J;
  return out;
}

py::dict measures(HostedWorld& world, BodyId body) {
  const BodyMeasures m = world.work("measures", [&](World& w) { return w.measures(body); });
  py::dict out = volume_dict(static_cast<const VolumeMeasures&>(m));
  out["volume_row_residual"] = m.volume_row_residual;
  out["center_of_mass"] = array_of(m.center_of_mass);
  out["mass"] = m.mass;
  out["linear_momentum"] = array_of(m.linear_momentum);
  out["angular_momentum"] = array_of(m.angular_momentum);
  py::list regions;
  for (const VolumeMeasures& r : m.regions) regions.append(volume_dict(r));
  out["regions"] = regions;
  return out;
}

py::dict fields(HostedWorld& world, BodyId body) {
  BodyFields f = world.work("fields", [&](World& w) { return w.fields(body); });
  py::dict out;
  out["node_pressure"] = array_of(std::move(f.node_pressure), 0);
  out["node_stress"] = array_of(std::move(f.node_stress), 6);
  out["cell_J"] = array_of(std::move(f.cell_J), 0);
  out["cell_pressure"] = array_of(std::move(f.cell_pressure), 0);
  out["cell_von_mises"] = array_of(std::move(f.cell_von_mises), 0);
  out["cell_stress"] = array_of(std::move(f.cell_stress), 6);
  out["cell_max_stretch"] = array_of(std::move(f.cell_max_stretch), 0);
  if (f.node_contact_pressure.empty()) {
    out["node_contact_pressure"] = py::none();
    out["node_friction"] = py::none();
  } else {
    out["node_contact_pressure"] = array_of(std::move(f.node_contact_pressure), 0);
    out["node_friction"] = array_of(std::move(f.node_friction), 3);
  }
  return out;
}

py::dict size(HostedWorld& world) {
  const WorldSize s = world.work("size", [](World& w) { return w.size(); });
  py::dict out;
  out["nodes"] = s.nodes;
  out["displacement_unknowns"] = s.displacement_unknowns;
  out["multipliers"] = s.multipliers;
  out["matrix_size"] = s.matrix_size;
  out["matrix_nonzeros"] = s.matrix_nonzeros;
  out["factor_nonzeros"] = s.factor_nonzeros;
  out["engine_bytes"] = s.engine_bytes;
  out["table_bytes"] = s.table_bytes;
  return out;
}

py::bytes save(HostedWorld& world) {
  const std::vector<std::byte> bytes = world.work("save", [](World& w) { return w.save(); });
  return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

void load(HostedWorld& world, const py::bytes& bytes) {
  char* data = nullptr;
  py::ssize_t count = 0;
  if (PyBytes_AsStringAndSize(bytes.ptr(), &data, &count) != 0) throw py::error_already_set();
  const std::span<const char> given(data, static_cast<std::size_t>(count));
  need(world.work("load", [&](World& w) { return w.load(std::as_bytes(given)); }));
}

// The mesh as the engine uses it.
std::shared_ptr<Mesh> mesh(HostedWorld& world, BodyId body) {
  return world.glance("mesh", [&](World& w) {
    need(w.check(body));
    return std::make_shared<Mesh>(w.mesh(body));
  });
}

void bind_numbers(HostedWorldClass& world) {
  world.def("time", [](HostedWorld& w) { return w.glance("time", [](World& v) { return v.time(); }); })
      .def("energies",
           [](HostedWorld& w) { return dict_of(w.work("energies", [](World& v) { return v.energies(); })); })
      .def("momentum",
           [](HostedWorld& w) { return vectors(w.work("momentum", [](World& v) { return v.momentum(); })); })
      .def("gauges",
           [](HostedWorld& w) { return list_of(w.work("gauges", [](World& v) { return v.gauges(); })); })
      .def("constitutive_residual",
           [](HostedWorld& w) {
             return w.work("constitutive_residual", [](World& v) { return v.constitutive_residual(); });
           })
      .def("state_hash",
           [](HostedWorld& w) { return w.work("state_hash", [](World& v) { return v.state_hash(); }); })
      .def("method", [](HostedWorld& w) { return w.work("method", [](World& v) { return v.method(); }); })
      .def("warnings",
           [](HostedWorld& w) {
             py::list out;
             for (const auto& text : w.glance("warnings", [](World& v) { return v.warnings(); }))
               out.append(text);
             return out;
           })
      .def("size", &size);
}

}  // namespace

py::array vectors(const std::array<Vec3, 2>& two) {
  return array_of(std::vector<Vec3>(two.begin(), two.end()));
}

py::dict dict_of(const Energies& e) {
  py::dict out;
  out["kinetic"] = e.kinetic;
  out["elastic"] = e.elastic;
  out["gravity"] = e.gravity;
  out["loads"] = e.loads;
  out["pressures"] = e.pressures;
  return out;
}

py::list list_of(const std::vector<Gauge>& gauges) {
  py::list out;
  for (const Gauge& g : gauges) out.append(py::make_tuple(g.effect, g.kind, g.quantity, g.unit, g.value));
  return out;
}

void bind_reading(HostedWorldClass& world) {
  bind_numbers(world);
  world.def("positions", &positions)
      .def("velocities", &velocities)
      .def("mesh", &mesh)
      .def("measures", &measures)
      .def("fields", &fields)
      .def("reaction",
           [](HostedWorld& w, EffectId effect) {
             return vectors(w.work("reaction", [&](World& v) {
               if (auto r = v.check(effect); !r) throw Refused("reaction: " + r.error());
               return v.reaction(effect);
             }));
           })
      .def("save", &save)
      .def("load", &load);
}

}  // namespace isochor::python
