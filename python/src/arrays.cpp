// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <memory>

namespace glissade::python {

namespace {

template <class T>
std::string ShapeText(const T& array) {
  std::string text = "(";
  for (std::size_t i = 0; i < array.ndim(); ++i) {
    if (i > 0) text.append(", ");
    text.append(std::to_string(array.shape(i)));
  }
  return text.append(array.ndim() == 1 ? ",)" : ")");
}

template <class T>
Out<T> OwnVector(std::vector<T> values, std::size_t ndim, const std::size_t* shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* data = kept->data();
  nb::capsule owner(kept.release(),
                    [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return {nb::ndarray<nb::numpy, T>(data, ndim, shape, owner)};
}

[[noreturn]] void WrongKind(const char* name, const char* needed, const nb::object& array) {
  std::string message(name);
  message.append(" must be ").append(needed).append(", not ");
  message.append(nb::str(nb::object(array.attr("dtype"))).c_str());
  throw nb::type_error(message.c_str());
}

/// C-contiguous, of that type; of integers only what are integers. What numpy raises comes out.
nb::object Converted(const nb::object& source, const char* name, const char* dtype) {
  const nb::object numpy = nb::module_::import_("numpy");
  nb::object array = numpy.attr("asarray")(source);
  const bool integers = dtype[0] == 'i';
  const nb::object type = array.attr("dtype");
  const char kind = nb::str(nb::object(type.attr("kind"))).c_str()[0];
  const bool empty = nb::cast<std::size_t>(array.attr("size")) == 0;
  // Text is no number, floats are no indices, complex numbers no coordinates; [] is of floats.
  const char* kinds = integers ? "iu" : "fiub";
  if (std::string(kinds).find(kind) == std::string::npos && !(empty && kind == 'f')) {
    WrongKind(name, integers ? "integers" : "real numbers", array);
  }
  if (integers && kind == 'u' && !empty &&
      nb::cast<bool>(nb::bool_(array.attr("max")() > nb::int_(INT64_MAX)))) {
    std::string message(name);
    message.append(" has a number beyond 2^63 - 1");
    PyErr_SetString(PyExc_OverflowError, message.c_str());
    throw nb::python_error();
  }
  return numpy.attr("require")(array.attr("astype")(dtype, nb::arg("copy") = false), dtype, "CA");
}

}  // namespace

std::string Doubles::Shape() const {
  return ShapeText(array_);
}

Doubles::Doubles(const ArrayLike& source, const char* name) {
  if (nb::try_cast(source.source, array_, false)) return;
  const nb::object array = Converted(source.source, name, "float64");
  if (!nb::try_cast(array, array_)) WrongKind(name, "numbers", array);
}

Integers::Integers(const IndexLike& source, const char* name) {
  if (nb::try_cast(source.source, array_, false) && array_.ndim() == 1) return;
  const nb::object array = Converted(source.source, name, "int64");
  if (nb::cast<int>(array.attr("ndim")) != 1) {
    std::string message(name);
    message.append(" must have one dimension");
    throw nb::value_error(message.c_str());
  }
  if (!nb::try_cast(array, array_)) WrongKind(name, "integers", array);
}

Rows::Rows(const ArrayLike& array, std::size_t columns, const char* name)
    : numbers_(array, name), data_(numbers_.data()), rows_(0), columns_(columns), name_(name) {
  const Doubles& a = numbers_;
  if (a.ndim() == 2 && a.dim(1) == columns) {
    rows_ = a.dim(0);
  } else if (a.ndim() == 1 && columns == 1) {
    rows_ = a.dim(0);
  } else if (a.ndim() == 1 && a.dim(0) == 0) {
    rows_ = 0;  // []
  } else if ((a.ndim() == 1 && a.dim(0) == columns) || (a.ndim() == 0 && columns == 1)) {
    rows_ = 1;
  } else {
    std::string message(name);
    message.append(" must have the shape (n, ").append(std::to_string(columns));
    message.append("), not ").append(a.Shape());
    throw nb::value_error(message.c_str());
  }
}

void Rows::Expect(std::size_t n) const {
  if (rows_ == n) return;
  std::string message(name_);
  message.append(" has ").append(std::to_string(rows_)).append(" rows where ");
  message.append(std::to_string(n)).append(" are needed");
  throw nb::value_error(message.c_str());
}

void Rows::ExpectOneOr(std::size_t n) const {
  if (rows_ != 1) Expect(n);
}

OutArray Own(std::vector<double> values, std::initializer_list<std::size_t> shape) {
  return OwnVector(std::move(values), shape.size(), shape.begin());
}

Out<std::int64_t> Own(std::vector<std::int64_t> values) {
  const std::size_t size = values.size();
  return OwnVector(std::move(values), 1, &size);
}

Out<const double> View(const double* data, std::initializer_list<std::size_t> shape,
                       nb::handle owner) {
  return {nb::ndarray<nb::numpy, const double>(data, shape.size(), shape.begin(), owner)};
}

}  // namespace glissade::python
