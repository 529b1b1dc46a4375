#include "edit/ordered_objects.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr double kOrderStep = 0.2;  // metres

bool is_nearer(const Related& a, const Related& b) { return a.gap < b.gap; }

[[noreturn]] void refuse_alike(const RoomObjects& objects, const std::vector<Related>& related,
                               const std::string& what) {
  std::string gaps;
  std::vector<size_t> found;
  for (const Related& r : related) {
    const std::string from = r.anchor == r.object ? "" : " from " + objects.name(r.anchor);
    gaps += fmt::format("{}{} ({:.2f} m{})", gaps.empty() ? "" : ", ", objects.name(r.object), r.gap, from);
    found.push_back(r.object);
  }
  throw_bad_input({}, "--select", "\"" + what + "\" fits more than one object: " + gaps,
                  did_you_mean(objects, found) + "Or say \"all\" before it");
}

/// Metres by which one object is clearly before the next.
double border_of(Relation relation) {
  if (relation == Relation::kRoomMiddle) return 0.3;
  return relation == Relation::kNearest ? 0.02 : 0.05;
}

}  // namespace

std::string did_you_mean(const RoomObjects& objects, const std::vector<size_t>& some) {
  constexpr size_t kMost = 3;
  std::string text;
  for (size_t k = 0; k < some.size() && k < kMost; ++k)
    text += (k ? " or \"" : "did you mean \"") + objects.name(some[k]) + "\"";
  return text.empty() ? "" : text + "? ";
}

bool hang_together(const RoomObjects& objects, const std::set<size_t>& used, const std::vector<size_t>& anchors) {
  constexpr double kBetweenPieces = 0.3;  // metres: a pillow or a blanket may hide what joins them
  std::vector<size_t> reached = {*used.begin()};
  for (size_t k = 0; k < reached.size(); ++k) {
    for (const size_t i : anchors) {
      const bool is_new = std::find(reached.begin(), reached.end(), i) == reached.end();
      if (is_new && objects.gap(reached[k], i) <= kBetweenPieces) reached.push_back(i);
    }
  }
  return std::all_of(used.begin(), used.end(),
                     [&](size_t i) { return std::find(reached.begin(), reached.end(), i) != reached.end(); });
}

size_t clearly_nearest(const RoomObjects& objects, std::vector<Related> related, const std::string& what) {
  std::sort(related.begin(), related.end(), is_nearer);
  const double limit = std::max(2 * related[0].gap, related[0].gap + kOrderStep);
  if (related.size() > 1 && related[1].gap <= limit) refuse_alike(objects, related, what);
  return related[0].object;
}

std::vector<size_t> first_in_order(const RoomObjects& objects, std::vector<Related> related, Relation relation,
                                   size_t count, size_t rank, const std::string& what) {
  std::sort(related.begin(), related.end(), is_nearer);
  if (relation == Relation::kFarthest) std::reverse(related.begin(), related.end());
  const size_t begin = rank - 1, end = rank > 1 ? rank : count;
  for (const size_t border : {begin, end}) {
    if (border == 0 || border >= related.size()) continue;
    const double step = related[border].gap - related[border - 1].gap;
    if (std::max(step, -step) < border_of(relation)) refuse_alike(objects, related, what);
  }
  std::vector<size_t> out;
  for (size_t k = begin; k < end; ++k) out.push_back(related[k].object);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace aligngs
