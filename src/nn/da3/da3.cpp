#include "nn/da3/da3.h"

#include "core/error.h"
#include "nn/preprocess/da3_images.h"

namespace aligngs::nn {
namespace {

constexpr int64_t kPatch = kDa3Patch;

}  // namespace

Weights da3_part(const Weights& weights, const std::string& part) {
  const std::string probe = "backbone.pretrained.cls_token";
  for (const std::string& prefix : {"model." + part + ".", std::string("model."), std::string()}) {
    if (weights.has(prefix + probe)) return weights.sub(prefix);
  }
  weights.shape("model." + probe);  // throws: missing
  return weights;
}

Da3::Da3(Compute& compute, const Weights& file, const Da3Options& options) {
  exact_ = std::make_unique<Compute>(compute.pool());
  const Weights weights = da3_part(file, "da3");
  const Weights backbone = weights.sub("backbone.pretrained.");
  head_.emplace(compute, weights.sub("head."));
  Da3TrunkOptions trunk = options.trunk;
  const int64_t channels = backbone.dimension("patch_embed.proj.weight", 0);
  trunk.joined = head_->inputs() == 2 * channels;
  if (!trunk.joined && head_->inputs() != channels) {
    throw Error({ErrorKind::kWeights,
                 "the head reads tokens of " + std::to_string(head_->inputs()) + " values, the trunk has " +
                     std::to_string(channels) + " channels",
                 {},
                 "head.projects.0.weight",
                 "these are not the weights of this network"});
  }
  trunk_.emplace(compute, backbone, trunk);
  camera_decoder_.emplace(*exact_, weights.sub("cam_dec."), trunk_->width());
  if (weights.has("cam_enc.token_norm.weight"))
    camera_encoder_.emplace(*exact_, weights.sub("cam_enc."), options.camera_heads);
}

Matrix Da3::camera_tokens(const std::vector<NetworkCamera>& cameras, int64_t width, int64_t height) const {
  if (!camera_encoder_) {
    throw Error({ErrorKind::kWeights,
                 "the tensors that read given cameras are missing",
                 {},
                 "cam_enc",
                 "use the complete file of weights, or give no cameras"});
  }
  for (size_t i = 0; i < cameras.size(); ++i) {
    if (da3_camera_is_plausible(cameras[i], width, height)) continue;
    throw_bad_input({}, "camera " + std::to_string(i),
                    "its pose is not finite or its field of view is none that a photo has",
                    "give focal lengths in pixels of the prepared image");
  }
  std::vector<PoseEncoding> encodings;
  for (const NetworkCamera& camera : normalised_cameras(cameras))
    encodings.push_back(encode_da3_camera(camera, width, height));
  return (*camera_encoder_)(*exact_, encodings);
}

void Da3::operator()(Compute& compute, const std::vector<FeatureMap>& images, const Da3Request& request,
                     const std::function<void(int64_t, Da3Frame)>& take) const {
  if (request.rays && !head_->has_rays()) {
    throw Error({ErrorKind::kWeights,
                 "the tensors of the ray branch are missing",
                 {},
                 "head.scratch.output_conv2_aux",
                 "use the complete file of weights"});
  }
  Da3TrunkRequest pass;
  pass.rule = request.rule;
  pass.reference = request.reference;
  if (!request.cameras.empty() && !images.empty())
    pass.camera_tokens = camera_tokens(request.cameras, images[0].width, images[0].height);
  const Da3Tokens tokens = (*trunk_)(compute, images, pass);
  const int64_t width = tokens.grid_width * kPatch, height = tokens.grid_height * kPatch;
  const std::vector<PoseEncoding> encodings = (*camera_decoder_)(*exact_, tokens.camera);
  for (int64_t v = 0; v < tokens.views; ++v) {
    Da3Frame frame;
    frame.camera = decode_da3_camera(encodings[size_t(v)], width, height);
    if (request.depth || request.rays) {
      Da3DualHead::Output dense = (*head_)(compute, tokens.maps_of(compute, v), height, width, request.rays);
      frame.depth = std::move(dense.depth);
      frame.rays = std::move(dense.rays);
    }
    take(v, std::move(frame));
  }
}

}  // namespace aligngs::nn
