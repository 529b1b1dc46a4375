#include "synth/rooms.h"

#include <algorithm>

#include "core/error.h"
#include "synth/gloss.h"
#include "synth/room_builders.h"
#include "synth/synth_purpose.h"

namespace aligngs {

const std::vector<std::string>& room_kinds() {
  static const std::vector<std::string> kKinds = {"bedroom", "living", "kitchen", "office"};
  return kKinds;
}

WallOpening window_opening(double s, double width, double sill, double top, bool overexposed) {
  return {s - width / 2, s + width / 2, sill, top, false, overexposed};
}

WallOpening door_opening(double s) { return {s - 0.46, s + 0.46, 0, 2.05, true, false}; }

void dress_window(RoomSite& site, int wall, const WallOpening& o, bool curtains, bool radiator) {
  const double middle = (o.s0 + o.s1) / 2, half = (o.s1 - o.s0) / 2;
  site.at_wall(wall, middle, [&] {
    if (curtains) add_curtains(site.builder, site.style, half - 0.06, 0.34, o.z1 + 0.14, 0.05);
    if (radiator) add_radiator(site.builder, site.style, std::min(1.1, 2 * half - 0.2));
  });
}

RoomModel build_room(const RoomOptions& options) {
  const auto& kinds = room_kinds();
  const auto kind = std::find(kinds.begin(), kinds.end(), options.kind);
  if (kind == kinds.end()) {
    throw_usage("unknown room '" + options.kind + "'", "use one of bedroom, living, kitchen, office");
  }
  RoomModel room;
  room.name = options.kind;
  const Random base(options.seed * 4 + static_cast<uint64_t>(kind - kinds.begin()));
  Random style_random = stream_of(base, FurnishingPurpose::kStyle),
         plan_random = stream_of(base, FurnishingPurpose::kPlan);
  const RoomStyle style = make_room_style(style_random, options.glossy);
  MeshBuilder builder(room, stream_of(base, FurnishingPurpose::kMeshes).state()[0]);
  RoomSite site{builder, style, {}, plan_random};
  if (options.kind == "bedroom")
    furnish_bedroom(site);
  else if (options.kind == "living")
    furnish_living(site);
  else if (options.kind == "kitchen")
    furnish_kitchen(site);
  else
    furnish_office(site);
  room.remove_unused_vertices();
  if (options.strong_gloss) add_gloss(room);
  return room;
}

}  // namespace aligngs
