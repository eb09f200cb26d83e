// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/text_reader.h"

#include <gtest/gtest.h>

#include <string>

#include "io/temp_file.h"

namespace glissade::internal {
namespace {

std::string Message(TextReader& in) {
  const std::string& message = in.status().message();
  EXPECT_EQ(message.rfind(in.path() + ":", 0), 0u) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  return message.substr(in.path().size() + 1);
}

TEST(TextReader, NumbersAsPrintfWritesThem) {
  TempFiles files;
  auto reader = TextReader::Open(
      files.Write("a", "1 -2.5 +3e+02\t-1.7E-05\r\n\n  .5 5. 1e-310 4.9406564584124654e-324\n"));
  TextReader& in = reader.value();
  EXPECT_EQ(in.Number("a"), 1.0);
  EXPECT_EQ(in.Number("b"), -2.5);
  EXPECT_EQ(in.Number("c"), 300.0);
  EXPECT_EQ(in.Number("d"), -1.7e-5);
  EXPECT_EQ(in.line(), 1);
  EXPECT_EQ(in.Number("e"), 0.5);
  EXPECT_EQ(in.line(), 3);
  EXPECT_EQ(in.Number("f"), 5.0);
  EXPECT_EQ(in.Number("g"), 1e-310);
  EXPECT_EQ(in.Number("h"), 4.9406564584124654e-324);
  EXPECT_TRUE(in.AtEnd());
  EXPECT_TRUE(in.ok());
  EXPECT_EQ(in.Number("one more"), 0.0);
  EXPECT_EQ(Message(in), "4: expected one more (a number), found the end of the file");
}

TEST(TextReader, WhatIsNoNumberIsNamedWithItsLine) {
  TempFiles files;
  const struct {
    const char* word;
    const char* rule;
  } cases[] = {{"nan", "a finite number"},
               {"-inf", "a finite number"},
               {"1e999", "a number that a double can hold"},
               {"1.5x", "a number"},
               {"0x10", "a number"},
               {"--3", "a number"},
               {"+-3", "a number"},
               {"+", "a number"},
               {"1,5", "a number"},
               {"one", "a number"}};
  for (const auto& [word, rule] : cases) {
    auto reader = TextReader::Open(files.Write("a", std::string("7\n8 ") + word + " 9\n"));
    TextReader& in = reader.value();
    in.Number("a");
    in.Number("b");
    EXPECT_TRUE(in.ok());
    EXPECT_EQ(in.Number("depth of point", 4), 0.0);
    EXPECT_EQ(Message(in),
              std::string("2: expected depth of point 4 (") + rule + "), found '" + word + "'");
    EXPECT_EQ(in.status().code(), StatusCode::kParseError);
    // The first failure stays, nothing is read any more.
    EXPECT_EQ(in.Number("c"), 0.0);
    EXPECT_TRUE(in.Word("d").empty());
    EXPECT_TRUE(in.AtEnd());
    EXPECT_EQ(Message(in).substr(0, 27), "2: expected depth of point ");
  }
}

TEST(TextReader, IntegersHaveABorder) {
  TempFiles files;
  const auto read = [&](const std::string& content, auto&& f) {
    auto reader = TextReader::Open(files.Write("a", content));
    f(reader.value());
    return reader.value().ok() ? "ok" : Message(reader.value());
  };
  EXPECT_EQ(read("5", [](TextReader& in) { EXPECT_EQ(in.Index(6, "i"), 5); }), "ok");
  EXPECT_EQ(read("6", [](TextReader& in) { in.Index(6, "i"); }),
            "1: expected i (0 to 5), found '6'");
  EXPECT_EQ(read("-1", [](TextReader& in) { in.Index(6, "i"); }),
            "1: expected i (0 to 5), found '-1'");
  EXPECT_EQ(read("5.0", [](TextReader& in) { in.Index(6, "i"); }),
            "1: expected i (an integer), found '5.0'");
  EXPECT_EQ(read("0", [](TextReader& in) { in.Count(1, "n"); }),
            "1: expected n (at least 1), found '0'");
  EXPECT_EQ(read("99999999999999999999", [](TextReader& in) { in.Count(1, "n"); }),
            "1: expected n (at least 1), found '99999999999999999999'");
  EXPECT_EQ(read("0", [](TextReader& in) { in.Positive("s"); }),
            "1: expected s (a number > 0), found '0'");
}

TEST(TextReader, CommentsPeekAndKeywords) {
  TempFiles files;
  auto reader = TextReader::Open(files.Write("a", "# one\n  #two\nKEY 3 # rest\n#\n4#4 END"), '#');
  TextReader& in = reader.value();
  EXPECT_EQ(in.Peek(), "KEY");
  EXPECT_EQ(in.line(), 3);
  in.Expect("KEY");
  EXPECT_EQ(in.Number("n"), 3.0);
  EXPECT_EQ(in.Word("w"), "4#4");
  EXPECT_EQ(in.line(), 5);
  EXPECT_FALSE(in.AtEnd());
  EXPECT_FALSE(in.AtEnd());
  in.ExpectEnd();
  EXPECT_EQ(Message(in), "5: expected the end of the file, found 'END'");
}

TEST(TextReader, TheEndOfALine) {
  TempFiles files;
  auto reader = TextReader::Open(files.Write("a", "1 2 \r\n3 # rest\n4 5\n\n6"), '#');
  TextReader& in = reader.value();
  in.Number("a");
  EXPECT_FALSE(in.AtEndOfLine());
  EXPECT_EQ(in.Number("b"), 2.0);
  EXPECT_TRUE(in.AtEndOfLine());
  EXPECT_EQ(in.line(), 1);
  EXPECT_EQ(in.Number("c"), 3.0);
  EXPECT_TRUE(in.AtEndOfLine());
  EXPECT_EQ(in.Number("d"), 4.0);
  EXPECT_EQ(in.Peek(), "5");
  EXPECT_FALSE(in.AtEndOfLine());
  EXPECT_EQ(in.Integer(0, 9, "e"), 5);
  EXPECT_EQ(in.line(), 3);
  EXPECT_TRUE(in.AtEndOfLine());
  EXPECT_EQ(in.Word("f"), "6");
  EXPECT_EQ(in.line(), 5);
  EXPECT_TRUE(in.AtEndOfLine());
  EXPECT_TRUE(in.ok());
}

TEST(TextReader, AnIntegerOutOfRangeIsStillThere) {
  TempFiles files;
  auto reader = TextReader::Open(files.Write("a", "1\n17 3\n"));
  TextReader& in = reader.value();
  in.Number("a");
  EXPECT_EQ(in.Integer(0, 9, "digit"), 0);
  EXPECT_EQ(Message(in), "2: expected digit (0 to 9), found '17'");
}

TEST(TextReader, WordsAcrossBuffersInEveryCompression) {
  TempFiles files;
  std::string content;
  for (int k = 0; k < 100000; ++k)
    content += std::to_string(k * 1000003LL) + (k % 7 == 0 ? "\n" : "   ");
  for (const std::string& path :
       {files.Write("plain", content), files.WriteCompressed("a.gz", content),
        files.WriteCompressed("a.bz2", content)}) {
    auto reader = TextReader::Open(path);
    TextReader& in = reader.value();
    for (int k = 0; k < 100000; ++k)
      ASSERT_EQ(in.Integer(0, 1LL << 60, "k", k), k * 1000003LL) << in.status().message();
    EXPECT_TRUE(in.AtEnd() && in.ok()) << in.status().message();
    EXPECT_EQ(in.line(), 100000 / 7 + 2);
  }
}

TEST(TextReader, CompressedStreamsBehindEachOther) {
  TempFiles files;
  for (const char* suffix : {".gz", ".bz2"}) {
    ASSERT_FALSE(files.WriteCompressed(std::string("a") + suffix, "1 2").empty());
    ASSERT_FALSE(files.WriteCompressed(std::string("b") + suffix, "3\n4").empty());
  }
  for (const std::string& content :
       {files.Read("a.gz") + files.Read("b.gz"), files.Read("a.bz2") + files.Read("b.bz2")}) {
    auto reader = TextReader::Open(files.Write("both", content));
    TextReader& in = reader.value();
    EXPECT_EQ(in.Number("x"), 1.0);
    EXPECT_EQ(in.Number("x"), 23.0);
    EXPECT_EQ(in.Number("x"), 4.0);
    EXPECT_TRUE(in.AtEnd() && in.ok());
  }
}

TEST(TextReader, DamagedAndCutCompression) {
  TempFiles files;
  std::string content;
  for (int k = 0; k < 30000; ++k)
    content += std::to_string(k * 7919 % 100003) + "\n";
  const auto read_all = [&](const std::string& bytes) {
    auto reader = TextReader::Open(files.Write("x", bytes));
    if (!reader.ok()) return reader.status();
    while (!reader.value().AtEnd())
      reader.value().Word("w");
    return reader.value().status();
  };
  for (const char* name : {"good.gz", "good.bz2"}) {
    ASSERT_FALSE(files.WriteCompressed(name, content).empty());
    const std::string good = files.Read(name);
    EXPECT_TRUE(read_all(good).ok());
    for (std::size_t size : {std::size_t{5}, std::size_t{20}, good.size() / 2, good.size() - 1}) {
      const Status status = read_all(good.substr(0, size));
      EXPECT_EQ(status.code(), StatusCode::kIoError) << size;
      EXPECT_NE(status.message().find("cut short"), std::string::npos) << status.message();
    }
    std::string damaged = good;
    damaged[good.size() / 2] = static_cast<char>(damaged[good.size() / 2] ^ 0x55);
    EXPECT_EQ(read_all(damaged).code(), StatusCode::kIoError);
    const Status trailing = read_all(good + "trailing");
    EXPECT_EQ(trailing.code(), StatusCode::kIoError);
    EXPECT_NE(trailing.message().find("do not belong"), std::string::npos) << trailing.message();
  }
}

TEST(TextReader, MissingFilesFoldersAndBinaries) {
  TempFiles files;
  auto missing = TextReader::Open(files.Path("none"));
  EXPECT_EQ(missing.status().code(), StatusCode::kIoError);
  EXPECT_EQ(missing.status().message(),
            files.Path("none") + ": cannot be opened: No such file or directory");
  auto folder = TextReader::Open(files.Path("."));
  EXPECT_EQ(folder.status().code(), StatusCode::kIoError);

  auto binary = TextReader::Open(files.Write("binary", std::string("\x01\x02\xff\0\n", 5)));
  binary.value().Number("n");
  EXPECT_EQ(Message(binary.value()),
            "1: expected n (a number), found '" + std::string(4, '?') + "'");
  auto endless = TextReader::Open(files.Write("endless", std::string(1 << 20, 'a')));
  endless.value().Word("w");
  EXPECT_NE(Message(endless.value()).find("not a text file"), std::string::npos);
  auto empty = TextReader::Open(files.Write("empty", ""));
  EXPECT_TRUE(empty.value().AtEnd());
}

}  // namespace
}  // namespace glissade::internal
