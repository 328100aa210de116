// What all files of the module share: refusals as exceptions, arrays in and out.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "isochor/types.h"

namespace isochor::python {

namespace py = pybind11;

// Becomes isochor.Error with the same sentence.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Becomes MemoryError.
struct NoMemory : std::runtime_error {
  using std::runtime_error::runtime_error;
};
[[noreturn]] inline void raise(const Error& error) {
  if (error.kind == ErrorKind::no_memory) throw NoMemory(error.message);
  throw Refused(error.message);
}

template <class T>
T need(Result<T> result) {
  if (!result) raise(result.failure());
  return std::move(result).value();
}
inline void need(const Result<void>& result) {
  if (!result) raise(result.failure());
}

// Arrays in: whatever numpy makes an array of, strided or not, is copied. `what` begins the sentence of a
// refusal, as in "Mesh: points".
std::vector<Vec3> points_in(const py::handle& values, const std::string& what);
// Shape (n, width), or any with n * width numbers where width is 0. Whole numbers from 0 to below `count`.
std::vector<Index> indices_in(const py::handle& values, const std::string& what, Index width, Index count);
std::vector<double> numbers_in(const py::handle& values, const std::string& what);
Vec3 vector_in(const py::handle& values, const std::string& what);

// Arrays out, read-only, of shape (n, width) or (n) where width is 0. They hold `owner`, in whose memory the
// numbers are.
using Owner = std::shared_ptr<const void>;
py::array array_of(std::span<const double> numbers, Index width, Owner owner);
py::array array_of(std::span<const Vec3> points, Owner owner);
py::array array_of(std::span<const Index> numbers, Index width, Owner owner);
// The vector moves into the array.
template <class T>
py::array array_of(std::vector<T>&& numbers, Index width) {
  const auto kept = std::make_shared<const std::vector<T>>(std::move(numbers));
  return array_of(std::span<const T>(*kept), width, kept);
}
inline py::array array_of(std::vector<Vec3>&& points) {
  const auto kept = std::make_shared<const std::vector<Vec3>>(std::move(points));
  return array_of(std::span<const Vec3>(*kept), kept);
}
py::array array_of(const Vec3& vector);
// "(2, 3)".
std::string shape_of(const py::array& array);

// One a file.
void bind_meshes(py::module_& module);
void bind_worlds(py::module_& module);
void bind_batches(py::module_& module);
void bind_scenes(py::module_& module);
void bind_catalog(py::module_& module);
void bind_inverse(py::module_& module);

}  // namespace isochor::python
