// Depth Anything 3, any-view (Lin et al. 2025): cameras, depth and rays of all photographs of a scene in one pass.
// Known cameras are an optional input. The shapes of the tensors distinguish Small, Base, Large and Giant.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "nn/da3/camera_branch.h"
#include "nn/da3/heads.h"
#include "nn/da3/trunk.h"

namespace aligngs::nn {

/// Settings that the weights do not hold; the defaults are those of the published networks.
struct Da3Options {
  Da3TrunkOptions trunk;      ///< `joined` is read from the head
  int64_t camera_heads = 16;  ///< of the blocks that read given cameras
};

struct Da3Request {
  /// World to camera, in pixels of the network's input, one per image; empty: the network finds them alone. They need
  /// not be normalised.
  std::vector<NetworkCamera> cameras;
  Da3ReferenceRule rule = Da3ReferenceRule::kSaddleBalanced;
  std::optional<int64_t> reference;  ///< an image that is the reference whatever the rule
  bool depth = true;                 ///< false: cameras alone
  bool rays = false;
};

struct Da3Frame {
  NetworkCamera camera;  ///< as predicted, also where cameras were given; see da3_camera_is_plausible()
  FeatureMap depth;      ///< [H, W, 2]: depth along the axis in units of the translations, confidence >= 1
  FeatureMap rays;       ///< [8 h, 8 w, 7]: see Da3DualHead; only where asked for
};

class Da3 {
 public:
  /// Names as published ("model.*"); a nested file's any-view part ("model.da3.*") as well. Error{kWeights} when
  /// tensors are missing or do not fit.
  Da3(Compute& compute, const Weights& weights, const Da3Options& options = {});

  /// Normalised images of one size, sides multiples of 14 (preprocess/da3_images.h). Each frame is handed to `take`
  /// as soon as it is done, in order: dense maps of all frames never exist together. Error{kWeights} when something
  /// is asked for whose tensors the file lacks.
  void operator()(Compute& compute, const std::vector<FeatureMap>& images, const Da3Request& request,
                  const std::function<void(int64_t, Da3Frame)>& take) const;

  const Da3Trunk& trunk() const { return *trunk_; }
  const Da3CameraDecoder& camera_decoder() const { return *camera_decoder_; }
  const Da3DualHead& head() const { return *head_; }
  /// The camera branch works in float32 whatever the precision, on the host.
  Compute& exact() const { return *exact_; }
  /// Tokens [views, channels] of given cameras.
  Matrix camera_tokens(const std::vector<NetworkCamera>& cameras, int64_t width, int64_t height) const;

 private:
  std::unique_ptr<Compute> exact_;
  std::optional<Da3CameraEncoder> camera_encoder_;
  std::optional<Da3CameraDecoder> camera_decoder_;
  std::optional<Da3DualHead> head_;
  std::optional<Da3Trunk> trunk_;
};

/// The part of a file that a class of DA3 reads: below "model.da3." or "model.da3_metric." of a nested file (`part`:
/// "da3" or "da3_metric"), else below "model.". Error{kWeights} when neither is there.
Weights da3_part(const Weights& weights, const std::string& part);

}  // namespace aligngs::nn
