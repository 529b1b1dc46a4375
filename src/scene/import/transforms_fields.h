// The fields of transforms.json: nerfstudio's, instant-ngp's and Blender's, each used, ignored because it is harmless
// here, or refused by name. docs/formats.md lists them. src/scene/import internal.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/colmap.h"

namespace aligngs {

/// Values of one frame: its own, else those of the whole file.
class TransformsFields {
 public:
  TransformsFields(const nlohmann::json& document, const nlohmann::json& frame, const std::filesystem::path& file)
      : document_(document), frame_(frame), file_(file) {}

  /// Error{kBadInput} for anything that is no finite number.
  double number(const char* key, double fallback) const;
  bool flag(const char* key) const;
  std::string text(const char* key) const;  ///< empty: absent
  const nlohmann::json* find(const char* key) const;
  /// fx, fy, cx, cy of a matrix of intrinsics under one of its names; nothing where there is none. Error{kBadInput}
  /// naming the field for another matrix.
  std::optional<std::array<double, 4>> intrinsics() const;

  /// The camera at the size that the file states, else at width x height of the photo as stored. Error{kBadInput}
  /// naming the field for lenses that are no view of a pinhole, for terms without a counterpart here, and without any
  /// focal length.
  ColmapCamera camera(int width, int height) const;

  /// Fields that state the focal length once more and otherwise; `camera()` takes the pixels. One line each.
  std::vector<std::string> contradictions(int width, int height) const;

  /// Error{kBadInput} for fields whose meaning is not supported, by name.
  void refuse_unsupported() const;

 private:
  const nlohmann::json& document_;
  const nlohmann::json& frame_;
  const std::filesystem::path& file_;
};

/// The keys of an object that are not known and look like parameters (numbers, switches, lists of them, words).
std::vector<std::string> unknown_fields(const nlohmann::json& object);

}  // namespace aligngs
