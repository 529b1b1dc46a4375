#include "io/foreign_content.h"

#include <gmock/gmock.h>

#include <functional>
#include <string>
#include <utility>

#include "core/error.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "io/ply.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    return error.what();
  }
  return "no error";
}

const std::pair<const char*, const char*> kForeign[] = {
    {"", "the file is empty"},
    {"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", "git lfs pull"},
    {"\n<!DOCTYPE HTML><html>sign in</html>", "a web page"},
};

TEST(ForeignContent, IsNamedByPicturesMapsAndClouds) {
  for (const auto& [bytes, named] : kForeign) {
    const auto& content = bytes;  // clang 14 captures no structured binding
    EXPECT_THAT(message_of([&] { decode_image(content, "a.png"); }), HasSubstr(named));
    EXPECT_THAT(message_of([&] { decode_npy(content, "a.npy"); }), HasSubstr(named));
    EXPECT_THAT(message_of([&] { decode_ply(content, "a.ply"); }), HasSubstr(named));
  }
}

TEST(ForeignContent, OtherContentIsLeftToTheReader) {
  EXPECT_EQ(message_of([] { refuse_foreign_content("ply\n", "a.ply"); }), "no error");
}

}  // namespace
}  // namespace aligngs
