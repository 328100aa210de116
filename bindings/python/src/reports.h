// Results of the engine as dictionaries, which the package gives names and units.
#pragma once

#include "hosted_world.h"

namespace isochor::python {

using HostedWorldClass = py::class_<HostedWorld, std::shared_ptr<HostedWorld>>;

py::dict dict_of(const StageSeconds& seconds);
void put_counters(const SolveCounters& work, py::dict& out);
py::dict dict_of(const StepReport& report);
py::dict dict_of(const Energies& energies);
py::list list_of(const std::vector<Gauge>& gauges);
// Of shape (2, 3).
py::array vectors(const std::array<Vec3, 2>& two);

void bind_changing(HostedWorldClass& world);
void bind_stepping(HostedWorldClass& world);
void bind_reading(HostedWorldClass& world);
void bind_answers(HostedWorldClass& world);
void bind_gradients(HostedWorldClass& world);

}  // namespace isochor::python
