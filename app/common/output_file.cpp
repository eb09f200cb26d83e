// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/output_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace glissade::app {

namespace {
bool stdout_is_for_data = false;
}

OutputFile::~OutputFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

Status OutputFile::Failed(int error) const {
  return {StatusCode::kIoError,
          path_ + ": cannot be written: " + std::strerror(error != 0 ? error : EIO)};
}

Status OutputFile::Open(const std::string& path) {
  namespace fs = std::filesystem;
  path_ = path;
  std::error_code error;
  if (fs::is_directory(path, error)) return Failed(EISDIR);
  const bool exists = fs::exists(path, error);
  const bool device = exists && !fs::is_regular_file(path, error);
  if (!device) {
    // A link stays a link.
    const fs::path target = exists ? fs::canonical(path, error) : fs::path(path);
    if (!error) path_ = target.string();
    temporary_ = path_ + ".part";
  }
  errno = 0;
  file_ = std::fopen(device ? path_.c_str() : temporary_.c_str(), "wb");
  return file_ != nullptr ? Status() : Failed(errno);
}

void OutputFile::Write(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size() && error_ == 0) {
    error_ = errno != 0 ? errno : EIO;
  }
}

Status OutputFile::Commit() {
  errno = 0;
  if (std::fclose(std::exchange(file_, nullptr)) != 0 && error_ == 0) {
    error_ = errno != 0 ? errno : EIO;
  }
  if (error_ == 0 && !temporary_.empty()) {
    std::error_code error;
    std::filesystem::rename(temporary_, path_, error);
    error_ = error.value();
  }
  if (error_ == 0) return {};
  if (!temporary_.empty()) std::remove(temporary_.c_str());
  return Failed(error_);
}

Status WriteFile(const std::string& path, std::string_view text) {
  if (path == "-") {
    if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() &&
        std::fflush(stdout) == 0) {
      return {};
    }
    return {StatusCode::kIoError, "standard output cannot be written"};
  }
  OutputFile file;
  if (Status status = file.Open(path); !status.ok()) return status;
  file.Write(text);
  return file.Commit();
}

std::FILE* TextStream() {
  return stdout_is_for_data ? stderr : stdout;
}

void KeepStdoutForData() {
  stdout_is_for_data = true;
}

}  // namespace glissade::app
