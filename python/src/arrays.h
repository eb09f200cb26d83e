// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

/// \file
/// Numpy arrays in and out. In: whatever numpy.asarray takes, as rows of doubles. Out: arrays that
/// own their numbers, or look into an object that they keep alive.
namespace glissade::python {

namespace nb = nanobind;

using DoubleArray = nb::ndarray<nb::numpy, const double, nb::c_contig, nb::device::cpu>;
using Int64Array = nb::ndarray<nb::numpy, const std::int64_t, nb::c_contig, nb::device::cpu>;

/// An argument that is an array, or can be made one (lists, other number types). Converted once,
/// and not copied where it is C-contiguous float64.
struct ArrayLike {
  DoubleArray array;

  [[nodiscard]] const double* data() const { return array.data(); }
  [[nodiscard]] std::size_t ndim() const { return array.ndim(); }
  [[nodiscard]] std::size_t size() const { return array.size(); }
  [[nodiscard]] std::size_t dim(std::size_t i) const { return array.shape(i); }
  /// "(3, 7)"
  [[nodiscard]] std::string Shape() const;
};
/// The same of integers.
struct IndexLike {
  Int64Array array;

  [[nodiscard]] const std::int64_t* data() const { return array.data(); }
  [[nodiscard]] std::size_t size() const { return array.size(); }
};

/// n rows of `columns` numbers; one row alone is a matrix of one row, and where columns is 1 a
/// vector is a column. ValueError, with the name, for every other shape.
class Rows {
 public:
  Rows(const ArrayLike& array, std::size_t columns, const char* name);
  [[nodiscard]] std::size_t size() const { return rows_; }
  [[nodiscard]] const double* operator[](std::size_t row) const { return data_ + row * columns_; }
  /// The row, or the only one that there is for all of n.
  [[nodiscard]] const double* ForEach(std::size_t row) const {
    return rows_ == 1 ? data_ : data_ + row * columns_;
  }
  /// ValueError unless there are n, or one for all.
  void ExpectOneOr(std::size_t n) const;
  void Expect(std::size_t n) const;

 private:
  const double* data_;
  std::size_t rows_, columns_;
  const char* name_;
};

/// An array that is returned. As a type of its own: nanobind refuses an ndarray that has an owner
/// as what a property returns.
template <class T>
struct Out {
  nb::ndarray<nb::numpy, T> array;
};
using OutArray = Out<double>;
/// Takes the numbers over: nothing is copied.
OutArray Own(std::vector<double> values, std::initializer_list<std::size_t> shape);
Out<std::int64_t> Own(std::vector<std::int64_t> values);
/// Looks into `owner`, which lives as long as the array. Read-only: what it looks at is a result.
Out<const double> View(const double* data, std::initializer_list<std::size_t> shape,
                       nb::handle owner);

}  // namespace glissade::python

namespace nanobind::detail {

template <>
struct type_caster<glissade::python::ArrayLike> {
  NB_TYPE_CASTER(glissade::python::ArrayLike, const_name("numpy.typing.ArrayLike"))
  bool from_python(handle src, std::uint32_t flags, cleanup_list* cleanup) noexcept;
  static handle from_cpp(const glissade::python::ArrayLike& value, rv_policy policy,
                         cleanup_list* cleanup) noexcept {
    return make_caster<glissade::python::DoubleArray>::from_cpp(value.array, policy, cleanup);
  }
};
template <>
struct type_caster<glissade::python::IndexLike> {
  NB_TYPE_CASTER(glissade::python::IndexLike, const_name("numpy.typing.ArrayLike"))
  bool from_python(handle src, std::uint32_t flags, cleanup_list* cleanup) noexcept;
  static handle from_cpp(const glissade::python::IndexLike& value, rv_policy policy,
                         cleanup_list* cleanup) noexcept {
    return make_caster<glissade::python::Int64Array>::from_cpp(value.array, policy, cleanup);
  }
};

template <class T>
struct type_caster<glissade::python::Out<T>> {
  using Value = glissade::python::Out<T>;
  static constexpr auto Name = const_name<std::is_integral_v<T>>(
      "numpy.typing.NDArray[numpy.int64]", "numpy.typing.NDArray[numpy.float64]");
  static handle from_cpp(const Value& value, rv_policy, cleanup_list* cleanup) noexcept {
    return make_caster<ndarray<numpy, T>>::from_cpp(value.array, rv_policy::automatic, cleanup);
  }
};

}  // namespace nanobind::detail
