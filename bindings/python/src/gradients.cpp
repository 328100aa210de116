// Gradients of an equilibrium: outputs and parameters as tuples that begin with their kind, as gradients.py
// of the package makes them.
#include "isochor/gradients.h"

#include <pybind11/stl.h>

#include <optional>

#include "hosted_world.h"
#include "reports.h"
#include "scenes/parameters_by_keys.h"

namespace isochor::python {

namespace {

// One entry of a list of the query, and what sentences about it begin with.
struct Entry {
  HostedWorld& world;
  py::tuple given;
  std::string who;

  std::string kind() const { return given[0].cast<std::string>(); }
  std::string about(const char* what) const { return who + ": " + what; }

  template <class Id>
  Id id() const {
    const Id one = given[1].cast<Id>();
    if (auto r = world.glance("gradients", [&](World& w) { return w.check(one); }); !r)
      throw Refused(who + ": " + r.error());
    return one;
  }
  Index node_count() const {
    const BodyId body = id<BodyId>();
    return world.glance("gradients", [&](World& w) { return static_cast<Index>(w.positions(body).size()); });
  }
};

// The numbers of nodes; None: all.
std::vector<Index> nodes_in(const Entry& e) {
  const Index count = e.node_count();
  if (!e.given[2].is_none()) return indices_in(e.given[2], e.about("nodes"), 0, count);
  std::vector<Index> all(static_cast<std::size_t>(count));
  for (Index n = 0; n < count; ++n) all[static_cast<std::size_t>(n)] = n;
  return all;
}

// One vector a node, or, as the package says, one for all of them.
std::vector<Vec3> vectors_in(const Entry& e, const char* what, std::size_t nodes) {
  if (e.given[4].cast<bool>()) return std::vector<Vec3>(nodes, vector_in(e.given[3], e.about(what)));
  return points_in(e.given[3], e.about(what));
}

// Functions of Python that make a material or an effect: called with the interpreter lock. isochor.Error is
// how one says that there is none of a value; what else it raises ends the call, and is raised by it.
class Makers {
 public:
  std::function<Result<std::string>(double)> function(py::object make) {
    // Copies are made and dropped without the lock.
    const auto kept = std::make_shared<py::object>(std::move(make));
    functions_.push_back(kept);
    return [this, kept](double value) -> Result<std::string> {
      return called([&] { return (*kept)(value).cast<std::string>(); });
    };
  }
  // Of positions, shape (n, 3): a number, and how it changes with each of them, of the same shape.
  Output::Function of_positions(py::object make) {
    const auto kept = std::make_shared<py::object>(std::move(make));
    functions_.push_back(kept);
    return [this, kept](std::span<const Vec3> x, std::span<Vec3> gradient) -> Result<double> {
      return called([&] {
        std::vector<double> numbers;
        for (const Vec3& v : x) numbers.insert(numbers.end(), {v.x, v.y, v.z});
        const py::array where = array_of(std::move(numbers), 3);
        const auto made = (*kept)(where).cast<py::tuple>();
        const std::vector<Vec3> by = points_in(made[1], "the gradient of the function");
        if (by.size() != gradient.size())
          throw Refused("its gradient has " + std::to_string(by.size()) + " vectors for " +
                        std::to_string(gradient.size()) + " nodes");
        std::copy(by.begin(), by.end(), gradient.begin());
        return made[0].cast<double>();
      });
    };
  }
  void raise_again() {
    if (raised_) throw py::error_already_set(*raised_);
  }

 private:
  template <class Call>
  auto called(const Call& call) -> Result<decltype(call())> {
    if (raised_) return Error{"a function raised an exception"};
    const py::gil_scoped_acquire locked;
    try {
      return call();
    } catch (const Refused& refused) {
      return Error{refused.what()};
    } catch (py::error_already_set& error) {
      if (error.matches(py::module_::import("isochor.errors").attr("Error")))
        return Error{py::str(error.value()).cast<std::string>()};
      raised_.emplace(error);
      return Error{"a function raised an exception"};
    }
  }

  std::vector<std::shared_ptr<py::object>> functions_;
  std::optional<py::error_already_set> raised_;
};

Output output_of(const Entry& e, Makers& makers) {
  const std::string kind = e.kind();
  if (kind == "elastic_energy") return Output::elastic_energy();
  if (kind == "energy") return Output::energy(e.given[2].cast<std::string>());
  if (kind == "gauge") return Output::gauge(e.id<EffectId>(), e.given[2].cast<std::string>());
  if (kind == "reaction") {
    return Output::reaction(e.id<EffectId>(), vector_in(e.given[2], e.about("force")),
                            vector_in(e.given[3], e.about("moment")));
  }
  if (kind == "effect_force") {
    const auto effect = e.id<EffectId>();
    const Entry of_body{e.world, py::make_tuple(kind, e.given[2]), e.who};
    return Output::effect_force(effect, of_body.id<BodyId>(), vector_in(e.given[3], e.about("direction")));
  }
  const auto body = e.id<BodyId>();
  if (kind == "stress") return Output::stress(body, e.given[2].cast<Index>(), e.given[3].cast<std::string>());
  if (kind == "of_positions")
    return Output::of_positions(body, makers.of_positions(py::reinterpret_borrow<py::object>(e.given[2])));
  if (kind == "material_point") {
    return Output::material_point(body, vector_in(e.given[2], e.about("point")),
                                  vector_in(e.given[3], e.about("direction")));
  }
  if (kind == "node") {
    const py::list one(1);
    one[0] = e.given[2];
    const auto node = indices_in(one, e.about("nodes"), 0, e.node_count());
    return Output::node(body, node.front(), vector_in(e.given[3], e.about("direction")));
  }
  std::vector<Index> nodes = nodes_in(e);
  if (kind == "distance") {
    std::vector<Vec3> targets = vectors_in(e, "targets", nodes.size());
    return Output::distance(body, std::move(nodes), std::move(targets));
  }
  std::vector<Vec3> weights = vectors_in(e, "weights", nodes.size());
  if (kind == "square")
    return Output::square(body, std::move(nodes), std::move(weights), e.given[5].cast<double>());
  return Output::positions(body, std::move(nodes), std::move(weights));
}

// Of (..., path, keys) or (..., value, function).
NumberInKeys number_of(const Entry& e, Makers& makers) {
  const py::handle first = e.given[4];
  if (!py::isinstance<py::str>(first))
    return {first.cast<double>(), makers.function(py::reinterpret_borrow<py::object>(e.given[5]))};
  auto number = number_in_keys(e.given[5].cast<std::string>(), first.cast<std::string>());
  if (!number) throw Refused(e.who + ": " + number.error());
  return std::move(number).value();
}

Parameter constant_of(const Entry& e, Makers& makers) {
  const auto effect = e.id<EffectId>();
  PartContext context = e.world.glance("gradients", [&](World& w) {
    PartContext names = e.world.meaning().in(w);
    std::erase(names.names_taken, w.effect_name(effect));
    return names;
  });
  return constant_by_keys(effect, e.given[3].cast<std::string>(), number_of(e, makers), std::move(context));
}

Parameter parameter_of(const Entry& e, Makers& makers) {
  const std::string kind = e.kind();
  if (kind == "amount_of") return Parameter::amount_of(e.id<EffectId>());
  if (kind == "gravity") return Parameter::gravity(vector_in(e.given[3], e.about("direction")));
  if (kind == "constant_of") return constant_of(e, makers);
  if (kind == "curve_point") {
    Curve curve;
    for (const auto& [t, value] : e.given[3].cast<std::vector<std::pair<double, double>>>())
      curve.points.push_back({t, value});
    return Parameter::curve_point(e.id<EffectId>(), std::move(curve), e.given[4].cast<Index>());
  }
  const auto body = e.id<BodyId>();
  if (kind == "force_at") {
    return Parameter::force_at(body, vector_in(e.given[3], e.about("point")),
                               vector_in(e.given[4], e.about("force")));
  }
  if (kind == "shape") return Parameter::shape(body, points_in(e.given[3], e.about("motion")));
  if (kind == "initial_velocity")
    return Parameter::initial_velocity(body, points_in(e.given[3], e.about("motion")));
  if (kind == "cell_stiffness") return Parameter::cell_stiffness(body);
  std::string region = e.given[3].cast<std::string>();
  if (kind == "density") return Parameter::density(body, std::move(region));
  if (kind == "stiffness") return Parameter::stiffness(body, std::move(region));
  return material_by_keys(body, std::move(region), number_of(e, makers), "");
}

Entry entry_of(HostedWorld& world, const py::handle& given, const std::string& call, const char* list,
               std::size_t place) {
  return Entry{world, given.cast<py::tuple>(), call + ": " + list + "[" + std::to_string(place) + "]"};
}

std::vector<Parameter> parameters_of(HostedWorld& world, const std::string& call, const py::list& parameters,
                                     const py::list& places, Makers& makers) {
  std::vector<Parameter> out;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const Entry e = entry_of(world, parameters[k], call, "parameters", places[k].cast<std::size_t>());
    out.push_back(parameter_of(e, makers));
    out.back().step = e.given[2].cast<double>();
  }
  return out;
}

GradientQuery query_of(HostedWorld& world, const py::list& outputs, const py::list& parameters,
                       const py::list& places, Makers& makers) {
  GradientQuery query;
  for (std::size_t j = 0; j < outputs.size(); ++j)
    query.outputs.push_back(output_of(entry_of(world, outputs[j], "gradients", "outputs", j), makers));
  query.parameters = parameters_of(world, "gradients", parameters, places, makers);
  return query;
}

constexpr const char* kTrajectory = "trajectory_gradients";

// `outputs`: of each a list of (step, output).
TrajectoryQuery trajectory_of(HostedWorld& world, std::vector<double> steps, const py::list& outputs,
                              const py::list& parameters, const py::list& places, Makers& makers) {
  TrajectoryQuery query;
  query.steps = std::move(steps);
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    TimedOutput& output = query.outputs.emplace_back();
    for (const py::handle& term : outputs[j].cast<py::list>()) {
      const auto pair = term.cast<py::tuple>();
      output.terms.push_back(
          {pair[0].cast<Index>(), output_of(entry_of(world, pair[1], kTrajectory, "outputs", j), makers)});
    }
  }
  query.parameters = parameters_of(world, kTrajectory, parameters, places, makers);
  return query;
}

// All numbers of an output side by side: dJ/dp of (outputs, columns), flat.
py::dict dict_of(Gradients&& told, const std::vector<Index>& numbers_of) {
  std::vector<double> jacobian;
  for (const auto& row : told.by) {
    for (const auto& numbers : row) jacobian.insert(jacobian.end(), numbers.begin(), numbers.end());
  }
  py::list widths, undecided;
  for (const Index width : numbers_of) widths.append(width);
  for (const std::string& name : told.undecided) undecided.append(name);
  py::dict out;
  out["values"] = array_of(std::move(told.values), 0);
  out["jacobian"] = array_of(std::move(jacobian), 0);
  out["widths"] = widths;
  out["regular"] = told.regular;
  out["note"] = told.note;
  out["undecided"] = undecided;
  out["adjoint"] = told.adjoint;
  out["kept_states"] = told.kept_states;
  out["steps_again"] = told.steps_again;
  out["state_bytes"] = told.state_bytes;
  return out;
}

// Parameters of several numbers are several of the engine's: its sentences with the place in the user's list.
Error at_its_place(Error error, const std::string& call, const py::list& places) {
  const std::string start = call + ": parameters[";
  if (!error.message.starts_with(start)) return error;
  const std::size_t end = error.message.find(']');
  const auto number = static_cast<std::size_t>(std::stoul(error.message.substr(start.size())));
  error.message = start + std::to_string(places[number].cast<std::size_t>()) + error.message.substr(end);
  return error;
}

// `places`: of each parameter, where in the user's list it is.
py::dict gradients(HostedWorld& world, const py::list& outputs, const py::list& parameters,
                   const py::list& places, int mode, bool unstable) {
  need(world.work("gradients", [](World& w) { return w.compile(); }));
  Makers makers;
  GradientQuery query = query_of(world, outputs, parameters, places, makers);
  query.mode = static_cast<GradientQuery::Mode>(mode);
  query.unstable = unstable;
  std::vector<Index> numbers_of;
  auto told = world.work("gradients", [&](World& w) {
    for (const Parameter& p : query.parameters)
      numbers_of.push_back(p.kind == Parameter::Kind::cells ? w.mesh(p.body).cell_count() : 1);
    return w.gradients(query);
  });
  makers.raise_again();
  if (!told) raise(at_its_place(told.failure(), "gradients", places));
  return dict_of(std::move(told).value(), numbers_of);
}

py::dict trajectory_gradients(HostedWorld& world, std::vector<double> steps, const py::list& outputs,
                              const py::list& parameters, const py::list& places, int mode, Index kept) {
  need(world.work(kTrajectory, [](World& w) { return w.compile(); }));
  Makers makers;
  TrajectoryQuery query = trajectory_of(world, std::move(steps), outputs, parameters, places, makers);
  query.mode = static_cast<GradientQuery::Mode>(mode);
  query.kept_states = kept;
  std::vector<Index> numbers_of;
  auto told = world.work(kTrajectory, [&](World& w) {
    for (const Parameter& p : query.parameters)
      numbers_of.push_back(p.kind == Parameter::Kind::cells ? w.mesh(p.body).cell_count() : 1);
    return w.trajectory_gradients(query);
  });
  makers.raise_again();
  if (!told) raise(at_its_place(told.failure(), kTrajectory, places));
  return dict_of(std::move(told).value(), numbers_of);
}

}  // namespace

void bind_gradients(HostedWorldClass& world) {
  world.def("gradients", &gradients);
  world.def("trajectory_gradients", &trajectory_gradients);
}

}  // namespace isochor::python
