#include "interop.h"

#include <cmath>
#include <limits>

#include "engine/base/text.h"

namespace isochor::python {

namespace {

// An array of numbers, or a refusal that says what it is instead.
py::array numeric(const py::handle& values, const std::string& what, const char* kinds, const char* remedy) {
  py::array array;
  try {
    array = py::module_::import("numpy").attr("asarray")(values);
  } catch (py::error_already_set&) {
    throw Refused(what + ": no array can be made of it; give " + remedy);
  }
  const char kind = array.dtype().kind();
  if (std::string(kinds).find(kind) == std::string::npos && array.size() > 0) {
    throw Refused(what + ": an array of type " + py::str(array.dtype()).cast<std::string>() + "; give " +
                  remedy);
  }
  return array;
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

py::array read_only(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::capsule capsule_of(Owner owner) {
  return py::capsule(new Owner(std::move(owner)), [](void* held) { delete static_cast<Owner*>(held); });
}

template <class T>
py::array view(const T* data, std::size_t count, Index width, Owner owner) {
  std::vector<py::ssize_t> shape;
  if (width > 0) {
    const auto w = static_cast<std::size_t>(width);
    shape = {static_cast<py::ssize_t>(count / w), width};
  } else {
    shape = {static_cast<py::ssize_t>(count)};
  }
  // An empty vector has no address, and numpy would take that for an array to be made.
  static const T nothing{};
  return read_only(
      py::array(py::dtype::of<T>(), shape, count > 0 ? data : &nothing, capsule_of(std::move(owner))));
}

}  // namespace

namespace {

// `each`: what `width` numbers in turn are.
std::vector<double> finite_numbers(const py::array& given, const std::string& what, const char* each,
                                   std::size_t width) {
  const Doubles array = Doubles::ensure(given);
  if (!array) throw Refused(what + ": an array whose numbers do not fit a double; give float64");
  std::vector<double> out(array.data(), array.data() + array.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (std::isfinite(out[i])) continue;
    throw Refused(what + ": " + each + " " + std::to_string(i / width) + " holds " + number(out[i]) +
                  "; give finite numbers");
  }
  return out;
}

}  // namespace

std::string shape_of(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t d = 0; d < array.ndim(); ++d) text += (d > 0 ? ", " : "") + std::to_string(array.shape(d));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

std::vector<double> numbers_in(const py::handle& values, const std::string& what) {
  return finite_numbers(numeric(values, what, "fiu", "real numbers"), what, "entry", 1);
}

std::vector<Vec3> points_in(const py::handle& values, const std::string& what) {
  const py::array given = numeric(values, what, "fiu", "real numbers of shape (n, 3)");
  if (given.ndim() != 2 || given.shape(1) != 3)
    throw Refused(what + ": an array of shape " + shape_of(given) + "; give one of shape (n, 3)");
  const std::vector<double> flat = finite_numbers(given, what, "row", 3);
  std::vector<Vec3> out(flat.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]};
  return out;
}

Vec3 vector_in(const py::handle& values, const std::string& what) {
  const py::array given = numeric(values, what, "fiu", "three real numbers");
  if (given.ndim() != 1 || given.size() != 3)
    throw Refused(what + ": an array of shape " + shape_of(given) + "; give three numbers");
  const std::vector<double> flat = numbers_in(given, what);
  return {flat[0], flat[1], flat[2]};
}

std::vector<Index> indices_in(const py::handle& values, const std::string& what, Index width, Index count) {
  const std::string wanted =
      width > 0 ? "whole numbers of shape (n, " + std::to_string(width) + ")" : "whole numbers";
  const py::array given = numeric(values, what, "iu", wanted.c_str());
  const bool fits = width > 0 ? given.ndim() == 2 && given.shape(1) == width : given.ndim() == 1;
  if (!fits && given.size() > 0)
    throw Refused(what + ": an array of shape " + shape_of(given) + "; give " + wanted);
  const Integers array = Integers::ensure(given);
  if (!array) throw Refused(what + ": an array whose numbers are no whole numbers; give int64");
  std::vector<Index> out(static_cast<std::size_t>(array.size()));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::int64_t index = array.data()[i];
    if (index < 0 || index >= count) {
      throw Refused(what + ": entry " + std::to_string(i) + " is " + std::to_string(index) +
                    "; give numbers from 0 to " + std::to_string(count - 1));
    }
    out[i] = static_cast<Index>(index);
  }
  return out;
}

py::array array_of(std::span<const double> numbers, Index width, Owner owner) {
  return view(numbers.data(), numbers.size(), width, std::move(owner));
}
py::array array_of(std::span<const Index> numbers, Index width, Owner owner) {
  return view(numbers.data(), numbers.size(), width, std::move(owner));
}
py::array array_of(std::span<const Vec3> points, Owner owner) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return view(reinterpret_cast<const double*>(points.data()), 3 * points.size(), 3, std::move(owner));
}
py::array array_of(const Vec3& vector) {
  return array_of(std::vector<double>{vector.x, vector.y, vector.z}, 0);
}

}  // namespace isochor::python
