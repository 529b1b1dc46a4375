// Whether the inputs of a room are those of its last attempt: its options, its source, and files that the options name.
#pragma once

#include <filesystem>
#include <string>

#include "batch/batch_folder.h"

namespace aligngs {

struct InputDigest {
  std::string content;  ///< SHA-256 of options, names and contents, hexadecimal
  /// SHA-256 of options, names, sizes and times of change: equal means that the contents are equal, too
  std::string quick;

  bool operator==(const InputDigest&) const = default;
};

/// Reads every file of the source. A source that is missing has a digest, too, which changes when it appears.
InputDigest digest_inputs(const Batch& batch, const RoomEntry& room);

/// `known` where the quick digest is still its own, else digest_inputs: files that did not change are not read again.
InputDigest digest_inputs(const Batch& batch, const RoomEntry& room, const InputDigest& known);

}  // namespace aligngs
