// A view's semantic teacher on the device, in compact form. It has float16 probabilities of the channels at the
// teacher's own resolution, and ten bytes per image pixel. engine/shared/active_classes.h gives the error against the full
// maps.
#pragma once

#include <cstdint>

#include "device/device_memory.h"
#include "engine/formulas/teacher_sampling.h"
#include "engine/shared/semantic_view.h"

namespace aligngs::cuda {

struct TeacherSpans {
  int width = 0, height = 0;  ///< of the teacher's map
  int channels = 0;
  int stride = 0;                            ///< numbers per pixel of the map, a multiple of 8
  DeviceSpan<const uint16_t> probabilities;  ///< [height][width][stride] float16, zero beyond the channels
  DeviceSpan<const float> confidence;        ///< [height][width]; empty: 1
  /// [height][width], of the probabilities (SemanticTarget::scale); empty: 1
  DeviceSpan<const float> scale;
  DeviceSpan<const float> negative_entropy;  ///< [H W] of the image: sum t log t
  DeviceSpan<const uint16_t> top_class;      ///< [H W] arg-max of t, kNoLabel where the pixel is not valid
  DeviceSpan<const float> weight;            ///< [H W] omega of the bounded coupling; empty: 1
  uint32_t valid = 0;                        ///< pixels that take part in the semantic loss

  ALIGNGS_HD TeacherGrid grid() const {
    return {width, height, confidence.empty() ? nullptr : confidence.data, scale.empty() ? nullptr : scale.data};
  }
};

/// Owns them. The arrays do not change between steps.
class TeacherMaps {
 public:
  TeacherMaps() = default;
  /// `view` must have semantics; `cache` is prepare_semantic_view's of the same view.
  TeacherMaps(DeviceContext& context, const TrainingView& view, const SemanticView& cache);
  TeacherSpans spans() const;
  /// Bytes of a view with these sizes.
  static uint64_t bytes(int channels, size_t teacher_pixels, size_t image_pixels);

 private:
  TeacherSpans shape_;
  DeviceArray<uint16_t> probabilities_, top_class_;
  DeviceArray<float> confidence_, scale_, negative_entropy_, weight_;
};

}  // namespace aligngs::cuda
