#include "priors/test_photos.h"

#include <gmock/gmock.h>

#include "core/testing/error.h"

namespace aligngs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(TestPhotos, EnoughPhotosAreLeftForTraining) {
  require_training_photos("photos", 3, 3);
  require_training_photos("photos", 4, 2);
  require_training_photos("photos", 40, 8);
}

TEST(TestPhotos, WithoutTestPhotosAnyNumberTrains) { require_training_photos("photos", 1, 0); }

TEST(TestPhotos, OneTrainingPhotoOfThreeIsRefusedWithTheSmallestNumberThatIsEnough) {
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [] { require_training_photos("photos", 3, 2); }),
              AllOf(HasSubstr("--test-every 2: this leaves 1 of 3 photos for training"),
                    HasSubstr("use --test-every 3 or more")));
}

TEST(TestPhotos, NoTrainingPhotoIsRefused) {
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [] { require_training_photos("photos", 5, 1); }),
              AllOf(HasSubstr("0 of 5 photos"), HasSubstr("use --test-every 2 or more")));
}

TEST(TestPhotos, TwoPhotosLeaveNoneForTesting) {
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [] { require_training_photos("photos", 2, 8); }),
              HasSubstr("leave --test-every out"));
}

}  // namespace
}  // namespace aligngs
