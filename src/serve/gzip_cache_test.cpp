#include "serve/gzip_cache.h"

#include <gtest/gtest.h>

#include "io/gzip.h"

namespace aligngs {
namespace {

std::string expanded(const GzipCache::Stream& stream) { return gzip_expanded(*stream, "test", 1 << 20); }

TEST(GzipCache, ATextIsCompressedOnce) {
  GzipCache cache(1000);
  EXPECT_EQ(cache.find("report.html", "1"), nullptr);
  const GzipCache::Stream made = cache.add("report.html", "1", std::string(5000, 'x'));
  EXPECT_EQ(cache.find("report.html", "1"), made);
  EXPECT_EQ(expanded(made), std::string(5000, 'x'));
}

TEST(GzipCache, ANewVersionTakesThePlaceOfTheOld) {
  GzipCache cache(1000);
  cache.add("a", "1", "old");
  cache.add("a", "2", "new");
  EXPECT_EQ(cache.find("a", "1"), nullptr);
  EXPECT_EQ(expanded(cache.find("a", "2")), "new");
}

TEST(GzipCache, TheOldestGoWhenTheLimitIsReached) {
  GzipCache cache(60);  // a short stream has about 25 bytes
  for (const char* name : {"a", "b", "c"}) cache.add(name, "1", name);
  EXPECT_LE(cache.bytes(), 60u);
  EXPECT_EQ(cache.find("a", "1"), nullptr);
  EXPECT_NE(cache.find("c", "1"), nullptr);
}

}  // namespace
}  // namespace aligngs
