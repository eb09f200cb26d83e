// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "glissade/io/colmap.h"

namespace glissade::internal {

/// Names of the files, without ending.
inline constexpr const char* kColmapFiles[3] = {"cameras", "images", "points3D"};

/// The ids that mean "none" in a file.
inline constexpr std::uint32_t kNoColmapId = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::int64_t kMostColmapPoint = std::numeric_limits<std::int64_t>::max();

/// Checks a model, also while it is being put together: all cameras, then images, then points, each
/// once and in order. What is wrong is said in words; an empty text: nothing.
class ColmapCheck {
 public:
  explicit ColmapCheck(const ColmapModel& model) : model_(model) {}

  std::string Camera(std::size_t k);
  std::string Image(std::size_t k);
  std::string Point(std::size_t k);
  /// The first image from *image on with a feature whose point does not have it in its track.
  std::string NextUnlinked(std::size_t* image) const;

 private:
  const ColmapModel& model_;
  std::unordered_set<std::uint32_t> cameras_;
  std::unordered_map<std::uint32_t, std::size_t> images_;  // index by id
  std::unordered_set<std::int64_t> points_;
  std::vector<std::vector<bool>> in_track_;  // of the features of each image
};

/// Opens the three files of a model, in the order of kColmapFiles, or fails with the first that
/// cannot be. open: from a name, without ending, to Result<File>.
template <class File, class Open>
Status OpenColmapFiles(std::vector<File>* files, Open&& open) {
  for (const char* name : kColmapFiles) {
    Result<File> file = open(name);
    if (!file.ok()) return file.status();
    files->push_back(std::move(file).value());
  }
  return {};
}

/// Closes files that were written, up to the first that cannot be.
template <class File>
Status CloseColmapFiles(std::vector<File>* files) {
  for (File& file : *files) {
    if (Status status = file.Close(); !status.ok()) return status;
  }
  return {};
}

/// Pieces of a message in a row.
std::string Joined(std::initializer_list<std::string_view> pieces);

Result<ColmapModel> ReadColmapText(const std::string& folder);
Result<ColmapModel> ReadColmapBinary(const std::string& folder);
Status WriteColmapText(const ColmapModel& model, const std::string& folder);
Status WriteColmapBinary(const ColmapModel& model, const std::string& folder);

}  // namespace glissade::internal
