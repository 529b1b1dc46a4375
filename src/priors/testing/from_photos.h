// Photos and tiny networks for the tests of scenes from photos and of their priors.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/log.h"
#include "core/testing/error.h"
#include "io/image_file.h"
#include "priors/scene_from_photos.h"
#include "priors/scene_priors.h"
#include "priors/teacher_list.h"
#include "priors/testing/tiny_networks.h"

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
  ModelStore store() const { return ModelStore(store_options); }
  std::filesystem::path weights_of(const char* model, size_t file = 0) const {
    return tiny_networks::weights_of(store(), model, file);
  }
  void install_vggt() const { tiny_networks::install_vggt(store()); }
  void install_da3(const char* model = "da3-base") const { tiny_networks::install_da3(store(), model); }
  void install_da3_metric() const { tiny_networks::install_da3_metric(store()); }
  void install_label_networks() const { tiny_networks::install_label_networks(store()); }
  void install_linear() const {
    tiny_networks::install_linear(store());
    tiny_networks::install_multi_scale(store());
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
