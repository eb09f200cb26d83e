// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>

#include <cstdint>
#include <string>

namespace glissade::python {

/// The name of a file or folder: text, or what has one (pathlib).
struct FilePath {
  std::string text;
};

}  // namespace glissade::python

namespace nanobind::detail {

template <>
struct type_caster<glissade::python::FilePath> {
  NB_TYPE_CASTER(glissade::python::FilePath, const_name("str | os.PathLike[str]"))
  bool from_python(handle src, std::uint32_t, cleanup_list* cleanup) noexcept {
    make_caster<std::filesystem::path> path;
    if (!path.from_python(src, 0, cleanup)) return false;
    value.text = path.value.string();
    return true;
  }
  static handle from_cpp(const glissade::python::FilePath& value, rv_policy,
                         cleanup_list*) noexcept {
    return PyUnicode_FromString(value.text.c_str());
  }
};

}  // namespace nanobind::detail
