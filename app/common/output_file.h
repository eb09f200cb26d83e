// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

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

/// Opens, writes and commits.
Status WriteFile(const std::string& path, std::string_view text);

}  // namespace glissade::app
