#include "room/followed_boxes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aligngs {
namespace {

/// The largest difference of the sides.
double size_gap(const ShownBox& a, const ShownBox& b) {
  return std::max(
      {std::fabs(a.width - b.width), std::fabs(a.depth - b.depth), std::fabs((a.top - a.bottom) - (b.top - b.bottom))});
}

double place_gap(const ShownBox& a, const ShownBox& b) {
  return std::max({std::fabs(a.centre.x - b.centre.x), std::fabs(a.centre.y - b.centre.y), std::fabs(a.top - b.top),
                   std::fabs(a.bottom - b.bottom)});
}

const MeasuredBox* box_of(const std::vector<MeasuredBox>& boxes, const MeasuredBox& wanted) {
  const auto found = std::find_if(boxes.begin(), boxes.end(), [&](const MeasuredBox& b) {
    return b.class_name == wanted.class_name && b.instance == wanted.instance;
  });
  return found == boxes.end() ? nullptr : &*found;
}

/// `was`, moved as the points have.
MeasuredBox moved_box(const MeasuredBox& was, const MeasuredBox& now) {
  MeasuredBox out = was;
  out.centre = {was.centre.x + now.shown->centre.x - was.shown->centre.x,
                was.centre.y + now.shown->centre.y - was.shown->centre.y};
  out.bottom += now.shown->bottom - was.shown->bottom;
  out.top += now.shown->top - was.shown->top;
  out.support = now.support;
  out.shown = now.shown;
  return out;
}

bool is_name_of_box(const std::string& support) { return support.find('.') != std::string::npos; }

}  // namespace

bool can_follow(const std::vector<MeasuredBox>& boxes) {
  return std::all_of(boxes.begin(), boxes.end(), [](const MeasuredBox& b) { return b.shown.has_value(); });
}

std::vector<MeasuredBox> followed_boxes(const MeasuredRoom& room, std::vector<ObjectPoints> now,
                                        const FollowedBoxSettings& s) {
  // Without rays no box has parts that no photo shows.
  std::vector<MeasuredBox> boxes = find_boxes(join_pieces(std::move(now)), {room.walls, {}, room.height});
  std::erase_if(boxes, [&](const MeasuredBox& box) { return !is_inside(room.walls, box.centre); });
  for (MeasuredBox& box : boxes) {
    const MeasuredBox* was = box_of(room.boxes, box);
    if (!was || !was->shown || std::fabs(was->shown->turn - box.turn) > s.same_turn) continue;
    if (size_gap(*was->shown, *box.shown) <= s.same && place_gap(*was->shown, *box.shown) <= s.same)
      box = *was;
    else if (size_gap(*was->shown, *box.shown) <= s.same_size)
      box = moved_box(*was, box);
  }
  const auto is_there = [&](const std::string& name) {
    return std::any_of(boxes.begin(), boxes.end(), [&](const MeasuredBox& b) { return box_name(b) == name; });
  };
  for (MeasuredBox& box : boxes) {
    if (is_name_of_box(box.support) && !is_there(box.support)) box.support = "unknown";
  }
  return boxes;
}

}  // namespace aligngs
