// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include "glissade/base/status.h"

namespace glissade::app {

/// A file that appears whole or not at all: written beside its place, moved there by Commit(). Left
/// without Commit() it leaves nothing behind and what was there before as it was.
class OutputFile {
 public:
  OutputFile() = default;
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  Status Open(const std::string& path);
  void Write(std::string_view text);
  Status Commit();

 private:
  [[nodiscard]] Status Failed(int error) const;

  std::string path_;
  std::string temporary_;  // empty where path_ is a device, written directly
  std::FILE* file_ = nullptr;
  int error_ = 0;
};

/// Opens, writes and commits; for "-", writes to standard output.
Status WriteFile(const std::string& path, std::string_view text);

/// Standard output, or standard error where standard output is for data.
std::FILE* TextStream();
void KeepStdoutForData();

/// Text for people.
template <class... Args>
void Print(fmt::format_string<Args...> format, Args&&... args) {
  fmt::print(TextStream(), format, std::forward<Args>(args)...);
}

}  // namespace glissade::app
