// Batches: stepped together, set and read by arrays of shape (worlds, ...).
#include <numeric>

#include "hosted_batch.h"
#include "reports.h"

namespace isochor::python {

namespace {

using BatchPtr = std::shared_ptr<HostedBatch>;

BatchPtr make(const std::shared_ptr<HostedWorld>& world, Index count, int threads) {
  Result<WorldBatch> made =
      world->work("WorldBatch", [&](World& w) { return WorldBatch::create(w, count, threads); });
  return std::make_shared<HostedBatch>(need(std::move(made)), world->meaning(), world->log());
}

py::list list_of(const std::vector<StepReport>& reports) {
  py::list out;
  for (const StepReport& r : reports) out.append(dict_of(r));
  return out;
}

py::list advance(HostedBatch& batch, double h) {
  return list_of(batch.step("advance", [h](WorldBatch& b) { return b.advance(h); }));
}
py::list step(HostedBatch& batch, double h, int iterations, double seconds) {
  const StepBudget budget{iterations, seconds};
  return list_of(batch.step("step", [&](WorldBatch& b) { return b.step(h, budget); }));
}

// Vectors of a body in every world: an array of shape (worlds, nodes, 3).
template <class Copy>
py::array vectors(HostedBatch& batch, const char* call, BodyId body, const Copy& copy) {
  auto out = std::make_shared<std::vector<Vec3>>();
  need(batch.work(call, [&](WorldBatch& b) -> Result<void> {
    if (auto r = b[0].compile(); !r) return r;
    if (auto r = b[0].check(body); !r) return Error{std::string(call) + ": " + r.error()};
    out->resize(b[0].positions(body).size() * static_cast<std::size_t>(b.size()));
    return copy(b, *out);
  }));
  const py::array flat = array_of(std::span<const Vec3>(*out), out);
  return flat.attr("reshape")(batch.size(), -1, 3);
}

// Numbers of shape (worlds, ...) as rows of vectors, one a world.
std::vector<std::vector<Vec3>> rows_in(HostedBatch& batch, const py::object& values, const std::string& what,
                                       bool one_each) {
  const py::array given = py::module_::import("numpy").attr("asarray")(values);
  const py::ssize_t dimensions = one_each ? 2 : 3;
  if (given.ndim() != dimensions || given.shape(0) != batch.size() || given.shape(dimensions - 1) != 3) {
    throw Refused(what + ": an array of shape " + shape_of(given) + "; give one of shape (" +
                  std::to_string(batch.size()) + (one_each ? ", 3)" : ", n, 3)"));
  }
  const std::vector<Vec3> all = points_in(given.attr("reshape")(-1, 3), what);
  const auto worlds = static_cast<std::size_t>(batch.size()), each = all.size() / worlds;
  std::vector<std::vector<Vec3>> out;
  for (std::size_t w = 0; w < worlds; ++w)
    out.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(w * each),
                     all.begin() + static_cast<std::ptrdiff_t>((w + 1) * each));
  return out;
}

// Calls set(world, row) for each world; the sentence of a refusal says which.
template <class Set>
void set_rows(HostedBatch& batch, const char* call, const py::object& values, const char* what, bool one_each,
              const Set& set) {
  const auto rows = rows_in(batch, values, std::string(call) + ": " + what, one_each);
  need(batch.work(call, [&](WorldBatch& b) -> Result<void> {
    for (Index w = 0; w < b.size(); ++w) {
      if (auto r = set(b[w], rows[static_cast<std::size_t>(w)]); !r)
        return Error{"world " + std::to_string(w) + " of the batch: " + r.error()};
    }
    return {};
  }));
}

void set_amounts(HostedBatch& batch, EffectId effect, const py::object& values) {
  const std::vector<double> amounts = numbers_in(values, "set_amounts: amounts");
  need(batch.work("set_amounts", [&](WorldBatch& b) { return b.set_amounts(effect, amounts); }));
}

void reset(HostedBatch& batch, const py::object& marked) {
  std::vector<std::uint8_t> marks;
  if (!marked.is_none()) {
    const auto given = py::array_t<bool, py::array::c_style | py::array::forcecast>::ensure(marked);
    if (!given || given.ndim() != 1 || given.size() != batch.size()) {
      throw Refused("reset: the marks are not " + std::to_string(batch.size()) +
                    " flags; give one a world, or None for all");
    }
    marks.assign(given.data(), given.data() + given.size());
  }
  need(batch.work("reset", [&](WorldBatch& b) { return b.reset(marks); }));
}

// What effects report in every world: by effect and quantity, one number a world.
py::list gauges(HostedBatch& batch) {
  const auto all = batch.work("gauges", [](WorldBatch& b) {
    std::vector<std::vector<Gauge>> found;
    for (Index w = 0; w < b.size(); ++w) found.push_back(b[w].gauges());
    return found;
  });
  py::list out;
  for (const Gauge& first : all.front()) {
    std::vector<double> values;
    for (const auto& of_world : all) {
      double value = std::nan("");
      for (const Gauge& g : of_world) {
        if (g.effect == first.effect && g.quantity == first.quantity) value = g.value;
      }
      values.push_back(value);
    }
    out.append(py::make_tuple(first.effect, first.quantity, array_of(std::move(values), 0)));
  }
  return out;
}

py::list hashes(HostedBatch& batch) {
  py::list out;
  for (const std::uint64_t hash : batch.work("state_hashes", [](WorldBatch& b) {
         std::vector<std::uint64_t> all;
         for (Index w = 0; w < b.size(); ++w) all.push_back(b[w].state_hash());
         return all;
       }))
    out.append(hash);
  return out;
}

py::tuple memory(HostedBatch& batch) {
  const WorldBatch::Memory m = batch.work("memory", [](WorldBatch& b) { return b.memory(); });
  return py::make_tuple(m.each, m.shared);
}

}  // namespace

void bind_batches(py::module_& module) {
  py::class_<HostedBatch, BatchPtr>(module, "WorldBatch")
      .def(py::init(&make))
      .def("size", &HostedBatch::size)
      .def("threads", &HostedBatch::threads)
      .def("world", &HostedBatch::world)
      .def("advance", &advance)
      .def("step", &step)
      .def("reset", &reset)
      .def("set_amounts", &set_amounts)
      .def("positions",
           [](HostedBatch& b, BodyId body) {
             return vectors(b, "positions", body,
                            [&](WorldBatch& w, std::vector<Vec3>& out) { return w.positions(body, out); });
           })
      .def("velocities",
           [](HostedBatch& b, BodyId body) {
             return vectors(b, "velocities", body,
                            [&](WorldBatch& w, std::vector<Vec3>& out) { return w.velocities(body, out); });
           })
      .def("set_forces",
           [](HostedBatch& b, BodyId body, const py::object& values) {
             set_rows(b, "set_forces", values, "forces", false,
                      [&](World& w, const auto& row) { return w.set_forces(body, row); });
           })
      .def("set_velocities",
           [](HostedBatch& b, BodyId body, const py::object& values) {
             set_rows(b, "set_velocities", values, "velocities", false,
                      [&](World& w, const auto& row) { return w.set_velocities(body, row); });
           })
      .def("set_positions",
           [](HostedBatch& b, BodyId body, const py::object& values) {
             set_rows(b, "set_positions", values, "positions", false,
                      [&](World& w, const auto& row) { return w.set_positions(body, row); });
           })
      .def("set_gravity",
           [](HostedBatch& b, const py::object& values) {
             set_rows(b, "set_gravity", values, "gravity", true,
                      [](World& w, const auto& row) { return w.set_gravity(row.front()); });
           })
      .def("gauges", &gauges)
      .def("state_hashes", &hashes)
      .def("memory", &memory);
}

}  // namespace isochor::python
