#include "edit/selection.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/object_names.h"
#include "edit/testing/small_room.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

class SelectionTest : public testing::Test {
 protected:
  GaussianSelection select(const std::string& text, const std::string& threshold = "argmax") {
    return select_gaussians(room_.gaussians, parse_selection(text, Vocabulary(room_.labels)),
                            parse_threshold(threshold), room_.labels, {}, pool_);
  }
  size_t wrong(const GaussianSelection& s, int label) const {
    size_t n = 0;
    for (size_t i = 0; i < s.mask.size(); ++i) n += s.mask[i] != (truth_[i] == label);
    return n;
  }
  SelectionTest() : room_(small_room::make(pool_)) {
    for (size_t i = 0; i < room_.gaussians.model.size(); ++i) {
      const float* s = &room_.gaussians.model.semantics[150 * i];
      truth_.push_back(static_cast<int>(std::max_element(s, s + 150) - s));
    }
  }
  ThreadPool pool_{2};
  EditableRoom room_;
  std::vector<int> truth_;
};

TEST_F(SelectionTest, AClassIsFoundWithCleanEdges) {
  EXPECT_LE(wrong(select("pillow"), small_room::kPillow), 4u);
  EXPECT_LE(wrong(select("floor"), small_room::kFloor), 12u);
}

TEST_F(SelectionTest, ObjectsAreNumberedLargestFirst) {
  const std::vector<Instance> objects = list_instances(room_.gaussians.model, room_.gaussians.labels);
  EXPECT_EQ(objects_text(objects, room_.labels), "floor#1, box#1, pillow#1, pillow#2");
  EXPECT_LT(objects[2].centre.x, 0) << "the large pillow lies at x = -0.56";
  EXPECT_GT(objects[3].centre.x, 0);
  EXPECT_GT(objects[2].gaussians, objects[3].gaussians);
}

TEST_F(SelectionTest, OneObjectOfTwo) {
  const GaussianSelection second = select("pillow#2");
  ASSERT_EQ(second.objects.size(), 1u);
  EXPECT_EQ(second.objects[0].instance, 2);
  for (size_t i = 0; i < second.mask.size(); ++i) {
    if (second.mask[i]) {
      EXPECT_GT(room_.gaussians.model.positions[3 * i], 0.3f);
    }
  }
  EXPECT_EQ(select("pillow").count, select("pillow#1").count + second.count);
}

TEST_F(SelectionTest, EverythingButTheFloor) {
  const GaussianSelection s = select("everything but floor");
  EXPECT_NEAR(static_cast<double>(s.count), static_cast<double>(select("pillow, box").count), 12);
}

TEST_F(SelectionTest, ALoneSpeckOfAnotherClassIsCleanedAway) {
  GaussianModel model = room_.gaussians.model;
  const size_t middle = model.size() - 1;  // of the floor
  model.semantics[150 * middle + small_room::kFloor] = 0;
  model.semantics[150 * middle + small_room::kPillow] = 8;
  const LabelledGaussians speckled = label_objects(model, room_.labels, small_room::kExtent, pool_);
  const GaussianSelection s =
      select_gaussians(speckled, parse_selection("pillow", Vocabulary(room_.labels)), {}, room_.labels, {}, pool_);
  EXPECT_FALSE(s.mask[middle]);
}

TEST_F(SelectionTest, ASpeckIsSelectedByItsOwnName) {
  const size_t middle = room_.gaussians.model.size() - 1;  // of the floor
  room_.gaussians.labels.label[middle] = small_room::kPillow;
  room_.gaussians.labels.instance[middle] = 3;
  const GaussianSelection s = select("pillow#3");
  EXPECT_EQ(s.count, 1u);
  EXPECT_TRUE(s.mask[middle]);
}

TEST_F(SelectionTest, CrumbsOfAClassWithoutAnObjectAreNotMeant) {
  for (size_t i = 0; i < room_.gaussians.labels.label.size(); ++i) {
    if (room_.gaussians.labels.label[i] == small_room::kBox) room_.gaussians.labels.instance[i] = 0;
  }
  EXPECT_THROW(select("box"), Error);
}

TEST_F(SelectionTest, ThresholdsSelectByProbability) {
  const size_t argmax = select("pillow").count;
  EXPECT_NEAR(static_cast<double>(select("pillow", "auto").count), static_cast<double>(argmax), 10);
  EXPECT_GE(select("pillow", "0.05").count, select("pillow", "0.95").count);
  EXPECT_GT(select("pillow", "auto").threshold, 0.01);
}

TEST_F(SelectionTest, NothingSelectedSaysWhatThereIs) {
  try {
    select("car");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.details().remedy, HasSubstr("pillow#2"));
  }
  EXPECT_THROW(select("pillow#3"), Error);
}

TEST_F(SelectionTest, AnyNumberOfThreadsGivesTheSame) {
  ThreadPool one(1), three(3);
  const LabelledGaussians a = label_objects(room_.gaussians.model, room_.labels, 0, one);
  const LabelledGaussians b = label_objects(room_.gaussians.model, room_.labels, 0, three);
  EXPECT_EQ(a.labels.label, b.labels.label);
  EXPECT_EQ(a.labels.instance, b.labels.instance);
  EXPECT_EQ(a.soft.probability, b.soft.probability);
}

TEST_F(SelectionTest, WithoutSemanticsOnlyNamesAreRefused) {
  GaussianModel model = room_.gaussians.model;
  model.semantic_channels = 0;
  model.semantics.clear();
  const LabelledGaussians room = label_objects(model, room_.labels, 0, pool_);
  EXPECT_FALSE(room.has_labels());
  EXPECT_TRUE(list_instances(room.model, room.labels).empty());
  const auto select = [&](const std::string& text) {
    return select_gaussians(room, parse_selection(text, Vocabulary(room_.labels)), {}, room_.labels, {}, pool_);
  };
  EXPECT_EQ(select("everything").count, model.size());
  for (const char* named : {"pillow", "everything but floor"}) {
    try {
      select(named);
      ADD_FAILURE() << named;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_NE(std::string(error.what()).find("trained without semantics"), std::string::npos);
    }
  }
}

TEST_F(SelectionTest, DegenerateRoomsHaveADefinedAnswer) {
  GaussianModel untaught = room_.gaussians.model;
  std::fill(untaught.semantics.begin(), untaught.semantics.end(), 0.f);
  EXPECT_TRUE(list_instances(untaught, label_objects(untaught, room_.labels, 0, pool_).labels).empty());
  GaussianModel heap = room_.gaussians.model;  // all in one place
  std::fill(heap.positions.begin(), heap.positions.end(), 1.f);
  EXPECT_NO_THROW(label_objects(heap, room_.labels, 0, pool_));
  GaussianModel none;
  none.semantic_channels = 150;
  EXPECT_NO_THROW(label_objects(none, room_.labels, 0, pool_));
}

TEST(Otsu, SplitsTwoGroups) {
  std::vector<float> values(100, 0.1f);
  values.insert(values.end(), 60, 0.8f);
  EXPECT_GT(otsu_threshold(values), 0.1);
  EXPECT_LE(otsu_threshold(values), 0.8);
  EXPECT_DOUBLE_EQ(otsu_threshold({}), 0.5);
  EXPECT_DOUBLE_EQ(otsu_threshold({0.3f, 0.3f}), 0.5);
}

}  // namespace
}  // namespace aligngs
