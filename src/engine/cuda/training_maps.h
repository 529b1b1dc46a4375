// The pixels and priors of a training view on the device, without loss and as small as that allows. The teacher's
// probabilities are in teacher_maps.h.
#pragma once

#include <cstdint>

#include "device/device_memory.h"
#include "engine/formulas/pixel_rays.h"
#include "engine/training_view.h"

namespace aligngs::cuda {

/// Properties of a pixel that follow from the view alone, one byte each. Pairs are those of formulas/label_edges.h: the
/// pixel and its right or lower neighbour, whose labels are known and differ.
enum PixelFlag : uint8_t {
  kPixelCounts = 1,     ///< the mask keeps it
  kPixelLabelEdge = 2,  ///< TrainingView::label_edge
  kPixelRightPair = 4,
  kPixelLowerPair = 8,
  kPixelRightCrease = 16,  ///< what the prior says about the right pair (EdgeKind); at most one of the two
  kPixelRightCoplanar = 32,
  kPixelLowerCrease = 64,
  kPixelLowerCoplanar = 128
};

struct TrainingMapSpans {
  int width = 0, height = 0;
  PixelRays<float> rays;
  uint32_t counted = 0;                   ///< pixels that the mask keeps
  DeviceSpan<const uint8_t> color_bytes;  ///< [3][H W] of 255; empty: color holds the photo
  DeviceSpan<const float> color;          ///< [3][H W]; only where some value is not a multiple of 1 / 255
  DeviceSpan<const uint8_t> flags;        ///< [H W] PixelFlag
  bool labels = false;                    ///< it has labels, which the flags speak of
  DeviceSpan<const float> prior_depth;    ///< [H W], 0 = none; empty without a prior
  DeviceSpan<const float> depth_weight;   ///< [H W] in [0, 1]; empty: 1
  DeviceSpan<const float> prior_normal;   ///< [3][H W], zero = none; empty without

  ALIGNGS_HD GivenInputs given() const { return {!prior_depth.empty(), !prior_normal.empty(), labels}; }
};

/// Owns them. The arrays do not change between steps.
class TrainingMaps {
 public:
  TrainingMaps() = default;
  /// Throws Error{kFailed} when a map of the view does not have the size of its camera.
  TrainingMaps(DeviceContext& context, const TrainingView& view);
  TrainingMapSpans spans() const;
  /// Bytes that the view will take.
  static uint64_t bytes(const TrainingView& view);

 private:
  TrainingMapSpans shape_;
  DeviceArray<uint8_t> color_bytes_, flags_;
  DeviceArray<float> color_, prior_depth_, depth_weight_, prior_normal_;
};

}  // namespace aligngs::cuda
