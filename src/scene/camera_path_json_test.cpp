#include "scene/camera_path_json.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

std::string file_of(const std::string& keys) {
  return "{\"format\": \"aligngs camera path\", \"version\": 1, \"keys\": " + keys + "}";
}

std::string fault_of(const std::string& text) {
  try {
    parse_camera_path(text, "keys.json");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    return error.what();
  }
  return "no fault";
}

TEST(CameraPathJson, ReadsWhatItWrites) {
  const CameraPath path{{{0, {0.1, -2, 3}, {4, 5, 6}, 45.5}, {2.25, {1, 1, 1}, {0, 0, 0}, 62}}};
  const CameraPath back = parse_camera_path(camera_path_json(path), "keys.json");
  ASSERT_EQ(back.keys.size(), 2u);
  EXPECT_EQ(back.keys[0].eye.x, 0.1);
  EXPECT_EQ(back.keys[0].fov, 45.5);
  EXPECT_EQ(back.keys[1].time, 2.25);
}

TEST(CameraPathJson, FieldOfViewMayBeAbsent) {
  EXPECT_EQ(parse_camera_path(file_of("[{\"time\": 0, \"eye\": [0,0,0], \"target\": [1,0,0]}]"), "").keys[0].fov,
            CameraKey().fov);
}

TEST(CameraPathJson, NamesTheFieldOfEveryFault) {
  const std::string good = "{\"time\": 1, \"eye\": [0,0,0], \"target\": [1,0,0]}";
  const std::pair<std::string, const char*> faults[] = {
      {"", "no JSON object"},
      {"[]", "no JSON object"},
      {"{\"version\": 1, \"keys\": []}", "format"},
      {"{\"format\": \"aligngs camera path\", \"version\": 2, \"keys\": []}", "version"},
      {file_of("{}"), "keys"},
      {file_of("[]"), "1 to 1000"},
      {file_of("[7]"), "keys[0]"},
      {file_of("[{\"eye\": [0,0,0], \"target\": [1,0,0]}]"), "keys[0].time"},
      {file_of("[{\"time\": -1, \"eye\": [0,0,0], \"target\": [1,0,0]}]"), "keys[0].time"},
      {file_of("[{\"time\": 0, \"eye\": [0,0], \"target\": [1,0,0]}]"), "keys[0].eye"},
      {file_of("[{\"time\": 0, \"eye\": [0,0,NaN], \"target\": [1,0,0]}]"), "keys[0].eye"},
      {file_of("[{\"time\": 0, \"eye\": [0,0,1e9], \"target\": [1,0,0]}]"), "keys[0].eye"},
      {file_of("[{\"time\": 0, \"eye\": [1,0,0], \"target\": [1,0,0]}]"), "keys[0].target"},
      {file_of("[{\"time\": 0, \"eye\": [0,0,0], \"target\": [1,0,0], \"fov\": 0}]"), "keys[0].fov"},
      {file_of("[" + good + "," + good + "]"), "keys[1].time"},
  };
  for (const auto& [text, told] : faults) EXPECT_THAT(fault_of(text), HasSubstr(told)) << text;
}

TEST(CameraPathJson, CutAtAnyByteIsRefused) {
  const std::string whole = camera_path_json({{{0, {0, 0, 0}, {1, 0, 0}, 60}, {1, {0, 1, 0}, {1, 0, 0}, 60}}});
  for (size_t i = 0; i + 2 < whole.size(); ++i) EXPECT_NE(fault_of(whole.substr(0, i)), "no fault") << i;
}

}  // namespace
}  // namespace aligngs
