// What a world answers when it is asked: contacts, orientations, derivatives of its equilibrium.
#include "hosted_world.h"
#include "reports.h"

namespace isochor::python {

namespace {

// Points of contacts that press, as arrays with one entry a point.
py::dict contacts(HostedWorld& world) {
  struct Named {
    ContactPoint point;
    std::string effect;
  };
  const auto found = world.work("contacts", [](World& w) {
    std::vector<Named> all;
    for (ContactPoint& p : w.contacts()) {
      const std::string name = w.effect_name(p.effect);
      all.push_back({std::move(p), name});
    }
    return all;
  });
  py::list effects, bodies, partners;
  std::vector<Index> nodes;
  std::vector<double> gaps, areas;
  std::vector<Vec3> positions, normals, normal_forces, frictions;
  for (const auto& [p, effect] : found) {
    effects.append(effect);
    bodies.append(p.body);
    partners.append(p.partner);
    nodes.push_back(p.node);
    gaps.push_back(p.gap);
    areas.push_back(p.area);
    positions.push_back(p.position);
    normals.push_back(p.normal);
    normal_forces.push_back(p.normal_force);
    frictions.push_back(p.friction);
  }
  py::dict out;
  out["effects"] = effects;
  out["bodies"] = bodies;
  out["partners"] = partners;
  out["nodes"] = array_of(std::move(nodes), 0);
  out["positions"] = array_of(std::move(positions));
  out["gaps"] = array_of(std::move(gaps), 0);
  out["normals"] = array_of(std::move(normals));
  out["normal_forces"] = array_of(std::move(normal_forces));
  out["frictions"] = array_of(std::move(frictions));
  out["areas"] = array_of(std::move(areas), 0);
  return out;
}

py::list contact_pairs(HostedWorld& world) {
  py::list out;
  for (const ContactPair& p : world.work("contact_pairs", [](World& w) { return w.contact_pairs(); }))
    out.append(py::make_tuple(p.body, p.partner, array_of(p.force), p.normal, p.points));
  return out;
}

ResponseInput input_of(const py::handle& given) {
  if (py::isinstance<EffectId>(given)) return ResponseInput::amount_of(given.cast<EffectId>());
  const auto force = given.cast<py::tuple>();
  return ResponseInput::force_at(force[0].cast<BodyId>(), vector_in(force[1], "derivatives: point"),
                                 vector_in(force[2], "derivatives: force"));
}

py::dict response_dict(Response&& response) {
  py::list positions, reactions;
  for (std::vector<Vec3>& body : response.positions) positions.append(array_of(std::move(body)));
  for (const auto& reaction : response.reactions) reactions.append(vectors(reaction));
  py::dict out;
  out["positions"] = positions;
  out["gauges"] = list_of(response.gauges);
  out["reactions"] = reactions;
  out["regular"] = response.regular;
  out["note"] = response.note;
  out["unstable_directions"] = response.unstable_directions;
  return out;
}

// Of each input: the id of an effect, for its amount, or (body, point, force).
py::list derivatives(HostedWorld& world, const py::list& given) {
  std::vector<ResponseInput> inputs;
  for (const py::handle one : given) inputs.push_back(input_of(one));
  auto responses = need(world.work("derivatives", [&](World& w) { return w.derivatives(inputs); }));
  py::list out;
  for (Response& response : responses) out.append(response_dict(std::move(response)));
  return out;
}

py::dict orientation(HostedWorld& world, const std::string& keys) {
  const Orientation o = need(world.work("orientation", [&](World& w) {
    return w.orientation(need(selection_from_keys(keys, world.meaning().in(w))));
  }));
  py::dict out;
  out["angle"] = o.angle;
  out["axis"] = array_of(o.axis);
  out["displacement"] = array_of(o.displacement);
  out["normal"] = array_of(o.normal);
  out["misfit"] = o.misfit;
  return out;
}

}  // namespace

void bind_answers(HostedWorldClass& world) {
  world.def("derivatives", &derivatives)
      .def("orientation", &orientation)
      .def("contacts", &contacts)
      .def("contact_pairs", &contact_pairs);
}

}  // namespace isochor::python
