#include "priors/colmap_options.h"

#include <gmock/gmock.h>

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kOld =
    "Options can either be specified via command-line or\n  -h [ --help ]\n  --SiftExtraction.use_gpu arg (=1)\n";
constexpr const char* kNew =
    "  --FeatureExtraction.use_gpu arg (=1)\n  --SiftExtraction.max_num_features arg (=8192)\n";

std::vector<std::string> gpu_arguments(const char* help) {
  std::vector<std::string> arguments;
  ColmapOptions(help).add(arguments, {"FeatureExtraction.use_gpu", "SiftExtraction.use_gpu"}, "0");
  return arguments;
}

TEST(ColmapOptions, TheNameThatTheProgramKnowsIsUsed) {
  EXPECT_THAT(gpu_arguments(kOld), ElementsAre("--SiftExtraction.use_gpu", "0"));
  EXPECT_THAT(gpu_arguments(kNew), ElementsAre("--FeatureExtraction.use_gpu", "0"));
}

TEST(ColmapOptions, AnOptionUnderNoKnownNameIsLeftOut) {
  EXPECT_THAT(gpu_arguments("  --Mapper.num_threads arg\n"), IsEmpty());
}

TEST(ColmapOptions, WithoutAnyHelpTheOldestNameIsTried) {
  EXPECT_THAT(gpu_arguments(""), ElementsAre("--SiftExtraction.use_gpu", "0"));
}

}  // namespace
}  // namespace aligngs
