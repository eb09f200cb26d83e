// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "io/text_writer.h"

namespace glissade {

/// A folder of its own for each test, gone with it.
class TempFiles {
 public:
  TempFiles() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    dir_ = std::filesystem::path(::testing::TempDir()) /
           ("glissade_" + std::to_string(getpid()) + "_" + test->test_suite_name() + "_" +
            test->name());
    std::filesystem::create_directories(dir_);
  }
  ~TempFiles() {
    std::error_code error;
    std::filesystem::remove_all(dir_, error);
  }

  [[nodiscard]] std::string Path(const std::string& name) const { return (dir_ / name).string(); }
  [[nodiscard]] int Count() const {
    int n = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(dir_))
      ++n;
    return n;
  }
  std::string Write(const std::string& name, const std::string& content) const {
    std::ofstream(Path(name), std::ios::binary) << content;
    return Path(name);
  }
  /// Compressed if the name ends in .gz or .bz2.
  [[nodiscard]] std::string WriteCompressed(const std::string& name,
                                            const std::string& content) const {
    auto writer = internal::TextWriter::Create(Path(name));
    writer.value().Word(content);
    EXPECT_TRUE(writer.value().Close().ok());
    return Path(name);
  }
  [[nodiscard]] std::string Read(const std::string& name) const {
    std::ifstream in(Path(name), std::ios::binary);
    std::stringstream content;
    content << in.rdbuf();
    return content.str();
  }

 private:
  std::filesystem::path dir_;
};

}  // namespace glissade
