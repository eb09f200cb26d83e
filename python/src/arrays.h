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

/// An argument that is an array, or can be made one: whatever is not None. It becomes numbers in
/// the function that has it, which knows its name, and lets out what numpy raises.
struct ArrayLike {
  nb::object source;
};
/// The same of integers.
struct IndexLike {
  nb::object source;
};

/// float64, not copied where it is that and C-contiguous. TypeError, with the name, for what are no
/// real numbers.
class Doubles {
 public:
  Doubles(const ArrayLike& source, const char* name);
  [[nodiscard]] const double* data() const { return array_.data(); }
  [[nodiscard]] std::size_t ndim() const { return array_.ndim(); }
  [[nodiscard]] std::size_t size() const { return array_.size(); }
  [[nodiscard]] std::size_t dim(std::size_t i) const { return array_.shape(i); }
  /// "(3, 7)"
  [[nodiscard]] std::string Shape() const;

 private:
  DoubleArray array_;
};

/// int64, in one dimension. OverflowError for what does not fit.
class Integers {
 public:
  Integers(const IndexLike& source, const char* name);
  [[nodiscard]] const std::int64_t* data() const { return array_.data(); }
  [[nodiscard]] std::size_t size() const { return array_.size(); }

 private:
  Int64Array array_;
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
  Doubles numbers_;
  const double* data_;
  std::size_t rows_, columns_;
  const char* name_;
};
/// The only row. ValueError where there is none, or are more.
class OneRow {
 public:
  OneRow(const ArrayLike& array, std::size_t columns, const char* name)
      : rows_(array, columns, name) {
    rows_.Expect(1);
  }
  [[nodiscard]] const double* data() const { return rows_[0]; }

 private:
  Rows rows_;
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

template <class Like>
struct array_like_caster {
  NB_TYPE_CASTER(Like, const_name("numpy.typing.ArrayLike"))
  bool from_python(handle src, std::uint32_t, cleanup_list*) noexcept {
    if (src.is_none()) return false;
    value.source = borrow(src);
    return true;
  }
  static handle from_cpp(const Like& value, rv_policy, cleanup_list*) noexcept {
    return object(value.source).release();
  }
};
template <>
struct type_caster<glissade::python::ArrayLike> : array_like_caster<glissade::python::ArrayLike> {};
template <>
struct type_caster<glissade::python::IndexLike> : array_like_caster<glissade::python::IndexLike> {};

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
