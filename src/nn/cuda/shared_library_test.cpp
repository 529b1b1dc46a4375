#include "nn/cuda/shared_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aligngs::cuda {
namespace {

using testing::HasSubstr;

const char* const kMissing = "libaligngs-has-no-such-library.so.7";
const char* const kPresent = "libm.so.6";  // every program here is linked with it

std::string nothing_against(const SharedLibrary&) { return {}; }

TEST(SharedLibrary, TheFirstThatCanBeLoadedServes) {
  const LibrarySearch search = find_library({kMissing, kPresent}, nothing_against);
  ASSERT_NE(search.loaded, nullptr);
  EXPECT_EQ(search.loaded->name(), kPresent);
  EXPECT_EQ(search.reason, "");
}

TEST(SharedLibrary, FunctionsAreFoundByNameAndType) {
  const LibrarySearch search = find_library({kPresent}, nothing_against);
  ASSERT_NE(search.loaded, nullptr);
  double (*square_root)(double) = nullptr;
  ASSERT_TRUE(search.loaded->find("sqrt", square_root));
  EXPECT_EQ(square_root(9.0), 3.0);
  void (*none)() = nullptr;
  EXPECT_FALSE(search.loaded->find("aligngs_has_no_such_function", none));
  EXPECT_EQ(none, nullptr);
}

TEST(SharedLibrary, AMissingOneIsNoErrorButAReasonThatNamesIt) {
  const LibrarySearch search = find_library({kMissing}, nothing_against);
  EXPECT_EQ(search.loaded, nullptr);
  EXPECT_THAT(search.reason, HasSubstr(kMissing));
}

TEST(SharedLibrary, ARefusedOneIsAsGoodAsMissing) {
  const LibrarySearch search =
      find_library({kPresent, kMissing}, [](const SharedLibrary&) { return std::string("it is too old"); });
  EXPECT_EQ(search.loaded, nullptr);
  EXPECT_THAT(search.reason, HasSubstr(std::string(kPresent) + ": it is too old; "));
  EXPECT_THAT(search.reason, HasSubstr(kMissing));
}

TEST(SharedLibrary, OnlyTheMajorVersionMustBeThatOfTheHeaders) {
  EXPECT_EQ(version_refusal(130100, 13), "");
  EXPECT_EQ(version_refusal(139901, 13), "");
  EXPECT_EQ(version_refusal(120103, 13), "it is version 12.1, and this program needs 13");
  EXPECT_NE(version_refusal(140000, 13), "");
}

}  // namespace
}  // namespace aligngs::cuda
