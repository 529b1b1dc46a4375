#include "priors/colmap_options.h"

#include <iterator>

#include "core/log.h"
#include "io/text_tokens.h"

namespace aligngs {

ColmapOptions::ColmapOptions(std::string_view help) {
  constexpr std::string_view kDashes = "--";
  for (std::string_view word = take_word(help); !word.empty(); word = take_word(help)) {
    if (word.substr(0, kDashes.size()) == kDashes) names_.emplace(word.substr(kDashes.size()));
  }
}

void ColmapOptions::add(std::vector<std::string>& arguments, std::initializer_list<const char*> names,
                        const std::string& value) const {
  for (const char* const name : names) {
    const bool oldest = name == *std::prev(names.end());
    if (!knows(name) && !(names_.empty() && oldest)) continue;
    arguments.push_back(std::string("--") + name);
    arguments.push_back(value);
    return;
  }
  log_debug("this COLMAP has no option {}", *names.begin());
}

}  // namespace aligngs
