// Runs of scenes, as dictionaries.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "scenes/run/run.h"

namespace isochor::python {

namespace py = pybind11;

pybind11::dict dict_of(const RunResult& result);

// Scene.solve_to(): what a search for an error found; `error` is a fraction or a text such as "1%".
pybind11::dict solve_to(const SceneDef& scene, const std::variant<double, std::string>& error,
                        const std::string& folder, int threads, std::optional<double> budget, int most_levels,
                        const pybind11::object& on_trial);

}  // namespace isochor::python
