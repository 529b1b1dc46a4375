#include "io/left_out.h"

#include <algorithm>
#include <map>

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

namespace {

/// The reason without the file's name where that is the frame's own: what frames with the same fault have in common.
std::string fault_of(const LeftOut& frame) {
  const size_t end = frame.reason.find_first_of(",:");
  if (end == std::string::npos || end + 2 > frame.reason.size()) return frame.reason;
  const std::filesystem::path file(frame.reason.substr(0, end)), name(frame.name);
  const bool own = file.stem() == name.stem() || file.stem() == name.filename();
  return own ? frame.reason.substr(end + 2) : frame.reason;
}

/// The fault with each number as one sign: "frames[0].transform_matrix" and "frames[1].transform_matrix" are alike.
std::string kind_of_fault(const LeftOut& frame) {
  std::string kind;
  for (const char c : fault_of(frame)) {
    const bool digit = c >= '0' && c <= '9';
    if (!digit) kind += c;
    if (digit && !kind.ends_with('#')) kind += '#';
  }
  return kind;
}

/// Frames with the same kind of fault, each group in the order of its first.
std::vector<std::vector<const LeftOut*>> grouped(const std::vector<LeftOut>& left_out) {
  std::vector<std::vector<const LeftOut*>> groups;
  std::map<std::string, size_t> places;
  for (const LeftOut& frame : left_out) {
    const auto [place, fresh] = places.try_emplace(kind_of_fault(frame), groups.size());
    if (fresh) groups.emplace_back();
    groups[place->second].push_back(&frame);
  }
  return groups;
}

/// "a, b, c and 7 more (the photo is missing)"
std::string told_together(const std::vector<const LeftOut*>& group, bool all) {
  constexpr size_t kShown = 3;  // names of a group: enough to know them again
  const LeftOut& first = *group.front();
  std::string names;
  for (size_t i = 0; i < std::min(group.size(), kShown); ++i) names += (i == 0 ? "" : ", ") + group[i]->name;
  if (group.size() > kShown) names += fmt::format(" and {} more", group.size() - kShown);
  const bool one_reason =
      std::all_of(group.begin(), group.end(), [&](const LeftOut* f) { return f->reason == first.reason; });
  const bool one_fault =
      std::all_of(group.begin(), group.end(), [&](const LeftOut* f) { return fault_of(*f) == fault_of(first); });
  return fmt::format("{} ({}{})", all ? "all" : names,
                     one_fault ? "" : "such as: ", one_reason || !one_fault ? first.reason : fault_of(first));
}

}  // namespace

std::string summary_of(size_t kept, const std::vector<LeftOut>& left_out, const char* what) {
  constexpr size_t kNamed = 10;  // enough to see the pattern; each has a line of its own
  std::string text = fmt::format("{} of {} {}", kept, kept + left_out.size(), what);
  constexpr size_t kFew = 2;  // frames with one fault that are still told one by one
  size_t named = 0, parts = 0;
  for (const std::vector<const LeftOut*>& group : grouped(left_out)) {
    if (named >= kNamed) break;
    const auto add = [&](const std::vector<const LeftOut*>& frames, bool all) {
      text += (parts++ == 0 ? "; left out: " : ", ") + told_together(frames, all);
      named += frames.size();
    };
    if (group.size() > kFew) {
      add(group, kept == 0 && group.size() == left_out.size());
      continue;
    }
    for (const LeftOut* frame : group) add({frame}, false);
  }
  if (left_out.size() > named) text += fmt::format(" and {} more", left_out.size() - named);
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
