// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/text_writer.h"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace glissade::internal {

namespace {

constexpr std::size_t kFlushSize = std::size_t{1} << 16;

class PlainSink final : public ByteSink {
 public:
  explicit PlainSink(std::FILE* file) : file_(file) {}
  ~PlainSink() override { PlainSink::Close(); }
  bool Write(const char* data, std::size_t size) override {
    return std::fwrite(data, 1, size, file_) == size;
  }
  bool Close() override {
    std::FILE* file = std::exchange(file_, nullptr);
    return file == nullptr || std::fclose(file) == 0;
  }

 private:
  std::FILE* file_;
};

class GzipSink final : public ByteSink {
 public:
  explicit GzipSink(gzFile file) : file_(file) {}
  ~GzipSink() override { GzipSink::Close(); }
  bool Write(const char* data, std::size_t size) override {
    return gzwrite(file_, data, static_cast<unsigned>(size)) == static_cast<int>(size);
  }
  bool Close() override {
    gzFile file = std::exchange(file_, nullptr);
    return file == nullptr || gzclose(file) == Z_OK;
  }

 private:
  gzFile file_;
};

class Bzip2Sink final : public ByteSink {
 public:
  explicit Bzip2Sink(std::FILE* file) : file_(file) {
    int error = BZ_OK;
    stream_ = BZ2_bzWriteOpen(&error, file_, 9, 0, 0);
  }
  ~Bzip2Sink() override { Bzip2Sink::Close(); }
  bool Write(const char* data, std::size_t size) override {
    int error = BZ_OK;
    // The library takes a pointer to what it only reads.
    BZ2_bzWrite(&error, stream_, const_cast<char*>(data), static_cast<int>(size));
    return error == BZ_OK;
  }
  bool Close() override {
    bool good = true;
    if (BZFILE* stream = std::exchange(stream_, nullptr)) {
      int error = BZ_OK;
      BZ2_bzWriteClose(&error, stream, 0, nullptr, nullptr);
      good = error == BZ_OK;
    }
    if (std::FILE* file = std::exchange(file_, nullptr)) good = std::fclose(file) == 0 && good;
    return good;
  }

 private:
  std::FILE* file_;
  BZFILE* stream_;
};

std::unique_ptr<ByteSink> OpenSink(const std::string& path, std::string_view name) {
  if (name.ends_with(".gz")) {
    gzFile file = gzopen(path.c_str(), "wb6");
    if (file == nullptr) return nullptr;
    return std::make_unique<GzipSink>(file);
  }
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return nullptr;
  if (name.ends_with(".bz2")) return std::make_unique<Bzip2Sink>(file);
  return std::make_unique<PlainSink>(file);
}

}  // namespace

Result<TextWriter> TextWriter::Create(const std::string& path) {
  namespace fs = std::filesystem;
  TextWriter writer;
  std::error_code error;
  // A link stays a link: what it points to is replaced. A device is not replaced by a file.
  const fs::path target = fs::exists(path, error) ? fs::canonical(path, error) : fs::path(path);
  writer.path_ = error ? path : target.string();
  const bool device = fs::exists(writer.path_, error) &&
                      !fs::is_regular_file(writer.path_, error) &&
                      !fs::is_directory(writer.path_, error);
  if (!device) writer.temporary_ = writer.path_ + ".part";
  errno = 0;
  if (fs::is_directory(writer.path_, error)) {
    errno = EISDIR;
  } else {
    writer.sink_ = OpenSink(device ? writer.path_ : writer.temporary_, path);
  }
  if (writer.sink_ == nullptr) {
    writer.temporary_.clear();
    return Status(StatusCode::kIoError,
                  path + ": cannot be written: " + std::strerror(errno != 0 ? errno : EIO));
  }
  return writer;
}

TextWriter::~TextWriter() {
  if (sink_ == nullptr) return;
  sink_->Close();
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

TextWriter& TextWriter::Word(std::string_view word) {
  if (in_line_) buffer_ += ' ';
  buffer_ += word;
  in_line_ = true;
  return *this;
}

TextWriter& TextWriter::Number(double x) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof(text), x);
  static_cast<void>(error);  // at most 17 digits, sign, point and exponent are 24 characters
  return Word(std::string_view(text, static_cast<std::size_t>(end - text)));
}

TextWriter& TextWriter::Numbers(const double* x, int n) {
  for (int i = 0; i < n; ++i)
    Number(x[i]);
  return *this;
}

TextWriter& TextWriter::Integer(std::int64_t x) {
  char text[24];
  const auto [end, error] = std::to_chars(text, text + sizeof(text), x);
  static_cast<void>(error);  // 19 digits and a sign
  return Word(std::string_view(text, static_cast<std::size_t>(end - text)));
}

void TextWriter::EndLine() {
  buffer_ += '\n';
  in_line_ = false;
  if (buffer_.size() >= kFlushSize) Flush();
}

void TextWriter::Line(std::string_view text) {
  buffer_ += text;
  EndLine();
}

void TextWriter::Bytes(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const std::size_t n = std::min(size, kFlushSize);
    buffer_.append(bytes, n);
    if (buffer_.size() >= kFlushSize) Flush();
    bytes += n;
    size -= n;
  }
}

/// Notes the first failure, and why.
void TextWriter::Check(bool good) {
  if (good || failed_) return;
  failed_ = true;
  why_ = errno != 0 ? errno : EIO;
}

void TextWriter::Flush() {
  errno = 0;
  if (!failed_ && !buffer_.empty()) Check(sink_->Write(buffer_.data(), buffer_.size()));
  buffer_.clear();
}

Status TextWriter::Close() {
  Flush();
  errno = 0;
  Check(sink_->Close());
  sink_.reset();
  if (!failed_ && !temporary_.empty()) {
    std::error_code error;
    std::filesystem::rename(temporary_, path_, error);
    errno = error.value();
    Check(!error);
  }
  if (!failed_) return {};
  if (!temporary_.empty()) std::remove(temporary_.c_str());
  return {StatusCode::kIoError, path_ + ": cannot be written: " + std::strerror(why_)};
}

}  // namespace glissade::internal
