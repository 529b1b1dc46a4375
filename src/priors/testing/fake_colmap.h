// A program "colmap" in PATH that gives prepared cameras, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "io/atomic_file.h"
#include "io/colmap.h"
#include "priors/testing/sqlite_builder.h"

namespace aligngs {

/// The program aborts in the second attempt. Its first attempt places a.jpg, b.jpg and c.jpg. PATH is as before at the
/// end of the scope.
class FakeColmap {
 public:
  explicit FakeColmap(const std::filesystem::path& folder) : before_(std::getenv("PATH")) {
    write_database(folder / "prepared.db");
    write_model(folder / "model");
    const std::string prepared = folder.string();
    write_file_atomically(folder / "colmap",
                          "#!/bin/sh\n"
                          "[ \"$2\" = -h ] && exit 0\n"
                          "case \"$1\" in\n"
                          "feature_extractor)\n"
                          "  case \"$3\" in *thorough.db) echo 'assertion failed'; kill -ABRT $$ ;; esac\n"
                          "  ls \"$5\" > '" +
                              prepared +
                              "/seen.txt'\n"
                              "  cp '" +
                              prepared +
                              "/prepared.db' \"$3\" ;;\n"
                              "mapper) cp -r '" +
                              prepared +
                              "/model' \"$7/0\" ;;\n"
                              "esac\n");
    std::filesystem::permissions(folder / "colmap", std::filesystem::perms::owner_all);
    setenv("PATH", (prepared + ":" + before_).c_str(), 1);
  }
  ~FakeColmap() { setenv("PATH", before_.c_str(), 1); }
  FakeColmap(const FakeColmap&) = delete;
  FakeColmap& operator=(const FakeColmap&) = delete;

 private:
  static void write_database(const std::filesystem::path& file) {
    SqliteBuilder builder;
    const int64_t many = 4000, shared = 300, pair = int64_t(2147483647) + 2;  // COLMAP's id of the pair 1, 2
    builder.table("images", {{1, {int64_t(0), "a.jpg"}},
                             {2, {int64_t(0), "b.jpg"}},
                             {3, {int64_t(0), "c.jpg"}},
                             {4, {int64_t(0), "d.jpg"}}});
    builder.table("keypoints",
                  {{1, {int64_t(0), many}}, {2, {int64_t(0), many}}, {3, {int64_t(0), many}}, {4, {int64_t(0), many}}});
    builder.table("matches", {{pair, {int64_t(0), shared}}});
    builder.table("two_view_geometries", {{pair, {int64_t(0), shared}}});
    write_file_atomically(file, builder.file());
  }
  static void write_model(const std::filesystem::path& folder) {
    ColmapModel model;
    ColmapCamera camera;
    camera.id = 1;
    camera.model = "PINHOLE";
    camera.width = 120;
    camera.height = 90;
    camera.params = {100, 100, 60, 45};
    model.cameras.push_back(camera);
    for (uint32_t id = 1; id <= 3; ++id) {
      ColmapImage image;
      image.id = id;
      image.camera_id = 1;
      image.name = std::string(1, char('a' + id - 1)) + ".jpg";
      image.translation = {0.1 * id, 0, 0};
      model.images.push_back(image);
    }
    for (uint64_t id = 1; id <= 4; ++id) {
      ColmapPoint point;
      point.id = id;
      point.position = {0.1 * double(id), 0.1, 2};
      model.points.push_back(point);
    }
    write_colmap_binary(folder, model);
  }
  std::string before_;
};

}  // namespace aligngs
