#include "io/left_out.h"

#include <gmock/gmock.h>

namespace aligngs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::vector<LeftOut> kTwo = {{"a", "the photo is missing", "copy it"}, {"b", "the pose is not finite", ""}};

TEST(LeftOut, IsSummedUp) {
  EXPECT_EQ(summary_of(54, kTwo), "54 of 56 frames; left out: a (the photo is missing), b (the pose is not finite)");
  EXPECT_EQ(summary_of(3, {}), "3 of 3 frames");
}

TEST(LeftOut, ManyAreCounted) {
  EXPECT_THAT(summary_of(1, std::vector<LeftOut>(25, kTwo[0])),
              AllOf(HasSubstr("1 of 26"), HasSubstr("and 22 more (the photo is missing)")));
}

TEST(LeftOut, OneFaultOfAllIsToldOnce) {
  std::vector<LeftOut> frames;
  for (const char* name : {"a", "b", "c", "d"}) {
    use_or_leave_out(name, frames, [&] {
      throw_bad_input(std::string("photos/") + name + ".jpg", "camera 1", "a panorama is no pinhole view", "cut it");
    });
  }
  EXPECT_EQ(summary_of(0, frames), "0 of 4 frames; left out: all (camera 1: a panorama is no pinhole view)");
  EXPECT_EQ(summary_of(3, frames),
            "3 of 7 frames; left out: a, b, c and 1 more (camera 1: a panorama is no pinhole view)");
  frames.push_back(kTwo[0]);
  EXPECT_EQ(summary_of(0, frames),
            "0 of 5 frames; left out: a, b, c and 1 more (camera 1: a panorama is no pinhole view), a (the photo is "
            "missing)");
}

TEST(LeftOut, OneFaultWithOtherNumbersIsToldOnce) {
  std::vector<LeftOut> frames;
  for (const char* name : {"a", "b", "c", "d"})
    frames.push_back({name, "t.json, frames[" + std::to_string(8 + frames.size()) + "].pose: not finite", ""});
  EXPECT_EQ(summary_of(0, frames), "0 of 4 frames; left out: all (such as: t.json, frames[8].pose: not finite)");
  EXPECT_EQ(summary_of(1, frames),
            "1 of 5 frames; left out: a, b, c and 1 more (such as: t.json, frames[8].pose: not finite)");
}

TEST(LeftOut, AFaultWithOtherNumbersNamesTheFileOfTheFirst) {
  std::vector<LeftOut> frames;
  for (const char* name : {"a", "b", "c"})
    frames.push_back(
        {name, std::string("depth/") + name + ".npy, values: " + std::to_string(frames.size()) + " nan", ""});
  EXPECT_EQ(summary_of(0, frames), "0 of 3 frames; left out: all (such as: depth/a.npy, values: 0 nan)");
}

TEST(LeftOut, BadInputOfOneFrameLeavesItOut) {
  std::vector<LeftOut> left_out;
  EXPECT_FALSE(use_or_leave_out("a", left_out, [] {
    throw_bad_input("photos/a.jpg", "JPEG data", "the picture is truncated", "copy it again");
  }));
  EXPECT_TRUE(use_or_leave_out("b", left_out, [] {}));
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_EQ(left_out[0].reason, "photos/a.jpg, JPEG data: the picture is truncated");
  EXPECT_THROW(use_or_leave_out("c", left_out, [] { throw_resources("disk", "full"); }), Error);
}

TEST(LeftOut, TooFewOrStrictIsAnError) {
  EXPECT_NO_THROW(require_enough("d", 2, kTwo, 2, false));
  EXPECT_NO_THROW(require_enough("d", 1, {}, 2, false));  // nothing was left out: there never were more
  EXPECT_THROW(require_enough("d", 1, kTwo, 2, false), Error);
  EXPECT_THROW(require_enough("d", 9, kTwo, 2, true), Error);
}

/// Files of every view with one fault, in this folder.
std::vector<LeftOut> views_without(const std::string& folder, const std::string& extension) {
  std::vector<LeftOut> views;
  for (const char* name : {"a", "b", "c"}) {
    use_or_leave_out(name, views, [&] {
      throw_bad_input("scene/" + folder + "/" + name + extension, "", "the file is empty", "x");
    });
  }
  return views;
}

TEST(LeftOut, AMaskIsNamedWithItsFolder) {
  EXPECT_EQ(summary_of(0, views_without("masks", ".png"), "views"),
            "0 of 3 views; left out: all (such as: masks/a.png: the file is empty)");
}

TEST(LeftOut, ADepthMapIsNamedWithItsFolder) {
  EXPECT_EQ(summary_of(0, views_without("pred_depths", ".npy"), "views"),
            "0 of 3 views; left out: all (such as: pred_depths/a.npy: the file is empty)");
}

TEST(LeftOut, AViewInASubfolderHasTheFolderOfItsMask) {
  std::vector<LeftOut> views;
  use_or_leave_out("left/1", views, [] { throw_bad_input("scene/masks/left/1.png", "", "the file is empty", "x"); });
  EXPECT_EQ(views.at(0).reason, "masks/left/1.png: the file is empty");
}

TEST(LeftOut, ANameThatIsTooLongIsShortened) {
  const std::string name(5000, 'x');
  EXPECT_LT(summary_of(1, {{name, "the photo " + name + " is missing", ""}}).size(), 500u);
}

TEST(LeftOut, AShortenedNameHasWholeLetters) {
  std::string name;
  for (int i = 0; i < 300; ++i) name += "\xc3\xbc";
  const std::string text = summary_of(1, {{"y" + name, "the photo is missing", ""}});
  EXPECT_EQ(text.find("\xef\xbf\xbd"), std::string::npos) << text;
}

}  // namespace
}  // namespace aligngs
