// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/text_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "io/temp_file.h"
#include "io/text_reader.h"

namespace glissade::internal {
namespace {

TEST(TextWriter, AsManyDigitsAsItTakesForTheSameBits) {
  TempFiles files;
  const double numbers[] = {0.1,    1.0 / 3.0,
                            -0.0,   1e300,
                            5e-324, 12345678901234567.0,
                            M_PI,   -2e-9,
                            460,    std::numeric_limits<double>::max()};
  for (const char* name : {"a.txt", "a.txt.gz", "a.txt.bz2"}) {
    auto writer = TextWriter::Create(files.Path(name));
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    for (double x : numbers)
      writer.value().Word("x").Number(x).Integer(-7).EndLine();
    ASSERT_TRUE(writer.value().Close().ok());
    auto reader = TextReader::Open(files.Path(name));
    TextReader& in = reader.value();
    for (double x : numbers) {
      in.Expect("x");
      const double y = in.Number("x");
      EXPECT_EQ(std::signbit(x), std::signbit(y));
      EXPECT_EQ(x, y);
      EXPECT_EQ(in.Integer(-7, -7, "seven"), -7);
    }
    in.ExpectEnd();
    EXPECT_TRUE(in.ok()) << in.status().message();
  }
  EXPECT_EQ(files.Read("a.txt").substr(0, 11), "x 0.1 -7\nx ");
  EXPECT_EQ(files.Read("a.txt.gz").substr(0, 2), "\x1f\x8b");
  EXPECT_EQ(files.Read("a.txt.bz2").substr(0, 3), "BZh");
}

TEST(TextWriter, TheFileAppearsWholeOrNotAtAll) {
  TempFiles files;
  files.Write("kept", "before");
  {
    auto writer = TextWriter::Create(files.Path("kept"));
    writer.value().Line(std::string(1 << 20, 'x'));
  }
  EXPECT_EQ(files.Read("kept"), "before");
  EXPECT_EQ(files.Count(), 1);
  {
    auto writer = TextWriter::Create(files.Path("new"));
    writer.value().Line("x");
  }
  EXPECT_EQ(files.Count(), 1);
  {
    auto writer = TextWriter::Create(files.Path("kept"));
    writer.value().Line("after");
    EXPECT_TRUE(writer.value().Close().ok());
  }
  EXPECT_EQ(files.Read("kept"), "after\n");
  EXPECT_EQ(files.Count(), 1);
}

TEST(TextWriter, ALinkStaysALinkAndADeviceADevice) {
  TempFiles files;
  files.Write("target", "before");
  std::filesystem::create_symlink(files.Path("target"), files.Path("link"));
  auto writer = TextWriter::Create(files.Path("link"));
  writer.value().Line("after");
  EXPECT_TRUE(writer.value().Close().ok());
  EXPECT_TRUE(std::filesystem::is_symlink(files.Path("link")));
  EXPECT_EQ(files.Read("target"), "after\n");

  auto null = TextWriter::Create("/dev/null");
  ASSERT_TRUE(null.ok()) << null.status().message();
  null.value().Line("x");
  EXPECT_TRUE(null.value().Close().ok());
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(TextWriter, WhereNothingCanBeWritten) {
  TempFiles files;
  for (const std::string& path : {files.Path("no/such/folder/a.txt"), files.Path("."),
                                  files.Path("no/a.gz"), files.Path("no/a.bz2")}) {
    auto writer = TextWriter::Create(path);
    EXPECT_EQ(writer.status().code(), StatusCode::kIoError) << path;
    EXPECT_EQ(writer.status().message().rfind(path, 0), 0u) << writer.status().message();
  }
  EXPECT_EQ(files.Count(), 0);
  if (std::filesystem::exists("/dev/full")) {
    auto full = TextWriter::Create("/dev/full");
    ASSERT_TRUE(full.ok());
    full.value().Line(std::string(1 << 20, 'x'));
    const Status status = full.value().Close();
    EXPECT_EQ(status.code(), StatusCode::kIoError);
    EXPECT_NE(status.message().find("No space left"), std::string::npos) << status.message();
  }
}

}  // namespace
}  // namespace glissade::internal
