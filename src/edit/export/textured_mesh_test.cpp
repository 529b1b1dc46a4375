#include "edit/export/textured_mesh.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "edit/export/chosen_objects.h"
#include "edit/export/testing/painted_photos.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

class TexturedMesh : public testing::Test {
 protected:
  ExportMesh textured(int threads = 2) {
    ThreadPool pool(threads);
    ExportMesh mesh = export_mesh(room_, {.error = 0.001}, pool);
    report_ = add_texture(mesh, room_, photos_, 2048, pool);
    return mesh;
  }
  /// Mean distance of the texture's colours from the painted pattern, over corners and middles of triangles that
  /// satisfy a condition.
  template <class Condition>
  double error(const ExportMesh& mesh, Condition&& condition) {
    double sum = 0;
    size_t count = 0;
    for (const ObjectMesh& object : mesh.objects) {
      for (const auto& t : object.mesh.triangles) {
        const Vec3f middle =
            (object.mesh.vertices[t[0]] + object.mesh.vertices[t[1]] + object.mesh.vertices[t[2]]) * (1.f / 3);
        if (!condition(middle)) continue;
        float u = 0, v = 0;
        for (const uint32_t c : t) u += object.uv[c][0] / 3, v += object.uv[c][1] / 3;
        const uint8_t* pixel = mesh.texture.pixel(static_cast<int>(u * static_cast<float>(mesh.texture.width)),
                                                  static_cast<int>(v * static_cast<float>(mesh.texture.height)));
        const Vec3f wanted = painted::pattern(middle);
        for (int k = 0; k < 3; ++k) sum += std::abs(pixel[k] / 255.0 - static_cast<double>(wanted[k])) / 3;
        ++count;
      }
    }
    EXPECT_GT(count, 4u);
    return sum / static_cast<double>(count);
  }

  ThreadPool pool_{2};
  EditableRoom room_ = small_room::make(pool_);
  TexturePhotos photos_ = painted::photos(room_.mesh, pool_);
  BakeReport report_;
};

bool on_floor(const Vec3f& p) { return p.y > -0.001f; }

TEST_F(TexturedMesh, HasThePatternOfThePhotos) {
  const ExportMesh mesh = textured();
  // The floor before all things, which every photo shows.
  EXPECT_LT(error(mesh, [](const Vec3f& p) { return on_floor(p) && p.z < -0.3f; }), 0.02);
  EXPECT_GT(report_.from_photos, report_.texels / 2);
}

TEST_F(TexturedMesh, WhatNoPhotoShowsHasTheColourOfTheSplats) {
  // All cameras are at z < 0, and these sides of the box are turned away from them.
  const ExportMesh mesh = textured();
  for (const ObjectMesh& object : mesh.objects) {
    if (object.class_name != "box") continue;
    size_t seen = 0;
    for (size_t v = 0; v < object.mesh.vertices.size(); ++v) {
      if (object.mesh.normals[v].z < 0.9f) continue;
      const int x = static_cast<int>(object.uv[v][0] * static_cast<float>(mesh.texture.width)),
                y = static_cast<int>(object.uv[v][1] * static_cast<float>(mesh.texture.height));
      const uint8_t* pixel = mesh.texture.pixel(x, y);
      EXPECT_NEAR(pixel[0], 0.8 * 255, 40);
      EXPECT_NEAR(pixel[2], 0.5 * 255, 60);
      ++seen;
    }
    EXPECT_GE(seen, 4u);
  }
}

TEST_F(TexturedMesh, EditedSurfaceHasTheColourOfTheSplats) {
  for (size_t v = 0; v < room_.mesh.vertices.size(); ++v) {
    if (on_floor(room_.mesh.vertices[v])) room_.mesh.colors[v] = {1, 2, 3};
  }
  const ExportMesh mesh = textured();
  EXPECT_GT(error(mesh, on_floor), 0.05) << "the photos show it as it was";
}

TEST_F(TexturedMesh, VerticesAreDoubledAndKeepTheirPlaces) {
  const ExportMesh mesh = textured();
  size_t triangles = 0;
  for (const ObjectMesh& object : mesh.objects) {
    ASSERT_EQ(object.uv.size(), object.mesh.vertices.size());
    EXPECT_TRUE(object.mesh.colors.empty());
    triangles += object.mesh.triangles.size();
    for (const auto& uv : object.uv) EXPECT_TRUE(uv[0] >= 0 && uv[0] <= 1 && uv[1] >= 0 && uv[1] <= 1);
  }
  EXPECT_EQ(triangles, export_mesh(room_, {.error = 0.001}, pool_).triangles);
}

TEST_F(TexturedMesh, IsTheSameForAnyNumberOfThreads) { EXPECT_EQ(textured(1).texture.data, textured(3).texture.data); }

TEST_F(TexturedMesh, MovesWithTheRoom) {
  const ExportMesh here = textured();
  const Similarity to{2, rotation_matrix(normalized(Quaterniond{0.9, 0.1, 0.3, 0.2})), {1, 2, 3}};
  photos_ = moved(std::move(photos_), to);
  for (Vec3f& v : room_.mesh.vertices) v = (to * v.cast<double>()).cast<float>();
  for (Vec3f& n : room_.mesh.normals) n = (to.rotation * n.cast<double>()).cast<float>();
  room_.gaussians.extent *= 2;
  textured();
  const BakeReport there = report_;
  photos_ = painted::photos(small_room::make(pool_).mesh, pool_);
  room_ = small_room::make(pool_);
  textured();
  EXPECT_NEAR(static_cast<double>(there.from_photos) / static_cast<double>(there.texels),
              static_cast<double>(report_.from_photos) / static_cast<double>(report_.texels), 0.02);
}

TEST_F(TexturedMesh, ABlurredPhotoHasLittleWeight) {
  photos_.photos[0].sharpness = 0.1f;
  for (uint8_t& c : photos_.photos[0].color.data) c = 128;
  const double blurred = error(textured(), on_floor);
  photos_.photos[0].sharpness = 1;
  EXPECT_LT(blurred, error(textured(), on_floor));
}

TEST_F(TexturedMesh, ChosenObjectsAreAloneInTheFile) {
  const EditableRoom pillow = chosen_objects(room_, "pillow.002", pool_);
  ASSERT_EQ(export_mesh(pillow, {}, pool_).objects.size(), 1u);
  EXPECT_EQ(export_mesh(pillow, {}, pool_).objects[0].name, "pillow.002");
  EXPECT_EQ(small_room::count_label(pillow, small_room::kPillow), pillow.gaussians.model.size());
  const EditableRoom pillows = chosen_objects(room_, "pillow", pool_);
  EXPECT_EQ(export_mesh(pillows, {}, pool_).objects.size(), 2u);
  EXPECT_THROW(chosen_objects(room_, "pillow#3", pool_), Error);
  EXPECT_THROW(chosen_objects(room_, "spoonbill", pool_), Error);
}

TEST_F(TexturedMesh, SimplifiedObjectsKeepTheirNamesAndLittleChange) {
  const ExportMesh all = export_mesh(room_, {}, pool_), few = export_mesh(room_, {.error = 0.001}, pool_);
  ASSERT_EQ(few.objects.size(), all.objects.size());
  for (size_t i = 0; i < few.objects.size(); ++i) EXPECT_EQ(few.objects[i].name, all.objects[i].name);
  EXPECT_LT(few.triangles, all.triangles / 3);
  EXPECT_EQ(few.triangles_before, all.triangles);
}

TEST_F(TexturedMesh, AClosedRoomHasNoOpenEdge) {
  EXPECT_EQ(export_mesh(room_, {.closed = true}, pool_).open_edges, 0u);
  EXPECT_EQ(export_mesh(room_, {.error = 0.001, .closed = true}, pool_).open_edges, 0u);
}

TEST_F(TexturedMesh, TheColliderHasNoColours) {
  const ExportMesh collider = collision_mesh(room_, {}, pool_);
  EXPECT_LT(collider.triangles, room_.mesh.triangles.size() / 3);
  for (const ObjectMesh& object : collider.objects)
    EXPECT_TRUE(object.mesh.colors.empty() && object.mesh.normals.empty());
}

TEST_F(TexturedMesh, TheColliderHasNoMoreTrianglesThanAskedFor) {
  const size_t usual = collision_mesh(room_, {}, pool_).triangles;
  EXPECT_EQ(collision_mesh(room_, {.triangles = 100000}, pool_).triangles, usual)
      << "a limit far above changes nothing";
  EXPECT_LT(collision_mesh(room_, {.triangles = usual / 2}, pool_).triangles, usual);
}

}  // namespace
}  // namespace aligngs
