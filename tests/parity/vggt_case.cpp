#include "nn/vggt.h"
#include "parity_case.h"

namespace aligngs::parity {

void run_vggt(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  nn::VggtOptions options;
  options.heads = config.at("heads").get<int64_t>();
  options.camera_heads = config.at("cam_heads").get<int64_t>();
  options.layers = config.at("layer_idx").get<std::vector<int>>();
  const nn::Vggt vggt(compute, test.weights("weights.safetensors"), options);

  FloatArray input = test.array("in_images");  // [1, frames, 3, height, width]
  input.shape.erase(input.shape.begin());
  const std::vector<nn::FeatureMap> images = maps_of(input);
  const int64_t frames = int64_t(images.size());
  const int64_t height = images[0].height, width = images[0].width;

  std::vector<int> all;
  for (int i = 0; i < int(vggt.aggregator().depth()); ++i) all.push_back(i);
  nn::AggregatedTokens tokens = vggt.aggregator()(compute, images, all, true);
  const int64_t c = vggt.aggregator().channels();
  test.compare("out_patch_tokens", tokens.patch_tokens.data, {frames, tokens.grid_height * tokens.grid_width, c});
  for (const int i : all) {
    test.compare("out_agg_" + std::to_string(i), tokens.layers[size_t(i)].data, {1, frames, tokens.per_frame(), 2 * c});
  }

  const auto iterations = vggt.camera_head()(vggt.exact(), nn::Vggt::camera_tokens(tokens));
  std::vector<float> extrinsics, intrinsics;
  nn::VggtCamera last;
  for (size_t i = 0; i < iterations.size(); ++i) {
    std::vector<float> encodings;
    for (const nn::PoseEncoding& e : iterations[i]) encodings.insert(encodings.end(), e.begin(), e.end());
    test.compare("out_pose_enc_iter" + std::to_string(i), encodings, {1, frames, 9});
  }
  for (const nn::PoseEncoding& e : iterations.back()) {
    last = nn::decode_pose(e, width, height);
    for (size_t r = 0; r < 3; ++r) {
      for (size_t k = 0; k < 3; ++k) extrinsics.push_back(float(last.rotation[3 * r + k]));
      extrinsics.push_back(float(last.translation[r]));
    }
    for (const double v : {last.fx, 0.0, last.cx, 0.0, last.fy, last.cy, 0.0, 0.0, 1.0}) intrinsics.push_back(float(v));
  }
  test.compare("out_extrinsic", extrinsics, {1, frames, 3, 4});
  test.compare("out_intrinsic", intrinsics, {1, frames, 3, 3});

  nn::AggregatedTokens chosen = tokens;
  chosen.layers.clear();
  for (const int layer : vggt.layers()) chosen.layers.push_back(tokens.layers[size_t(layer)]);
  nn::FeatureMap last_depth;
  for (const bool points : {false, true}) {
    std::vector<float> values, confidence;
    for (int64_t f = 0; f < frames; ++f) {
      nn::FeatureMap map = (points ? vggt.point_head() : vggt.depth_head())(compute, chosen, f);
      for (int64_t p = 0; p < map.places(); ++p) {
        const float* v = map.data.data() + p * map.channels;
        values.insert(values.end(), v, v + map.channels - 1);
        confidence.push_back(v[map.channels - 1]);
      }
      if (!points) last_depth = std::move(map);
    }
    const int64_t channels = points ? 3 : 1;
    test.compare(points ? "out_world_points" : "out_depth", values, {1, frames, height, width, channels});
    test.compare(points ? "out_world_points_conf" : "out_depth_conf", confidence, {1, frames, height, width});
  }
  const nn::FeatureMap cloud = nn::unproject_depth(last_depth, last);
  test.compare("out_points_from_depth", cloud.data, {1, height, width, 3});

  // The whole network in one call gives the same as its parts.
  if (test.mode().options.precision == nn::Precision::kFloat32) {
    vggt(compute, images, {true, false}, [&](int64_t frame, nn::VggtFrame result) {
      if (frame == frames - 1) test.judge("whole", result.depth.data, last_depth.data, 0);
    });
  }
}

}  // namespace aligngs::parity
