#include "synth/label_controls.h"

#include <algorithm>
#include <numeric>

#include "core/half.h"

namespace aligngs {
namespace {

constexpr float kConstantScore = 0.9f;  // in the middle of what the simulated teacher gives its first class

void make_constant(ScoreMap& map) {
  std::fill(map.values.begin(), map.values.end(), float_to_half(0));
  const std::ptrdiff_t pixels = static_cast<std::ptrdiff_t>(map.width) * map.height;
  std::fill(map.values.begin(), map.values.begin() + pixels, float_to_half(kConstantScore));
}

void rename_classes(ScoreMap& map, Random& random) {
  std::vector<size_t> name(static_cast<size_t>(map.channels));
  std::iota(name.begin(), name.end(), size_t(0));
  random.shuffle(name);
  const size_t pixels = static_cast<size_t>(map.width) * static_cast<size_t>(map.height);
  const std::vector<uint16_t> before = map.values;
  for (size_t c = 0; c < name.size(); ++c) {
    std::copy_n(before.begin() + static_cast<std::ptrdiff_t>(c * pixels), pixels,
                map.values.begin() + static_cast<std::ptrdiff_t>(name[c] * pixels));
  }
}

}  // namespace

const char* label_teacher_name(LabelTeacher teacher) {
  switch (teacher) {
    case LabelTeacher::kTrue:
      return "true";
    case LabelTeacher::kConstant:
      return "constant";
    case LabelTeacher::kShuffled:
      return "shuffled";
    case LabelTeacher::kTeacher:
      break;
  }
  return "teacher";
}

void apply_label_control(LabelTeacher teacher, std::vector<ScoreMap>& scores, Random random) {
  for (ScoreMap& map : scores) {
    if (map.values.empty()) continue;
    if (teacher == LabelTeacher::kConstant) make_constant(map);
    if (teacher == LabelTeacher::kShuffled) rename_classes(map, random);
  }
}

}  // namespace aligngs
