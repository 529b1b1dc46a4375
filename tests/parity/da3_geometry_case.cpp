// Cameras and rays of Depth Anything 3, without a network.
#include "da3_cameras.h"
#include "nn/da3/cameras.h"
#include "nn/da3/ray_pose.h"

namespace aligngs::parity {

std::vector<nn::NetworkCamera> cameras_of(const FloatArray& extrinsics, const FloatArray& intrinsics) {
  const size_t rows = size_t(extrinsics.shape.at(extrinsics.shape.size() - 2));
  const size_t views = extrinsics.data.size() / (4 * rows);
  std::vector<nn::NetworkCamera> cameras(views);
  for (size_t v = 0; v < views; ++v) {
    const float* const e = extrinsics.data.data() + v * 4 * rows;
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) cameras[v].rotation[3 * i + j] = double(e[4 * i + j]);
      cameras[v].translation[i] = double(e[4 * i + 3]);
    }
    if (intrinsics.data.empty()) continue;
    const float* const k = intrinsics.data.data() + v * 9;
    cameras[v].fx = double(k[0]);
    cameras[v].cx = double(k[2]);
    cameras[v].fy = double(k[4]);
    cameras[v].cy = double(k[5]);
  }
  return cameras;
}

std::vector<float> extrinsics_of(const std::vector<nn::NetworkCamera>& cameras, int rows) {
  std::vector<float> out;
  for (const nn::NetworkCamera& camera : cameras) {
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) out.push_back(float(camera.rotation[3 * i + j]));
      out.push_back(float(camera.translation[i]));
    }
    if (rows == 4) out.insert(out.end(), {0, 0, 0, 1});
  }
  return out;
}

std::vector<float> intrinsics_of(const std::vector<nn::NetworkCamera>& cameras) {
  std::vector<float> out;
  for (const nn::NetworkCamera& c : cameras) {
    for (const double v : {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}) out.push_back(float(v));
  }
  return out;
}

namespace {

std::vector<nn::NetworkCamera> decoded(const FloatArray& encodings, int64_t width, int64_t height) {
  std::vector<nn::NetworkCamera> cameras;
  for (size_t at = 0; at < encodings.data.size(); at += 9) {
    nn::PoseEncoding e{};
    std::copy_n(encodings.data.begin() + std::ptrdiff_t(at), e.size(), e.begin());
    cameras.push_back(nn::decode_da3_camera(e, width, height));
  }
  return cameras;
}

}  // namespace

void compare_encoded(Case& test, const std::vector<nn::NetworkCamera>& given, int64_t width, int64_t height,
                     const std::string& name) {
  const auto views = int64_t(given.size());
  const auto normal = nn::normalised_cameras(given);
  std::vector<float> encodings;
  for (const nn::NetworkCamera& camera : normal) {
    const nn::PoseEncoding e = nn::encode_da3_camera(camera, width, height);
    encodings.insert(encodings.end(), e.begin(), e.end());
  }
  test.compare("out_extrinsics_norm", extrinsics_of(normal, 4), {1, views, 4, 4});
  test.compare(name, encodings, {1, views, 9});
}

void run_da3_camera(Case& test, nn::Compute&) {
  const int64_t height = test.config().at("hw").at(0), width = test.config().at("hw").at(1);
  const auto given = cameras_of(test.array("in_extrinsics"), test.array("in_intrinsics"));
  const auto views = int64_t(given.size());
  compare_encoded(test, given, width, height, "out_pose_enc");
  const auto first = decoded(test.array("in_pose_enc"), width, height);
  const auto count = int64_t(first.size());
  test.compare("out_dec_extrinsics", extrinsics_of(first, 3), {1, count, 3, 4});
  test.compare("out_dec_intrinsics", intrinsics_of(first), {1, count, 3, 3});
  const auto second = decoded(test.array("in_pose_enc2"), width, height);
  test.compare("out_dec2_intrinsics", intrinsics_of(second), {1, int64_t(second.size()), 3, 3});
  const auto predicted = cameras_of(test.array("in_pred_extrinsics"), {});
  const nn::CameraAlignment fit = nn::align_given_cameras(given, predicted);
  if (!fit.well_posed) test.fail("out_scale", "the fit counts as degenerate");
  test.compare("out_scale", {float(fit.scale)}, {1});
  test.compare("out_aligned", extrinsics_of(fit.cameras, 4), {1, views, 4, 4});
}

void run_da3_raypose(Case& test, nn::Compute&) {
  const int64_t height = test.config().at("hw").at(0), width = test.config().at("hw").at(1);
  const FloatArray directions = test.array("in_ray"), confidence = test.array("in_ray_conf");
  const int64_t views = directions.shape.at(1), rows = directions.shape.at(2), columns = directions.shape.at(3);
  const nn::RayDraws draws = draws_of(test.array("in_ransac_idx"));
  std::vector<nn::NetworkCamera> cameras;
  std::vector<float> homographies;
  for (int64_t v = 0; v < views; ++v) {
    nn::FeatureMap rays(rows, columns, 7);
    for (int64_t i = 0; i < rays.places(); ++i) {
      const int64_t at = v * rays.places() + i;
      std::copy_n(directions.data.data() + 6 * at, 6, rays.data.data() + 7 * i);
      rays.data[size_t(7 * i + 6)] = confidence.data[size_t(at)];
    }
    const nn::RayPose pose = nn::pose_from_rays(rays, draws, width, height, {nn::RayDecomposition::kPublished});
    cameras.push_back(pose.camera);
    for (const double a : pose.homography) homographies.push_back(float(a));
  }
  test.compare("out_homography", homographies, {1, views, 3, 3});
  test.compare("out_extrinsics", extrinsics_of(cameras, 3), {1, views, 3, 4});
  test.compare("out_intrinsics", intrinsics_of(cameras), {1, views, 3, 3});
}

nn::RayDraws draws_of(const FloatArray& array) {
  nn::RayDraws draws(size_t(array.shape.at(0)));
  for (size_t i = 0; i < draws.size(); ++i) {
    for (size_t k = 0; k < draws[i].size(); ++k) draws[i][k] = int(array.data[i * draws[i].size() + k]);
  }
  return draws;
}

}  // namespace aligngs::parity
