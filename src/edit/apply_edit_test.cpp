#include "edit/apply_edit.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/edit_products.h"
#include "edit/mesh_selection.h"
#include "edit/recolor.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

using small_room::edit_of;

class ApplyEdit : public testing::Test {
 protected:
  ApplyEdit() : room_(small_room::make(pool_)) {}
  size_t mesh_vertices_above_floor() const {
    size_t n = 0;
    for (const Vec3f& v : room_.mesh.vertices) n += v.y < -0.02f && v.x < -0.25f;
    return n;
  }
  ThreadPool pool_{2};
  EditableRoom room_;
};

TEST_F(ApplyEdit, DeleteRemovesGaussiansAndSurface) {
  EXPECT_GT(mesh_vertices_above_floor(), 100u);
  const EditReport report = apply_edit(room_, edit_of(EditKind::kDelete, "pillow#1"), pool_);
  EXPECT_EQ(report.after, report.before - report.selected);
  EXPECT_EQ(room_.origins.size(), room_.gaussians.model.size());
  EXPECT_EQ(mesh_vertices_above_floor(), 0u) << "nothing of the pillow is left";
  EXPECT_LT(report.vertices_after, report.vertices_before);
}

TEST_F(ApplyEdit, ObjectsKeepTheirNumbersAfterADeletion) {
  apply_edit(room_, edit_of(EditKind::kDelete, "pillow#1"), pool_);
  const EditReport second = apply_edit(room_, edit_of(EditKind::kExtract, "pillow#2"), pool_);
  ASSERT_EQ(second.objects.size(), 1u);
  EXPECT_EQ(second.objects[0].instance, 2);
  EXPECT_THROW(apply_edit(room_, edit_of(EditKind::kDelete, "pillow#1"), pool_), Error) << "it is gone";
}

TEST_F(ApplyEdit, ExtractKeepsTheObjectAlone) {
  const EditReport report = apply_edit(room_, edit_of(EditKind::kExtract, "box"), pool_);
  EXPECT_EQ(report.after, report.selected);
  for (const Vec3f& v : room_.mesh.vertices) {
    EXPECT_LE(std::abs(v.x), 0.25f);
    EXPECT_LE(v.y, 0.001f);
  }
  const EditableRoom alone = centred(room_);
  for (size_t a = 0; a < 3; ++a) {
    float low = 1e9f, high = -1e9f;
    for (size_t i = 0; i < alone.gaussians.model.size(); ++i) {
      low = std::min(low, alone.gaussians.model.positions[3 * i + a]);
      high = std::max(high, alone.gaussians.model.positions[3 * i + a]);
    }
    EXPECT_NEAR(low, -high, 1e-5f) << "centred along axis " << a;
  }
}

TEST_F(ApplyEdit, FillClosesTheHoleOnTheSupportingPlane) {
  const EditReport report = apply_edit(room_, edit_of(EditKind::kDelete, "pillow#1", true), pool_);
  ASSERT_GT(report.filled, 50u);
  const GaussianModel& m = room_.gaussians.model;
  for (size_t i = 0; i < m.size(); ++i) {
    if (!room_.origins[i].filled) continue;
    EXPECT_NEAR(m.positions[3 * i + 1], 0, 0.01) << "on the floor";
    EXPECT_NEAR(base_color_of(m, i).x, 0.6, 0.05) << "in the floor's colour";
    EXPECT_EQ(room_.gaussians.labels.label[i], small_room::kFloor);
  }
  // Each place of the hole has floor within one spacing.
  for (float x = -0.78f; x < -0.34f; x += 0.05f) {
    for (float z = -0.18f; z < 0.26f; z += 0.05f) {
      double nearest = 1;
      for (size_t i = 0; i < m.size(); ++i)
        nearest = std::min<double>(
            nearest, std::hypot(m.positions[3 * i] - x, m.positions[3 * i + 1], m.positions[3 * i + 2] - z));
      EXPECT_LT(nearest, small_room::kSpacing) << x << " " << z;
    }
  }
  size_t patch = 0;
  for (const Vec3f& v : room_.mesh.vertices)
    patch += v.x > -0.7f && v.x < -0.4f && v.z > -0.1f && v.z < 0.2f && std::abs(v.y) < 0.01f;
  EXPECT_GT(patch, 10u) << "the mesh has a patch, too";
}

TEST_F(ApplyEdit, AMovedObjectIsElsewhereAndItsPlaceIsFilled) {
  Camera camera;
  camera.width = camera.height = 64;
  camera.fx = camera.fy = 64;
  camera.cx = camera.cy = 32;
  camera.world_to_camera.translation = {0, 1, 4};
  room_.cameras = {camera};
  EditOperation edit = edit_of(EditKind::kMove, "pillow#1", true);
  edit.motion.shift = {0, 0.3, 0};
  const EditReport report = apply_edit(room_, edit, pool_);
  EXPECT_EQ(report.after, report.before + report.filled - report.cleared);
  EXPECT_GT(report.filled, 50u);
  float lowest = 1e9f;
  for (size_t i = 0; i < room_.gaussians.model.size(); ++i) {
    if (room_.gaussians.labels.label[i] == small_room::kPillow && room_.gaussians.labels.instance[i] == 1) {
      lowest = std::min(lowest, -room_.gaussians.model.positions[3 * i + 1]);
    }
  }
  EXPECT_NEAR(lowest, 0.3 + 0.02, 0.03) << "up is -y";
  edit.motion.shift = {0, -0.3, 0};
  EXPECT_NO_THROW(apply_edit(room_, edit, pool_)) << "it keeps its name";
}

TEST_F(ApplyEdit, ACopyIsBesideTheOriginal) {
  Camera camera;
  camera.world_to_camera.translation = {0, 1, 4};
  room_.cameras = {camera};
  const EditReport report = apply_edit(room_, edit_of(EditKind::kDuplicate, "box"), pool_);
  EXPECT_EQ(report.after, report.before + report.selected);
  const std::vector<Instance> objects = list_instances(room_.gaussians.model, room_.gaussians.labels);
  std::vector<Instance> boxes;
  for (const Instance& o : objects) {
    if (o.label == small_room::kBox) boxes.push_back(o);
  }
  ASSERT_EQ(boxes.size(), 2u);
  EXPECT_GT(boxes[1].low.x, boxes[0].high.x) << "on its right";
}

TEST_F(ApplyEdit, RecolorGivesTheColourInTheMean) {
  EditOperation edit = edit_of(EditKind::kRecolor, "pillow");
  edit.color = {230, 51, 26};
  const GaussianModel before = room_.gaussians.model;
  apply_edit(room_, edit, pool_);
  const GaussianModel& m = room_.gaussians.model;
  size_t changed = 0;
  for (size_t i = 0; i < m.size(); ++i) {
    if (base_color_of(m, i).x == base_color_of(before, i).x) continue;
    ++changed;
    EXPECT_NEAR(base_color_of(m, i).x, 0.902, 0.01);
    EXPECT_NEAR(base_color_of(m, i).y, 0.2, 0.01);
    EXPECT_NEAR(base_color_of(m, i).z, 0.102, 0.01);
  }
  EXPECT_GT(changed, 100u);
  EXPECT_EQ(m.positions, before.positions);
}

TEST_F(ApplyEdit, MistakesLeaveTheRoomAsItWas) {
  const size_t before = room_.gaussians.model.size();
  EXPECT_THROW(apply_edit(room_, edit_of(EditKind::kDelete, "everything"), pool_), Error);
  EXPECT_THROW(apply_edit(room_, edit_of(EditKind::kDelete, "car"), pool_), Error);
  EXPECT_THROW(apply_edit(room_, edit_of(EditKind::kDelete, "pilow"), pool_), Error);
  EXPECT_EQ(room_.gaussians.model.size(), before);
}

TEST(Recolor, KeepsTheShadeOfEveryDirection) {
  GaussianModel model;
  model.sh_degree = 3;
  model.resize(2);
  for (size_t k = 0; k < model.sh.size(); ++k) model.sh[k] = 0.1f * std::sin(static_cast<float>(k));
  model.opacity_logits = {2, 2};
  const GaussianModel before = model;
  const std::array<uint8_t, 3> color{200, 100, 50};
  recolor_gaussians(model, {1, 1}, color);
  const auto color_at = [](const GaussianModel& m, size_t i, const Vec3d& d) {
    double basis[kShCoefficients];
    sh_basis(3, d, basis);
    Vec3d c{0.5, 0.5, 0.5};
    for (size_t k = 0; k < kShCoefficients; ++k) {
      for (int a = 0; a < 3; ++a) c[a] += basis[k] * m.sh[3 * (kShCoefficients * i + k) + static_cast<size_t>(a)];
    }
    return c;
  };
  const auto luma = [](const Vec3d& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; };
  double ratio = 0;
  for (const Vec3d& direction : {Vec3d{1, 0, 0}, Vec3d{0, 0.6, 0.8}, Vec3d{-0.48, 0.6, -0.64}}) {
    for (size_t i = 0; i < 2; ++i) {
      const Vec3d c = color_at(model, i, direction);
      EXPECT_NEAR(c.x / c.y, 2, 1e-3) << "the hue is the colour's from every side";
      EXPECT_NEAR(c.y / c.z, 2, 1e-3);
      const double r = luma(c) / luma(color_at(before, i, direction));
      if (ratio == 0) ratio = r;
      EXPECT_NEAR(r, ratio, 1e-3) << "and the shade is what it was";
    }
  }
}

TEST(Recolor, BlackThingsDoNotBlowUp) {
  GaussianModel model;
  model.resize(1);
  for (size_t c = 0; c < 3; ++c) model.sh[c] = -0.5f / static_cast<float>(kSh0);
  recolor_gaussians(model, {1}, {255, 255, 255});
  EXPECT_NEAR(base_color_of(model, 0).x, 0, 1e-4);
  recolor_gaussians(model, {0}, {255, 255, 255});
}

TEST(Submesh, SplitsWithoutLosingTriangles) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  mesh.labels = {1, 1, 1, 2};
  const std::vector<uint8_t> flags = {1, 1, 0, 0};
  const TriangleMesh in = submesh(mesh, flags, 1), out = submesh(mesh, flags, 0);
  EXPECT_EQ(in.triangles.size() + out.triangles.size(), 2u);
  EXPECT_EQ(in.vertices.size(), 3u);
  EXPECT_EQ(out.labels.size(), out.vertices.size());
}

}  // namespace
}  // namespace aligngs
