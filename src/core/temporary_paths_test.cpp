#include "core/temporary_paths.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

namespace fs = std::filesystem;

TEST(TemporaryPaths, ASuffixGoesToTheEndOfTheName) {
  EXPECT_EQ(temporary_beside("a/scene.ply", ".tmp-7"), fs::path("a/scene.ply.tmp-7"));
}

TEST(TemporaryPaths, LongNamesAreCutToWhatFileSystemsTake) {
  const fs::path path = fs::path("folder") / std::string(255, 'n');
  const std::string name = temporary_beside(path, ".tmp-7").filename().string();
  EXPECT_EQ(name, std::string(249, 'n') + ".tmp-7");
}

TEST(TemporaryPaths, NoCharacterIsCutInTwo) {
  std::string name(248, 'n');
  for (int i = 0; i < 3; ++i) name += "\u00e9";  // two bytes each: 254 in all
  EXPECT_EQ(temporary_beside(name, ".tmp-7").string(), std::string(248, 'n') + ".tmp-7");
}

}  // namespace
}  // namespace aligngs
