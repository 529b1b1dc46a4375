// Photos and tiny networks for the tests of scenes from photos and of their priors.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/log.h"
#include "core/testing/error.h"
#include "io/image_file.h"
#include "nn/random_weights.h"
#include "priors/scene_from_photos.h"
#include "priors/scene_priors.h"
#include "priors/teacher_list.h"

namespace aligngs {

/// Networks of the published structure and tiny sizes with random weights.
class FromPhotos : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::path(testing::TempDir()) /
             ("from_photos_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder / "photos");
    store_options.folder = folder / "models";
    options.model = "vggt-1b";
    options.precision = nn::Precision::kFloat32;
    options.progress.enabled = false;
    fill.precision = nn::Precision::kFloat32;
    fill.progress.enabled = false;
    set_log_level(LogLevel::kSilent);
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  void write_photo(const std::string& name, int width, int height) const {
    Image<uint8_t> image(width, height, 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        image.at(x, y, 0) = uint8_t(x * 255 / width);
        image.at(x, y, 1) = uint8_t(y * 255 / height);
        image.at(x, y, 2) = uint8_t(name.size() * 20);
      }
    }
    write_jpeg(folder / "photos" / name, image);
  }
  std::filesystem::path weights_of(const char* model, size_t file = 0) const {
    const PublishedModel& m = published_model(model);
    return ModelStore(store_options).own_path(m, m.files[file]);
  }
  void install_vggt() const {
    nn::VggtSize size;
    size.encoder = {64, 2, false, 4, 5};
    size.depth = 8;
    size.camera_depth = 1;
    size.features = 8;
    size.levels = {8, 8, 8, 8};
    nn::write_random_weights(weights_of("vggt-1b"), nn::vggt_tensors(size), 1);
  }
  void install_da3(const char* model = "da3-base") const {
    nn::Da3Size size;
    size.encoder = {64, 12, false, 0, 5};
    size.heads = 1;
    size.features = 8;
    size.camera_depth = 1;
    size.levels = {8, 8, 8, 8};
    nn::write_random_weights(weights_of(model), nn::da3_tensors(size), 1);
  }
  void install_da3_metric() const {
    nn::Da3MetricSize size;
    size.encoder = {64, 24, false, 0, 5};
    size.features = 8;
    size.levels = {8, 8, 8, 8};
    nn::write_random_weights(weights_of("da3metric-large"), nn::da3_metric_tensors(size), 1);
  }
  void install_label_networks() const {
    nn::EomtSize eomt;
    eomt.encoder = {64, 4, false, 4, 4};  // windows of 64 pixels
    eomt.queries = 6;
    eomt.query_blocks = 2;
    nn::write_random_weights(weights_of("eomt-l"), nn::eomt_tensors(eomt), 1);
    nn::write_random_weights(weights_of("eomt-l-panoptic"), nn::eomt_huggingface_tensors(eomt), 1);
    nn::LingbotSize lingbot;
    lingbot.encoder = {64, 2, false, 4, 0};
    lingbot.heads = 1;
    nn::write_random_weights(weights_of("lingbot-s"), nn::lingbot_tensors(lingbot), 1);
  }
  void install_linear() const {
    const nn::VitSize size{64, 4, false, 0, 5};
    nn::write_random_weights(weights_of("dinov2-s"), nn::dinov2_tensors(size), 1);
    nn::write_random_weights(weights_of("ade20k-linear-s"), nn::bn_head_tensors(size.channels), 2);
    nn::write_random_weights(weights_of("ade20k-ms-s"), nn::bn_head_tensors(4 * size.channels), 2);
    nn::write_random_weights(weights_of("nyu-linear4-s"), nn::linear_depth_tensors(4 * 2 * size.channels), 3);
  }
  ScenePhotosReport make() const {
    return make_scene_from_photos(folder / "photos", folder / "scene", ModelStore(store_options), options);
  }
  void three_photos() const {
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) write_photo(name, 120, 90);
  }

  std::filesystem::path folder;
  ModelStoreOptions store_options;
  ScenePhotosOptions options;
  ScenePriorsOptions fill;
};

}  // namespace aligngs
