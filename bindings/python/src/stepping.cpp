// Steps of a world and their reports.
#include "hosted_world.h"
#include "reports.h"

namespace isochor::python {

namespace {

py::dict step(HostedWorld& world, double h, int iterations, double seconds) {
  const StepBudget budget{iterations, seconds};
  return dict_of(world.step("step", [&](World& w) { return w.step(h, budget); }));
}
py::dict advance(HostedWorld& world, double h) {
  return dict_of(world.step("advance", [h](World& w) { return w.advance(h); }));
}
py::dict follow(HostedWorld& world, double length) {
  return dict_of(world.step("follow", [length](World& w) { return w.follow(length); }));
}

const char* name_of(CompileWork work) {
  if (work == CompileWork::numbers) return "numbers";
  return work == CompileWork::structure ? "structure" : "nothing";
}

const char* name_of(StepStatus status) {
  switch (status) {
    case StepStatus::converged:
      return "converged";
    case StepStatus::rejected:
      return "rejected";
    case StepStatus::cancelled:
      return "cancelled";
    case StepStatus::invalid:
      return "invalid";
    case StepStatus::unfinished:
      break;
  }
  return "unfinished";
}

}  // namespace

py::dict dict_of(const StageSeconds& s) {
  py::dict out;
  out["analyze"] = s.analyze;
  out["evaluate"] = s.evaluate;
  out["gather"] = s.gather;
  out["factor"] = s.factor;
  out["solve"] = s.solve;
  out["line_search"] = s.line_search;
  out["total"] = s.total;
  return out;
}

void put_counters(const SolveCounters& work, py::dict& out) {
  out["iterations"] = work.iterations;
  out["corrections"] = work.corrections;
  out["lagged"] = work.lagged;
  out["factorizations"] = work.factorizations;
  out["trials"] = work.trials;
  out["projected"] = work.projected;
  out["shifted"] = work.shifted;
  out["dual_steps"] = work.dual.steps;
  out["stand_ins"] = work.dual.stand_ins;
  out["dual_iterations"] = work.dual.iterations;
  out["linear_iterations"] = work.krylov.iterations;
}

py::dict dict_of(const StepReport& r) {
  py::dict out;
  out["status"] = name_of(r.status);
  out["reason"] = r.reason;
  out["warning"] = r.warning;
  out["time"] = r.time;
  out["substeps"] = r.substeps;
  out["rejected_substeps"] = r.rejected_substeps;
  out["rescues"] = r.rescues;
  out["error_rejections"] = r.error_rejections;
  out["negative_pivots"] = r.negative_pivots;
  out["expected_negative_pivots"] = r.expected_negative_pivots;
  out["unstable_directions"] = r.unstable_directions;
  out["time_error"] = r.time_error;
  out["min_J"] = r.min_J;
  out["inverted_cells"] = r.inverted_cells;
  out["force_residual"] = r.force_residual;
  out["row_residual"] = r.row_residual;
  out["linear_residual"] = r.linear_residual;
  out["compile_work"] = name_of(r.compiled.work);
  out["compile_seconds"] = r.compiled.seconds;
  put_counters(r, out);
  out["seconds"] = dict_of(r.seconds);
  return out;
}

void bind_stepping(HostedWorldClass& world) {
  world.def("step", &step)
      .def("advance", &advance)
      .def("follow", &follow)
      .def("compile_report",
           [](HostedWorld& w) {
             const CompileReport r = w.glance("compile", [](World& v) { return v.compile_report(); });
             return py::make_tuple(name_of(r.work), r.seconds);
           })
      .def("cancel", &HostedWorld::cancel)
      .def("set_progress", &HostedWorld::set_progress);
}

}  // namespace isochor::python
