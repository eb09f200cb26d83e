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

}  // namespace

std::string ArrayLike::Shape() const {
  return ShapeText(array);
}

Rows::Rows(const ArrayLike& array, std::size_t columns, const char* name)
    : data_(array.data()), rows_(0), columns_(columns), name_(name) {
  if (array.ndim() == 2 && array.dim(1) == columns) {
    rows_ = array.dim(0);
  } else if (array.ndim() == 1 && columns == 1) {
    rows_ = array.dim(0);
  } else if ((array.ndim() == 1 && array.dim(0) == columns) ||
             (array.ndim() == 0 && columns == 1)) {
    rows_ = 1;
  } else {
    std::string message(name);
    message.append(" must have the shape (n, ").append(std::to_string(columns));
    message.append("), not ").append(array.Shape());
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

namespace nanobind::detail {

namespace {

template <class Array>
bool Convert(handle src, const char* dtype, Array* out, cleanup_list* cleanup) {
  try {
    // None would become NaN, and text a number.
    if (src.is_none() || PyUnicode_Check(src.ptr()) || PyBytes_Check(src.ptr())) return false;
    if (make_caster<Array> fits; fits.from_python(src, 0, cleanup)) {
      *out = fits.value;
      return true;
    }
    object numpy = module_::import_("numpy");
    object array = numpy.attr("asarray")(src);
    // Floats are no indices, and complex numbers no coordinates.
    const auto kind = cast<std::string>(array.attr("dtype").attr("kind"));
    if (dtype[0] == 'i' && kind != "i" && kind != "u") return false;
    if (dtype[0] == 'f' && kind != "f" && kind != "i" && kind != "u" && kind != "b") return false;
    array =
        numpy.attr("ascontiguousarray")(array.attr("astype")(dtype, arg("casting") = "same_kind"))
            .attr("reshape")(array.attr("shape"));
    make_caster<Array> caster;
    if (!caster.from_python(array, 0, cleanup)) return false;
    *out = caster.value;
    return true;
  } catch (python_error& error) {
    error.restore();
    PyErr_Clear();
    return false;
  } catch (...) {
    return false;
  }
}

}  // namespace

bool type_caster<glissade::python::ArrayLike>::from_python(handle src, std::uint32_t,
                                                           cleanup_list* cleanup) noexcept {
  return Convert(src, "float64", &value.array, cleanup);
}

bool type_caster<glissade::python::IndexLike>::from_python(handle src, std::uint32_t,
                                                           cleanup_list* cleanup) noexcept {
  return Convert(src, "int64", &value.array, cleanup);
}

}  // namespace nanobind::detail
