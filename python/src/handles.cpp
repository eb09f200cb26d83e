// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "handles.h"

#include <nanobind/make_iterator.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace glissade::python {

template <class Handle>
std::string HandleArray<Handle>::TypeName() const {
  if (handles.empty()) return "";
  for (const Handle& handle : handles) {
    if (handle.type != handles[0].type) return "mixed";
  }
  return handles[0].type == nullptr ? "" : std::string(handles[0].type->name);
}
template struct HandleArray<AnyVertex>;
template struct HandleArray<AnyEdge>;

namespace {

[[noreturn]] void WrongNumber(const char* name, std::size_t has, const std::string& needed) {
  std::string message(name);
  message.append(" has ").append(std::to_string(has)).append(" handles where ");
  message.append(needed);
  throw nb::value_error(message.c_str());
}

using MaskLike = nb::ndarray<nb::numpy, const bool, nb::ndim<1>, nb::device::cpu>;

template <class Handle>
void BindArray(nb::module_& m, const char* name, const char* doc) {
  using Array = HandleArray<Handle>;
  const auto at = [](const Array& a, Py_ssize_t i) {
    const auto size = static_cast<Py_ssize_t>(a.size());
    if (i < 0) i += size;
    if (i < 0 || i >= size) throw nb::index_error("index out of range");
    return a.handles[static_cast<std::size_t>(i)];
  };
  nb::class_<Array>(m, name, doc)
      .def("__len__", &Array::size)
      .def("__getitem__",
           [at](const Array& a, Py_ssize_t i) { return Array(std::vector<Handle>{at(a, i)}); })
      .def("__getitem__",
           [](const Array& a, nb::slice slice) {
             const auto [start, stop, step, length] = slice.compute(a.size());
             Array out;
             out.handles.reserve(length);
             for (std::size_t k = 0; k < length; ++k) {
               const auto offset = static_cast<Py_ssize_t>(k) * step;
               out.handles.push_back(
                   a.handles[static_cast<std::size_t>(static_cast<Py_ssize_t>(start) + offset)]);
             }
             return out;
           })
      .def(
          "__getitem__",
          [at](const Array& a, const nb::object& which) {
            Array out;
            const auto take = [&](const std::int64_t* indices, std::size_t n) {
              out.handles.reserve(n);
              for (std::size_t k = 0; k < n; ++k)
                out.handles.push_back(at(a, static_cast<Py_ssize_t>(indices[k])));
            };
            if (Int64Array indices; nb::try_cast(which, indices, false) && indices.ndim() == 1) {
              take(indices.data(), indices.size());
              return out;
            }
            const bool is_array =
                nb::hasattr(which, "ndim") && nb::cast<int>(which.attr("ndim")) > 0;
            if (!is_array && PyIndex_Check(which.ptr()) && !PyBool_Check(which.ptr())) {
              const Py_ssize_t i = PyNumber_AsSsize_t(which.ptr(), PyExc_IndexError);
              if (i == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
              out.handles.push_back(at(a, i));
              return out;
            }
            constexpr const char* kWhat = "indices must be integers, a slice or a mask";
            if (PyUnicode_Check(which.ptr()) || nb::isinstance<Array>(which)) {
              throw nb::type_error(kWhat);
            }
            const nb::object array = nb::module_::import_("numpy").attr("asarray")(which);
            if (nb::cast<int>(array.attr("ndim")) != 1) throw nb::type_error(kWhat);
            if (MaskLike mask; nb::try_cast(array, mask, false)) {
              if (mask.shape(0) != a.size()) throw nb::index_error("mask of another length");
              for (std::size_t k = 0; k < a.size(); ++k) {
                if (mask(k)) out.handles.push_back(a.handles[k]);
              }
              return out;
            }
            const Integers indices(IndexLike{array}, "indices");
            take(indices.data(), indices.size());
            return out;
          },
          nb::arg("which"),
          nb::sig((std::string("def __getitem__(self, which: collections.abc.Sequence[int] | "
                               "collections.abc.Sequence[bool] | numpy.typing.NDArray[typing.Any] "
                               "| typing.SupportsIndex, /) -> ") +
                   name)
                      .c_str()))
      .def(
          "__iter__",
          [](nb::handle self) {
            // By index: each is an array of one, as from [i].
            return nb::steal(PySeqIter_New(self.ptr()));
          },
          nb::sig((std::string("def __iter__(self) -> collections.abc.Iterator[") + name + "]")
                      .c_str()))
      .def("__add__",
           [](const Array& a, const Array& b) {
             Array out(a.handles);
             out.handles.insert(out.handles.end(), b.handles.begin(), b.handles.end());
             return out;
           })
      .def(
          "__eq__",
          [](const Array& a, nb::handle other) {
            const Array* b = nullptr;
            return nb::try_cast(other, b) && b != nullptr && a.handles == b->handles;
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__",
           [](const Array& a) {
             std::size_t hash = a.size();
             for (const Handle& h : a.handles)
               hash = hash * 1000003u ^ std::hash<Handle>()(h);
             return hash;
           })
      .def_prop_ro("type", &Array::TypeName, "Name of their type, 'mixed', or '' of none.")
      .def(
          "names",
          [](const Array& a) {
            std::vector<std::string> names;
            for (const Handle& h : a.handles)
              names.push_back(ToString(h));
            return names;
          },
          "'VertexPose #3', ...: as messages name them.")
      .def("__repr__", [name](const Array& a) {
        std::string text(name);
        text.append("(").append(std::to_string(a.size()));
        if (a.size() > 0) text.append(" x ").append(a.TypeName());
        return text.append(")");
      });
}

}  // namespace

void ExpectOneOr(const VertexArray& array, std::size_t n, const char* name) {
  if (array.size() == n || array.size() == 1) return;
  WrongNumber(name, array.size(), std::to_string(n).append(" are needed"));
}

AnyVertex OnlyOne(const VertexArray& array, const char* name) {
  if (array.size() != 1) WrongNumber(name, array.size(), "one is needed");
  return array[0];
}

void BindHandles(nb::module_& m) {
  BindArray<AnyVertex>(m, "VertexArray",
                       "Handles of vertices, indexed like a numpy array: v[3], v[:2], v[[4, 1]], "
                       "v[mask].\n\nAlways an array, v[3] one of length 1. A handle stays valid "
                       "until its vertex is removed; of another problem it is refused.");
  BindArray<AnyEdge>(m, "EdgeArray", "Handles of edges; see VertexArray.");
}

}  // namespace glissade::python
