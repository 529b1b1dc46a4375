#include "edit/export/object_meshes.h"

#include <gtest/gtest.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

constexpr int kNightstand = 10, kBedClass = 7;  // ADE20K class numbers

/// A nightstand and a box a metre away from it. The mesh of each has the label given.
class ObjectMeshes : public testing::Test {
 protected:
  ObjectMeshes() {
    model_.semantic_channels = 150;
    small_room::add_box(model_, mesh_, {0, -0.4f, 0}, {0.4f, 0, 0.4f}, {0.6f, 0.4f, 0.2f}, kNightstand);
    first_box_vertex_ = mesh_.vertices.size();
    small_room::add_box(model_, mesh_, {1.4f, -0.4f, 0}, {1.8f, 0, 0.4f}, {0.8f, 0.8f, 0.8f}, small_room::kBox);
    room_ = label_objects(model_, ade20k_labels(), small_room::kExtent, pool_);
  }
  /// Triangles of the object with a name; 0 without it.
  size_t triangles_of(const std::string& name) {
    for (const ObjectMesh& object : object_meshes(mesh_, room_, ade20k_labels(), pool_)) {
      if (object.name == name) return object.mesh.triangles.size();
    }
    return 0;
  }
  void call_box(int label) {
    for (size_t v = first_box_vertex_; v < mesh_.vertices.size(); ++v) mesh_.labels[v] = static_cast<uint16_t>(label);
  }
  ThreadPool pool_{2};
  GaussianModel model_;
  TriangleMesh mesh_;
  size_t first_box_vertex_ = 0;
  LabelledGaussians room_;
};

TEST_F(ObjectMeshes, ASurfaceGoesToTheObjectThatIsThere) {
  call_box(kNightstand);
  EXPECT_EQ(triangles_of("cabinet.001"), triangles_of("box.001"));
}

TEST_F(ObjectMeshes, ASurfaceOfAClassWithoutObjectsGoesToTheObjectThatIsThere) {
  const size_t before = triangles_of("box.001");
  call_box(kBedClass);
  EXPECT_EQ(triangles_of("bed.000"), 0u);
  EXPECT_EQ(triangles_of("box.001"), before);
}

TEST_F(ObjectMeshes, StraysCanBeLeftOutOfObjects) {
  call_box(kNightstand);
  size_t of_object = 0, of_none = 0;
  for (const ObjectMesh& object : object_meshes(mesh_, room_, ade20k_labels(), pool_, StrayVertices::kNoObject)) {
    if (object.name == "cabinet.001") of_object = object.mesh.triangles.size();
    if (object.name == "cabinet.000") of_none = object.mesh.triangles.size();
  }
  EXPECT_GT(of_object, 0u);
  EXPECT_EQ(of_none, of_object);
}

TEST_F(ObjectMeshes, WithoutNumberedObjectsTheMeshKeepsItsClasses) {
  std::fill(room_.labels.instance.begin(), room_.labels.instance.end(), uint16_t(0));
  EXPECT_GT(triangles_of("box.000"), 0u);
}

}  // namespace
}  // namespace aligngs
