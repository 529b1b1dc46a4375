#include "io/left_out.h"

#include <algorithm>

#include "core/log.h"
#include "io/text_encoding.h"

namespace aligngs {

LeftOut left_out_for(const std::string& name, const Error& error) {
  const Error::Details& d = error.details();
  // With its folder: photos, depth and labels of a view often bear one name.
  std::string where = as_utf8((d.path.parent_path().filename() / d.path.filename()).string());
  if (!d.field.empty()) where += (where.empty() ? "" : ", ") + d.field;
  return {as_utf8(name), where.empty() ? d.message : where + ": " + d.message, d.remedy};
}

std::string summary_of(size_t kept, const std::vector<LeftOut>& left_out, const char* what) {
  constexpr size_t kNamed = 10;  // enough to see the pattern; each has a line of its own
  std::string text = fmt::format("{} of {} {}", kept, kept + left_out.size(), what);
  for (size_t i = 0; i < std::min(left_out.size(), kNamed); ++i) {
    text += fmt::format("{}{} ({})", i == 0 ? "; left out: " : ", ", left_out[i].name, left_out[i].reason);
  }
  if (left_out.size() > kNamed) text += fmt::format(" and {} more", left_out.size() - kNamed);
  return text;
}

void warn_left_out(size_t kept, const std::vector<LeftOut>& left_out, const char* what) {
  if (left_out.empty()) return;
  for (const LeftOut& frame : left_out) log_warning("left out: {}: {}", frame.name, frame.reason);
  log_warning("{}", summary_of(kept, left_out, what));
}

void require_enough(const std::filesystem::path& folder, size_t kept, const std::vector<LeftOut>& left_out,
                    size_t fewest, bool strict, const char* what) {
  if (left_out.empty() || (kept >= fewest && !strict)) return;
  const auto with_remedy =
      std::find_if(left_out.begin(), left_out.end(), [](const LeftOut& f) { return !f.remedy.empty(); });
  std::string remedy = with_remedy == left_out.end() ? "correct these frames" : with_remedy->remedy;
  if (kept >= fewest) remedy += "; without --strict the others are used";
  throw_bad_input(folder, what, summary_of(kept, left_out, what), remedy);
}

}  // namespace aligngs
