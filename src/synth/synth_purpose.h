// The random streams of a synthetic scene: each purpose has one of its own, so that a draw more in one place moves no
// other. The numbers are part of the result of a seed and never change.
#pragma once

#include <cstdint>

#include "core/random.h"

namespace aligngs {

/// Streams of the seed. The number of the room's kind is added to the last two.
enum class SynthPurpose : uint64_t {
  kPriorCloud = 1,     ///< the cloud beside simulated priors of an existing scene
  kTrajectory = 41,    ///< where the pictures are taken
  kPictures = 500,     ///< how it lies in the world, and its pictures
  kTeacherBase = 600,  ///< its teachers, by their own seed where there is one
};

/// Streams of SynthPurpose::kPictures.
enum class PicturePurpose : uint64_t { kWorldFrame = 1, kPhoto = 2, kExposure = 3 };

/// Streams of SynthPurpose::kTeacherBase.
enum class TeacherPurpose : uint64_t {
  kGeometry = 1,  ///< or a depth sensor
  kClasses = 2,   ///< and the segments of the same objects
  kMonoDepth = 3,
  kSparseCloud = 4,
  kLabelControl = 5
};

/// Streams of TeacherPurpose::kClasses. Segments are those of the objects that its teacher confuses.
enum class ClassPurpose : uint64_t { kConfusions = 1, kSegments = 2 };

/// Streams of a room's own seed.
enum class FurnishingPurpose : uint64_t { kStyle = 1, kPlan = 2, kMeshes = 3 };

template <class Purpose>
Random stream_of(const Random& base, Purpose purpose, uint64_t kind = 0) {
  return base.fork(static_cast<uint64_t>(purpose) + kind);
}

}  // namespace aligngs
