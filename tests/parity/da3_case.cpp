// Depth Anything 3: the any-view networks, the metric one, and the two together.
#include <map>

#include "da3_cameras.h"
#include "nn/da3/metric.h"
#include "nn/da3/metric_scale.h"

namespace aligngs::parity {
namespace {

// Errors of the publisher's own program with a trunk in bfloat16, by the README of the data.
constexpr Case::Limits kTokens{8e-2, 6e-2}, kDepth{1e-1, 4.5e-2}, kEncoding{6e-2, 4e-2}, kCameras{1.3e-1, 1.3e-1};
constexpr std::nullopt_t kMeaningless = std::nullopt;  // in bfloat16
constexpr double kSafeMargin = 0.1;                    // between the reference view and the next, in bfloat16
constexpr double kScoreLimit = 1e-4;                   // scores are differences of nearly equal numbers

nn::Da3Options options_of(const Json& config) {
  nn::Da3Options options;
  options.trunk.heads = config.at("heads").get<int64_t>();
  options.trunk.layers = config.at("out_layers").get<std::vector<int>>();
  options.trunk.alternate_from = value_or(config, "alt_start", -1);
  options.trunk.rotate_from = value_or(config, "rope_start", -1);
  options.camera_heads = value_or<int64_t>(config, "cam_heads", 16);
  return options;
}

nn::Da3ReferenceRule rule_of(const Json& config) {
  const auto name = value_or<std::string>(config, "ref_view_strategy", "saddle_balanced");
  if (name == "saddle_balanced") return nn::Da3ReferenceRule::kSaddleBalanced;
  if (name == "first") return nn::Da3ReferenceRule::kFirst;
  if (name == "middle") return nn::Da3ReferenceRule::kMiddle;
  throw std::runtime_error("unknown ref_view_strategy " + name);
}

std::vector<nn::FeatureMap> images_of(Case& test) {
  FloatArray input = test.array("in_images");  // [1, views, 3, height, width]
  input.shape.erase(input.shape.begin());
  return maps_of(input);
}

/// Channels [first, first + count) of maps, one after the other.
std::vector<float> channels_of(const std::vector<nn::FeatureMap>& maps, int64_t first, int64_t count) {
  std::vector<float> out;
  for (const nn::FeatureMap& map : maps) {
    for (int64_t i = 0; i < map.places(); ++i) {
      const float* const v = map.data.data() + i * map.channels + first;
      out.insert(out.end(), v, v + count);
    }
  }
  return out;
}

/// Rows without the first of each of `views` groups.
std::vector<float> without_first(const nn::Matrix& x, int64_t views) {
  std::vector<float> out;
  const int64_t per_view = x.rows / views;
  for (int64_t v = 0; v < views; ++v)
    out.insert(out.end(), x.row(v * per_view + 1), x.row(v * per_view) + per_view * x.columns);
  return out;
}

bool contains(const Json& list, int value) {
  for (const Json& entry : list) {
    if (entry == value) return true;
  }
  return false;
}

void compare_trunk(Case& test, nn::Compute& compute, const nn::Da3& network, const std::vector<nn::FeatureMap>& images,
                   nn::Da3TrunkRequest pass, nn::Da3Tokens& tokens) {
  const Json& config = test.config();
  const auto views = int64_t(images.size());
  const Json exported = value_or(config, "export_layers", Json::array());
  const Json kept = value_or(config, "blocks", Json::array());
  pass.visit = [&](int block, const nn::Matrix& x) {
    const int64_t per_view = x.rows / views, c = x.columns;
    const std::string n = std::to_string(block);
    if (contains(kept, block)) test.compare("out_block_" + n, x.data, {1, views, per_view, c}, kTokens);
    if (!contains(exported, block)) return;
    test.compare("out_feat_layer_" + n, without_first(network.trunk().vit().normed(compute, x), views),
                 {1, views, images[0].height / 14, images[0].width / 14, c}, kTokens);
  };
  tokens = network.trunk()(compute, images, pass);
  if (test.has("out_ref_index.npy")) {
    const std::vector<float> index = {float(tokens.reference)};
    test.compare_exactly("out_ref_index", index, {1});
  }
  if (test.has("out_ref_scores.npy")) {
    const FloatArray expected = test.array("out_ref_scores");
    if (test.exact()) test.judge("out_ref_scores", tokens.reference_scores, expected.data, kScoreLimit);
  }
  for (size_t j = 0; j < tokens.layers.size(); ++j) {
    test.compare("out_feat_" + std::to_string(j), tokens.layers[j].data,
                 {1, views, tokens.patches(), tokens.layers[j].columns}, kTokens);
  }
  test.compare("out_cam_token", tokens.camera.data, {1, views, tokens.camera.columns}, kTokens);
}

void compare_given(Case& test, const nn::Da3& network, const std::vector<nn::NetworkCamera>& given, int64_t width,
                   int64_t height, nn::Da3TrunkRequest& pass) {
  const auto views = int64_t(given.size());
  compare_encoded(test, given, width, height, "out_pose_enc_in");
  pass.camera_tokens = network.camera_tokens(given, width, height);
  test.compare("out_pose_tokens", pass.camera_tokens.data, {1, views, pass.camera_tokens.columns});
}

void compare_ray_poses(Case& test, const std::vector<nn::FeatureMap>& rays, int64_t width, int64_t height) {
  const nn::RayDraws draws = draws_of(test.array("in_ransac_idx"));
  std::vector<nn::NetworkCamera> cameras;
  std::vector<float> homographies;
  for (const nn::FeatureMap& map : rays) {
    const nn::RayPose pose = nn::pose_from_rays(map, draws, width, height, {nn::RayDecomposition::kPublished});
    cameras.push_back(pose.camera);
    for (const double a : pose.homography) homographies.push_back(float(a));
  }
  const auto views = int64_t(rays.size());
  test.compare("out_homography", homographies, {1, views, 3, 3}, kMeaningless);
  test.compare("out_extrinsics_ray", extrinsics_of(cameras, 3), {1, views, 3, 4}, kMeaningless);
  test.compare("out_intrinsics_ray", intrinsics_of(cameras), {1, views, 3, 3}, kMeaningless);
}

void compare_final(Case& test, const std::vector<nn::NetworkCamera>& given,
                   const std::vector<nn::NetworkCamera>& predicted, std::vector<float> depth, const Shape& shape) {
  const nn::CameraAlignment fit = nn::align_given_cameras(given, predicted);
  for (float& d : depth) d = float(double(d) / fit.scale);
  test.compare("out_scale", {float(fit.scale)}, {1}, kCameras);
  test.compare("out_extrinsics_aligned", extrinsics_of(fit.cameras, 4), {int64_t(given.size()), 4, 4}, kCameras);
  test.compare("out_depth_final", depth, shape, kDepth);
}

}  // namespace

void run_da3(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  const nn::Da3 network(compute, test.weights("weights.safetensors"), options_of(config));
  const std::vector<nn::FeatureMap> images = images_of(test);
  const auto views = int64_t(images.size());
  const int64_t height = images[0].height, width = images[0].width;

  nn::Da3Request request;
  request.rule = rule_of(config);
  request.rays = true;
  // Rounding may choose another reference where two views are nearly equal; the case then goes on with the publisher's.
  if (!test.exact() && value_or(config, "ref_margin", 1.0) < kSafeMargin)
    request.reference = int64_t(test.array("out_ref_index").data.at(0));
  if (value_or(config, "poses", false))
    request.cameras = cameras_of(test.array("in_extrinsics"), test.array("in_intrinsics"));

  nn::Da3TrunkRequest pass;
  pass.rule = request.rule;
  pass.reference = request.reference;
  if (!request.cameras.empty()) compare_given(test, network, request.cameras, width, height, pass);
  nn::Da3Tokens tokens;
  compare_trunk(test, compute, network, images, pass, tokens);

  std::vector<float> encodings;
  std::vector<nn::NetworkCamera> cameras;
  for (const nn::PoseEncoding& e : network.camera_decoder()(network.exact(), tokens.camera)) {
    encodings.insert(encodings.end(), e.begin(), e.end());
    cameras.push_back(nn::decode_da3_camera(e, width, height));
  }
  test.compare("out_pose_enc", encodings, {1, views, 9}, kEncoding);
  test.compare("out_extrinsics", extrinsics_of(cameras, 3), {1, views, 3, 4}, kCameras);
  test.compare("out_intrinsics", intrinsics_of(cameras), {1, views, 3, 3}, kCameras);

  std::vector<nn::FeatureMap> depth, rays;
  for (int64_t v = 0; v < views; ++v) {
    nn::Da3DualHead::Output dense = network.head()(compute, tokens.maps_of(compute, v), height, width, true);
    depth.push_back(std::move(dense.depth));
    rays.push_back(std::move(dense.rays));
  }
  const int64_t rows = rays[0].height, columns = rays[0].width;
  test.compare("out_depth", channels_of(depth, 0, 1), {1, views, height, width}, kDepth);
  test.compare("out_depth_conf", channels_of(depth, 1, 1), {1, views, height, width}, kDepth);
  test.compare("out_ray", channels_of(rays, 0, 6), {1, views, rows, columns, 6}, kMeaningless);
  test.compare("out_ray_conf", channels_of(rays, 6, 1), {1, views, rows, columns}, kMeaningless);
  if (test.has("in_ransac_idx.npy")) {
    // Homographies of rounded rays need not be ones at all.
    if (test.exact()) {
      compare_ray_poses(test, rays, width, height);
    } else {
      for (const char* const name : {"in_ransac_idx", "out_homography", "out_extrinsics_ray", "out_intrinsics_ray"})
        test.array(name);
    }
  }
  if (!request.cameras.empty())
    compare_final(test, request.cameras, cameras, channels_of(depth, 0, 1), {views, height, width});

  // The whole network in one call gives the same as its parts.
  network(compute, images, request, [&](int64_t view, nn::Da3Frame frame) {
    test.judge("whole", frame.depth.data, depth[size_t(view)].data, 0);
    test.judge("whole rays", frame.rays.data, rays[size_t(view)].data, 0);
  });
}

namespace {

nn::Da3MetricOptions metric_options_of(const Json& config) {
  return {config.at("heads").get<int64_t>(), config.at("out_layers").get<std::vector<int>>()};
}

}  // namespace

void run_da3_metric(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  const nn::Da3Metric network(compute, test.weights("weights.safetensors"), metric_options_of(config));
  const std::vector<nn::FeatureMap> images = images_of(test);
  const auto views = int64_t(images.size());
  const int64_t height = images[0].height, width = images[0].width;
  const Shape shape = {1, views, height, width};

  // Views are independent: all at once is the same as one after the other.
  nn::Da3TrunkRequest pass;
  pass.visit = [&](int block, const nn::Matrix& x) {
    if (contains(value_or(config, "blocks", Json::array()), block))
      test.compare("out_block_" + std::to_string(block), x.data, {1, views, x.rows / views, x.columns}, kTokens);
  };
  const nn::Da3Tokens tokens = network.trunk()(compute, images, pass);
  for (size_t j = 0; j < tokens.layers.size(); ++j) {
    test.compare("out_feat_" + std::to_string(j), tokens.layers[j].data,
                 {1, views, tokens.patches(), tokens.layers[j].columns}, kTokens);
  }
  std::vector<nn::FeatureMap> maps;
  for (const nn::FeatureMap& image : images) maps.push_back(network(compute, image));
  test.compare("out_depth_raw", channels_of(maps, 0, 1), shape, kDepth);
  test.compare("out_sky", channels_of(maps, 1, 1), shape, kDepth);
  nn::fill_da3_sky(maps);
  test.compare("out_depth", channels_of(maps, 0, 1), shape, kMeaningless);
  if (!test.has("in_intrinsics.npy")) return;
  const FloatArray intrinsics = test.array("in_intrinsics");
  for (size_t v = 0; v < maps.size(); ++v) {
    const float* const k = intrinsics.data.data() + 9 * v;
    const auto metres = float((double(k[0]) + double(k[4])) / 2 / nn::kDa3MetricFocal);
    for (int64_t i = 0; i < maps[v].places(); ++i) maps[v].data[size_t(2 * i)] *= metres;
  }
  test.compare("out_depth_metric", channels_of(maps, 0, 1), shape, kMeaningless);
}

void run_da3_nested(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  const nn::Da3 any_view(compute, test.weights("anyview.safetensors"), options_of(config.at("anyview")));
  const nn::Da3Metric metric(compute, test.weights("metric.safetensors"), metric_options_of(config.at("metric")));
  const std::vector<nn::FeatureMap> images = images_of(test);
  const auto views = int64_t(images.size());
  const Shape shape = {1, views, images[0].height, images[0].width};
  nn::Da3Request request;
  request.rule = rule_of(config.at("anyview"));
  std::vector<nn::Da3Frame> frames;
  any_view(compute, images, request, [&](int64_t, nn::Da3Frame frame) { frames.push_back(std::move(frame)); });
  std::vector<nn::FeatureMap> maps;
  for (const nn::FeatureMap& image : images) maps.push_back(metric(compute, image));
  test.compare("out_metric_sky", channels_of(maps, 1, 1), shape, kDepth);
  nn::fill_da3_sky(maps);
  test.compare("out_metric_depth", channels_of(maps, 0, 1), shape, kMeaningless);
  const nn::MetricScale found = nn::make_da3_metric(frames, maps);
  std::vector<nn::NetworkCamera> cameras;
  std::vector<nn::FeatureMap> depth;
  for (nn::Da3Frame& frame : frames) {
    cameras.push_back(frame.camera);
    depth.push_back(std::move(frame.depth));
  }
  // Thresholds of sky and confidence decide what counts: nothing of it is safe against rounding.
  test.compare("out_scale", {float(found.scale)}, {1}, kMeaningless);
  test.compare("out_depth", channels_of(depth, 0, 1), shape, kMeaningless);
  test.compare("out_depth_conf", channels_of(depth, 1, 1), shape, kMeaningless);
  test.compare("out_extrinsics", extrinsics_of(cameras, 3), {1, views, 3, 4}, kMeaningless);
  test.compare("out_intrinsics", intrinsics_of(cameras), {1, views, 3, 3}, kMeaningless);
}

}  // namespace aligngs::parity
