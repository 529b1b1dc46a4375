// A frame of a capture as a view of a scene has it: an undistorted photo, its mask and its depth.
#pragma once

#include <cstdint>

#include "core/image.h"
#include "scene/import/capture.h"
#include "scene/import/import_capture.h"
#include "scene/scene_writer.h"

namespace aligngs {

/// One frame brought to a pinhole camera.
struct PreparedFrame {
  SceneViewParts parts;
  Image<uint8_t> pixels;  ///< of the view, also where its file is copied
  ImageF depth;           ///< sensor depth, scene units, may be smaller than the image
};

/// Reads a frame's files. Error{kBadInput} for a file that cannot be read, for depth of another shape than the photo,
/// and for depth without a value.
PreparedFrame prepare_frame(const Capture& capture, const CapturedFrame& frame, const ImportOptions& options);

}  // namespace aligngs
