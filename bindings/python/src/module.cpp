// The module isochor._isochor: what the package in isochor/ is made on. Nothing of it is for users directly.
#include <string>

#include "interop.h"
#include "scenes/run/run.h"

namespace isochor::python {

namespace {

void translate(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const Refused& refused) {
    const py::object type = py::module_::import("isochor.errors").attr("Error");
    PyErr_SetString(type.ptr(), refused.what());
  } catch (const NoMemory& told) {
    PyErr_SetString(PyExc_MemoryError, told.what());
  }
}

}  // namespace

PYBIND11_MODULE(_isochor, module) {
  module.doc() = "The engine behind the package isochor.";
  py::register_exception_translator(translate);
  module.def("version", &version);
  module.def("build_description", &build_description);
  bind_meshes(module);
  bind_worlds(module);
  bind_batches(module);
  bind_scenes(module);
  bind_catalog(module);
  bind_inverse(module);
}

}  // namespace isochor::python
