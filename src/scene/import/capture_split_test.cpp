#include "scene/import/capture_split.h"

#include <gmock/gmock.h>

#include <numeric>

#include "core/log.h"
#include "core/testing/error.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

/// Cameras in a row, each with a photo called by its number.
class SplitOfCapture : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "split_of_capture";
    fs::create_directories(folder_);
    write_png(folder_ / "photo.png", Image<uint8_t>(32, 24, 3, 90));
    take(10);
  }
  void take(int frames) {
    capture_.folder = folder_;
    capture_.frames.clear();
    for (int i = 0; i < frames; ++i) {
      CapturedFrame frame;
      frame.name = std::to_string(i);
      frame.image = folder_ / "photo.png";
      frame.camera = pinhole_camera(30, 30, 16, 12, 32, 24);
      frame.world_to_camera.translation = {-0.1 * i, 0, 0};
      capture_.frames.push_back(frame);
    }
  }
  CaptureSplit split(const ImportOptions& options) const {
    ThreadPool pool(1);
    return split_capture(capture_, options, pool);
  }
  static std::vector<int> all_of(const CaptureSplit& split) {
    std::vector<int> frames = split.train;
    frames.insert(frames.end(), split.test.begin(), split.test.end());
    std::sort(frames.begin(), frames.end());
    return frames;
  }
  fs::path folder_;
  Capture capture_;
};

TEST_F(SplitOfCapture, FramesTrainThatNoTestListHas) {
  ImportOptions options;
  options.test_names = {"2", "5"};
  const CaptureSplit frames = split(options);
  EXPECT_THAT(frames.train, ElementsAre(0, 1, 3, 4, 6, 7, 8, 9));
  EXPECT_THAT(frames.test, ElementsAre(2, 5));
}

TEST_F(SplitOfCapture, ATestListAloneGivesNoWarning) {
  ImportOptions options;
  options.test_names = {"2", "5"};
  testing::internal::CaptureStderr();
  split(options);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(SplitOfCapture, ANumberOfTestViewsAloneIsHeldOut) {
  ImportOptions options;
  options.test_views = 3;
  const CaptureSplit frames = split(options);
  EXPECT_THAT(frames.test, SizeIs(3));
  EXPECT_THAT(frames.train, SizeIs(7));
  EXPECT_EQ(all_of(frames).size(), 10u);
}

TEST_F(SplitOfCapture, HeldOutViewsAreSpreadOverTheCapture) {
  ImportOptions options;
  options.test_views = 2;
  const std::vector<int> test = split(options).test;
  ASSERT_THAT(test, SizeIs(2));
  EXPECT_LT(test[0], 5);
  EXPECT_GE(test[1], 5);
}

TEST_F(SplitOfCapture, TwoViewsMustBeLeftForTraining) {
  ImportOptions options;
  options.test_views = 9;
  EXPECT_THAT(
      error_of(ErrorKind::kUsage, [&] { split(options); }),
      AllOf(HasSubstr("--test-views 9 leaves fewer than 2 of 10 frames"), HasSubstr("--test-views 8 or fewer")));
}

TEST_F(SplitOfCapture, AStrideThatLeavesOneViewIsRefusedWithTheLargestThatLeavesTwo) {
  ImportOptions options;
  options.stride = 100;
  EXPECT_THAT(
      error_of(ErrorKind::kBadInput, [&] { split(options); }),
      AllOf(HasSubstr("--stride 100: this leaves 1 of 10 frames for training"), HasSubstr("use --stride 9 or less")));
}

TEST_F(SplitOfCapture, TheRemedyOfAStrideCountsTestViews) {
  ImportOptions options;
  options.stride = 9;
  options.test_names = {"9", "8", "7"};
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { split(options); }), HasSubstr("use --stride 6 or less"));
}

TEST_F(SplitOfCapture, OneViewThatIsAskedForIsRefused) {
  ImportOptions options;
  options.views = 1;
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { split(options); }),
              AllOf(HasSubstr("--views 1: this leaves 1 of 10 frames"), HasSubstr("use --views 2 or more")));
}

TEST_F(SplitOfCapture, OneTrainingNameIsRefused) {
  ImportOptions options;
  options.train_names = {"3", "3.png"};
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { split(options); }), HasSubstr("--train: this leaves 1 of 10"));
}

TEST_F(SplitOfCapture, TestNamesThatLeaveOneViewAreRefused) {
  take(3);
  ImportOptions options;
  options.test_names = {"1", "2"};
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { split(options); }), HasSubstr("--test: this leaves 1 of 3 frames"));
}

TEST_F(SplitOfCapture, AnOwnListOfOneTrainingViewIsRefused) {
  capture_.train = {"4"};
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { split({}); }),
              HasSubstr("the training list of the capture: this leaves 1 of 10 frames"));
}

TEST_F(SplitOfCapture, AnOwnTestListThatLeavesOneViewIsRefused) {
  take(2);
  capture_.test = {"1"};
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { split({}); }),
              HasSubstr("the test list of the capture: this leaves 1 of 2 frames"));
}

TEST_F(SplitOfCapture, FramesOfTheOwnListThatWereLeftOutAreTheReason) {
  capture_.train = {"4", "gone"};
  capture_.left_out = {{"gone", "the photo is missing", "add the photo"}};
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { split({}); }),
              AllOf(HasSubstr("gone (the photo is missing)"), HasSubstr("add the photo")));
}

TEST_F(SplitOfCapture, ASingleFrameTrainsAlone) {
  take(1);
  EXPECT_THAT(split({}).train, ElementsAre(0));
}

TEST_F(SplitOfCapture, ANameThatIsTwiceInAListCountsOnce) {
  ImportOptions options;
  options.train_names = {"1", "2", "1", "2.jpg"};
  options.test_names = {"3", "3"};
  const CaptureSplit frames = split(options);
  EXPECT_THAT(frames.train, ElementsAre(1, 2));
  EXPECT_THAT(frames.test, ElementsAre(3));
}

TEST_F(SplitOfCapture, ANameThatIsTwiceGivesNoWarning) {
  capture_.test = {"3", "3"};
  testing::internal::CaptureStderr();
  EXPECT_THAT(split({}).test, ElementsAre(3));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(SplitOfCapture, WithoutOptionsAllTrain) { EXPECT_THAT(split({}).train, SizeIs(10)); }

TEST_F(SplitOfCapture, AListAndANumberOfTestViewsContradictEachOther) {
  ImportOptions options;
  options.test_names = {"2"};
  options.test_views = 3;
  EXPECT_THAT(error_of(ErrorKind::kUsage, [&] { split(options); }), HasSubstr("only one of --test and --test-views"));
}

TEST_F(SplitOfCapture, AStrideLeavesTheTestListOut) {
  ImportOptions options;
  options.stride = 3;
  options.test_names = {"6"};
  EXPECT_THAT(split(options).train, ElementsAre(0, 3, 9));
}

TEST_F(SplitOfCapture, ViewsAreChosenAmongFramesThatNoTestListHas) {
  ImportOptions options;
  options.views = 8;
  options.test_names = {"2", "5"};
  EXPECT_THAT(split(options).train, ElementsAre(0, 1, 3, 4, 6, 7, 8, 9));
}

TEST_F(SplitOfCapture, AFrameOfBothListsTrains) {
  set_log_level(LogLevel::kSilent);
  ImportOptions options;
  options.train_names = {"1", "2"};
  options.test_names = {"2", "3"};
  const CaptureSplit frames = split(options);
  set_log_level(LogLevel::kInfo);
  EXPECT_THAT(frames.train, ElementsAre(1, 2));
  EXPECT_THAT(frames.test, ElementsAre(3));
}

TEST_F(SplitOfCapture, TheOwnTestListIsThinnedToTheNumber) {
  capture_.test = {"1", "3", "5", "7"};
  ImportOptions options;
  options.test_views = 2;
  const CaptureSplit frames = split(options);
  EXPECT_THAT(frames.test, ElementsAre(3, 7));
  EXPECT_THAT(frames.train, ElementsAre(0, 2, 4, 6, 8, 9));
}

TEST_F(SplitOfCapture, FewFramesOfManyAreHeldOutOfTheOthers) {
  take(kMaxUnselected + 20);
  ImportOptions options;
  options.test_views = 5;
  set_log_level(LogLevel::kSilent);
  const CaptureSplit frames = split(options);
  set_log_level(LogLevel::kInfo);
  EXPECT_THAT(frames.train, SizeIs(kDefaultViews));
  EXPECT_THAT(frames.test, SizeIs(5));
}

TEST_F(SplitOfCapture, TestViewsThatNoFrameIsLeftForAreTold) {
  ImportOptions options;
  options.views = 8;
  options.test_views = 5;
  testing::internal::CaptureStderr();
  split(options);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("2 of 5 test views: no other frame is left"));
}

}  // namespace
}  // namespace aligngs
