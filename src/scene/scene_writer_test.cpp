#include "scene/scene_writer.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/scene.h"
#include "scene/testing/scene_folder.h"

namespace aligngs {
namespace {

using namespace test_scene;

TEST(SceneWriter, WrittenSceneOpensEqual) {
  const Scene scene = open_scene(write_scene());
  EXPECT_TRUE(scene.metric);
  EXPECT_EQ(scene.source, "test");
  EXPECT_EQ(scene.prior_source, "simulated");
  EXPECT_EQ(scene.semantic_kind, SemanticKind::kScores);
  EXPECT_TRUE(scene.semantic_kind_stated);
  EXPECT_EQ(scene.labels.size(), 3);
  ASSERT_EQ(scene.views.size(), 3u);
  EXPECT_EQ(scene.train, (std::vector<int>{0, 1}));
  EXPECT_EQ(scene.test, (std::vector<int>{2}));
  EXPECT_NEAR(scene.views[2].camera.centre().x, 0.2, 1e-12);
  EXPECT_TRUE(scene.has_prior_depth());
  EXPECT_TRUE(scene.has_semantics());
  EXPECT_EQ(scene.evaluation_cameras.size(), 3u);
  EXPECT_EQ(scene.cloud.size(), 200u);
  EXPECT_TRUE(scene.cloud.has_normals());
}

TEST(SceneWriter, FilesAreCopiedByteForByte) {
  const fs::path photo = fresh_folder("photo.jpg");
  write_jpeg(photo, textured_image(3));
  SceneViewParts view = view_parts(0);
  view.image = {};
  view.image_file = photo;
  const fs::path folder = fresh_folder("scene");
  SceneWriter writer(folder, false);
  writer.add_view(view);
  SceneParts parts = scene_parts();
  parts.split = {};
  writer.finish(parts);
  EXPECT_EQ(read_text(folder / "images" / "v0.jpg"), read_text(photo));
}

TEST(SceneWriter, WithoutFinishNothingIsLeft) {
  const fs::path folder = fresh_folder("scene");
  {
    SceneWriter writer(folder, false);
    writer.add_view(view_parts(0));
  }
  EXPECT_FALSE(fs::exists(folder));
  EXPECT_TRUE(fs::is_empty(folder.parent_path()));
}

TEST(SceneWriter, AFolderThatIsNotEmptyIsRefused) {
  const fs::path folder = write_scene();
  EXPECT_THROW(SceneWriter(folder, false), Error);
  EXPECT_TRUE(fs::exists(folder / "scene.json"));
}

TEST(SceneWriter, OverwriteReplacesAScene) {
  const fs::path folder = write_scene();
  {
    SceneWriter writer(folder, true);
    writer.add_view(view_parts(5));
    SceneParts parts = scene_parts();
    parts.split = {};
    writer.finish(parts);
  }
  EXPECT_EQ(open_scene(folder).views.size(), 1u);
  EXPECT_FALSE(fs::exists(folder / "images" / "v0.png"));
}

TEST(SceneWriter, OverwriteNeverReplacesAFolderThatIsNoScene) {
  const fs::path folder = fresh_folder("documents");
  fs::create_directories(folder);
  write_text(folder / "letter.txt", "dear");
  EXPECT_THROW(SceneWriter(folder, true), Error);
  EXPECT_TRUE(fs::exists(folder / "letter.txt"));
}

TEST(SceneWriter, ContradictionsAreRefused) {
  SceneWriter writer(fresh_folder("scene"), false);
  SceneViewParts wrong_size = view_parts(0);
  wrong_size.camera.width = 41;
  EXPECT_THROW(writer.add_view(wrong_size), Error);
  SceneViewParts outside = view_parts(0);
  outside.name = "../v0";
  EXPECT_THROW(writer.add_view(outside), Error);
  SceneViewParts aspect = view_parts(0);
  aspect.prior_depth = ImageF(40, 10, 1, 1.0f);
  EXPECT_THROW(writer.add_view(aspect), Error);
}

TEST(SceneWriter, TwoViewsOfOneNameAreRefused) {
  SceneWriter writer(fresh_folder("scene"), false);
  writer.add_view(view_parts(0));
  EXPECT_THROW(writer.add_view(view_parts(0)), Error);
}

TEST(SceneWriter, ASceneWithoutViewsIsRefused) {
  SceneWriter writer(fresh_folder("scene"), false);
  EXPECT_THROW(writer.finish({}), Error);
}

}  // namespace
}  // namespace aligngs
