// The semantic visit to every tile: blended rows, loss, row gradients and coupling in one kernel, as matrix products on
// tensor cores. With W the weights of a block of 8 x 8 pixels and S the rows of its Gaussians,
//   P = W S,  dP and the coupling direction H from the loss at each pixel,  dS = W^T dP,  Q = S H^T - h_0,
// in bfloat16 with float32 sums; P never leaves shared memory. The loss is formed in float32.
//
// The coupling reaches alpha by a sweep from the back, dL/dalpha_k = T_k (q_k - B_k) with B_k the blend of the same
// rounded q behind k. Nothing cancels behind an opaque surface, whatever the rounding of q.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/semantic_rows.h"
#include "engine/cuda/teacher_maps.h"
#include "engine/cuda/view_spans.h"

namespace aligngs::cuda {

/// How much of a tile is visited at once. The sums are the same in another order.
enum class SemanticVisitMethod {
  kAutomatic,  ///< what semantic_visit_method says of the device
  kCompacted,  ///< blocks of 8 x 8 pixels, each with the Gaussians that it took: half of W is not zero
  kDense       ///< all 16 x 16: a fifth of W is not zero, but a row of a Gaussian is read once, and dS written once
};

/// Moments of g = dL_geo/dpower of one Gaussian in one tile, in whitened coordinates.
struct alignas(16) CouplingMoments {
  float p, r, one, pp, pr, rr, unused[2];
};

struct SemanticVisitInputs {
  ViewSpans view;
  TileListSpans lists;
  BlendRecordSpans record;
  TeacherSpans teacher;
  DeviceSpan<const uint16_t> rows;  ///< of semantic_rows
  RasterSettings raster;
  SemanticBlend blend{};
  SemanticCoupling coupling{};
  bool couple = false;                     ///< the coupling is wanted
  float soft_weight = 0, hard_weight = 0;  ///< LossSettings
  int remainder = 0;                       ///< as in SemanticRowInputs
  SemanticSample sample;                   ///< pixels that take part
  SemanticVisitMethod method = SemanticVisitMethod::kAutomatic;

  /// The weight of one of them in a mean over the valid pixels.
  ALIGNGS_HD float pixel_weight() const { return sample.scale() / static_cast<float>(teacher.valid); }
};

enum SemanticTerm : int { kSoftTerm, kHardTerm, kSemanticTerms };

struct SemanticVisitOutputs {
  DeviceSpan<float> row_slots;           ///< [instances][padded] dL/drows of one Gaussian in one tile, where seen
  DeviceSpan<CouplingMoments> coupling;  ///< [instances], where seen; may be empty without couple
  DeviceSpan<uint8_t> seen;              ///< [instances, by slot] 1: taken in a block with a teacher, else 0
  DeviceSpan<double> tile_terms;         ///< [tiles][SemanticTerm] scratch
  DeviceSpan<double> terms;              ///< [SemanticTerm] means over the valid pixels, unweighted
};

/// Properties of a device that decide the choice.
struct VisitDevice {
  int compute_major = 0, compute_minor = 0;
  size_t shared_bytes = 0;  ///< that a block may ask for
};
/// `wanted`; kAutomatic is kDense on devices with HBM (compute capability 8.0, 9.0, 10.x), whose tensor cores outrun
/// their memory many times. On others it is kCompacted. kCompacted if kDense does not fit.
SemanticVisitMethod semantic_visit_method(SemanticVisitMethod wanted, const VisitDevice& device, int channels);

/// Throws Error{kResources}, with a remedy, when a visit cannot hold this many channels. The limit is
/// kMaxSemanticChannels or the device's shared memory (224 channels if a block has 99 KB, as on GeForce).
void check_semantic_channels(const DeviceContext& context, int channels);

/// Fills `out`. The channels must have passed check_semantic_channels. Nothing waits for the host.
void semantic_visit(const DeviceContext& context, const SemanticVisitInputs& in, const SemanticVisitOutputs& out);

}  // namespace aligngs::cuda
