#include "io/left_out.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include "core/log.h"
#include "io/text_encoding.h"

namespace aligngs {

namespace {

/// The part of a cut text without the pieces of letters at the cut.
std::string whole_letters(std::string text, bool cut_before) {
  const auto is_rest = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
  const auto is_first = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0xc0; };
  if (cut_before) {
    text.erase(0, size_t(std::find_if_not(text.begin(), text.end(), is_rest) - text.begin()));
    return text;
  }
  while (!text.empty() && is_rest(text.back())) text.pop_back();
  if (!text.empty() && is_first(text.back())) text.pop_back();
  return text;
}

/// With its folder: photos, masks, depth and labels of a view often bear one name, "left/0001" among them.
std::filesystem::path end_of_path(const std::filesystem::path& path, const std::filesystem::path& name) {
  std::filesystem::path end = path.filename(), folder = path.parent_path();
  for (auto part = name.begin(); part != name.end() && folder.has_filename(); ++part, folder = folder.parent_path())
    end = folder.filename() / end;
  return end;
}

}  // namespace

LeftOut left_out_for(const std::string& name, const Error& error) {
  const Error::Details& d = error.details();
  std::string where = as_utf8(end_of_path(d.path, std::filesystem::path(name)).string());
  if (!d.field.empty()) where += (where.empty() ? "" : ", ") + d.field;
  return {as_utf8(name), where.empty() ? d.message : where + ": " + d.message, d.remedy};
}

namespace {

/// The beginning and the end of a text that no line should hold.
std::string shown(const std::string& text) {
  constexpr size_t kLongest = 400, kBegin = 100, kEnd = 60;  // bytes
  if (text.size() <= kLongest) return text;
  return as_utf8(whole_letters(text.substr(0, kBegin), false)) + " ... " +
         as_utf8(whole_letters(text.substr(text.size() - kEnd), true));
}

/// Files of a view beside its photo. The reason for leaving it out keeps their names.
constexpr std::array<std::string_view, 6> kBesidePhotos = {"masks",    "pred_depths", "pred_confidence",
                                                           "segments", "depth",       "segmentation_logits"};

/// A reason in its parts, where it begins with a file that bears the frame's name; else the text alone.
struct Reason {
  std::string folder;  ///< one of kBesidePhotos, or empty
  std::string text;
};

Reason reason_of(const LeftOut& frame) {
  const size_t end = frame.reason.find_first_of(",:");
  if (end == std::string::npos || end + 2 > frame.reason.size()) return {"", frame.reason};
  const std::filesystem::path file(frame.reason.substr(0, end)), name(frame.name);
  if (file.stem() != name.stem() && file.stem() != name.filename()) return {"", frame.reason};
  const std::string folder = file.begin()->string();
  const bool beside = std::find(kBesidePhotos.begin(), kBesidePhotos.end(), folder) != kBesidePhotos.end();
  return {beside ? folder : "", frame.reason.substr(end + 2)};
}

/// The reason without the name of the photo: what frames with the same fault have in common.
std::string fault_of(const LeftOut& frame) {
  const Reason reason = reason_of(frame);
  return reason.folder.empty() ? reason.text : frame.reason;
}

/// The fault with each number as one sign: "frames[0].transform_matrix" and "frames[1].transform_matrix" are alike.
std::string kind_of_fault(const LeftOut& frame) {
  const Reason reason = reason_of(frame);
  std::string kind;
  for (const char c : reason.folder + ": " + reason.text) {
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
  for (size_t i = 0; i < std::min(group.size(), kShown); ++i) names += (i == 0 ? "" : ", ") + shown(group[i]->name);
  if (group.size() > kShown) names += fmt::format(" and {} more", group.size() - kShown);
  const bool one_reason =
      std::all_of(group.begin(), group.end(), [&](const LeftOut* f) { return f->reason == first.reason; });
  const bool one_fault =
      std::all_of(group.begin(), group.end(), [&](const LeftOut* f) { return fault_of(*f) == fault_of(first); });
  return fmt::format("{} ({}{})", all ? "all" : names,
                     one_fault ? "" : "such as: ", shown(one_reason || !one_fault ? first.reason : fault_of(first)));
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
  for (const LeftOut& frame : left_out) log_warning("left out: {}: {}", shown(frame.name), shown(frame.reason));
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
