#include <gmock/gmock.h>

#include <algorithm>

#include "core/error.h"
#include "edit/export/scene_export.h"
#include "edit/testing/small_room.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class Usda : public testing::Test {
 protected:
  std::string written(RoomParts parts = RoomParts::kAll) {
    report_ = write_usda(file_, room_, pool_, {.parts = parts});
    return read_file(file_);
  }
  ThreadPool pool_{2};
  EditableRoom room_ = small_room::make(pool_);
  fs::path file_ = fs::path(testing::TempDir()) / "aligngs_room.usda";
  ExportReport report_;
};

size_t count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

TEST_F(Usda, EveryObjectHasItsLabelSplatsMeshAndCollider) {
  const std::string text = written();
  EXPECT_EQ(count(text, "{"), count(text, "}"));
  EXPECT_EQ(count(text, "def Mesh \"mesh\""), 4u);
  EXPECT_EQ(count(text, "def Mesh \"collider\""), count(text, "PhysicsMeshCollisionAPI"));
  EXPECT_THAT(text,
              HasSubstr("def Xform \"pillow_001\" (\n        prepend apiSchemas = [\"SemanticsLabelsAPI:class\"]"));
  EXPECT_EQ(count(text, "semantics:labels:class = [\"pillow\"]"), 2u);
  EXPECT_EQ(report_.gaussians, room_.gaussians.model.size());
}

TEST_F(Usda, TheColliderIsInvisibleAndHasFewerTriangles) {
  const std::string text = written(RoomParts::kMesh);
  const auto corners = [&](const char* name) {
    size_t n = 0;
    for (size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
      const size_t list = text.find("faceVertexCounts = [", at);
      n += 1 +
           static_cast<size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(list),
                                          text.begin() + static_cast<std::ptrdiff_t>(text.find(']', list + 20)), ','));
    }
    return n;
  };
  EXPECT_EQ(corners("def Mesh \"mesh\""), room_.mesh.triangles.size());
  EXPECT_LT(corners("def Mesh \"collider\""), room_.mesh.triangles.size() / 3);
  EXPECT_EQ(count(text, "uniform token purpose = \"guide\""), count(text, "def Mesh \"collider\""));
}

TEST_F(Usda, AllGaussiansAreThereOnce) {
  const std::string text = written(RoomParts::kSplats);
  size_t numbers = 0;
  for (size_t at = text.find("opacities = ["); at != std::string::npos; at = text.find("opacities = [", at + 1)) {
    const std::string list = text.substr(at, text.find(']', at) - at);
    numbers += 1 + static_cast<size_t>(std::count(list.begin(), list.end(), ','));
  }
  EXPECT_EQ(numbers, room_.gaussians.model.size());
}

TEST_F(Usda, EitherKindAlone) {
  EXPECT_THAT(written(RoomParts::kMesh), Not(HasSubstr("ParticleField")));
  EXPECT_EQ(report_.gaussians, 0u);
  EXPECT_THAT(written(RoomParts::kSplats), Not(HasSubstr("def Mesh")));
}

TEST_F(Usda, ClassNamesFromOutsideAreQuoted) {
  room_.labels.classes[room_.gaussians.labels.label[0]].name = "a\"b\\c d";
  const std::string text = written();
  EXPECT_THAT(text, HasSubstr("[\"a\\\"b\\\\c d\"]"));
  EXPECT_THAT(text, HasSubstr("def Xform \"a_b_c_d_001\""));
}

TEST_F(Usda, WithoutMeshTheMeshAloneIsAnError) {
  room_.mesh = {};
  EXPECT_THROW(written(RoomParts::kMesh), Error);
  EXPECT_THAT(written(), HasSubstr("ParticleField3DGaussianSplat"));
}

}  // namespace
}  // namespace aligngs
