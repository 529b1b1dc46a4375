#include "edit/up_axis.h"

#include "core/error.h"

namespace aligngs {

UpAxis parse_axis(const std::string& text) {
  if (const std::optional<UpAxis> axis = choice_named<UpAxis>(text)) return *axis;
  throw_usage("\"" + text.substr(0, 40) + "\" is no axis", "give " + joined_words<UpAxis>(", ", " or "));
}

Vec3d direction_of(UpAxis axis) {
  const std::string_view word = word_of(axis);
  Vec3d out;
  out[word.back() - 'x'] = word.front() == '-' ? -1 : 1;
  return out;
}

}  // namespace aligngs
