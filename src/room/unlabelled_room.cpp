#include "room/unlabelled_room.h"

#include <algorithm>

#include "core/error.h"
#include "room/structure_labels.h"

namespace aligngs {
namespace {

/// Depth alone, where a surface covers the pixel.
MeasuredView measured_view_of(const PlaneView& view) {
  MeasuredView out{view.camera, view.depth, ImageF(view.depth.width, view.depth.height, 1, 1.0f), {}};
  if (view.certainty.data.size() != out.depth.data.size()) return out;
  for (size_t i = 0; i < out.depth.data.size(); ++i) {
    if (!(view.certainty.data[i] > 0)) out.depth.data[i] = 0;
  }
  return out;
}

}  // namespace

RoomSettings settings_of_unlabelled_rooms() {
  RoomSettings settings;
  settings.planes.planes = planes_of_anything();
  settings.planes.label_edge = 0;
  settings.label_edge = 0;
  return settings;
}

MeasuredRoom find_unlabelled_room(const RoomInputs& inputs, const UnlabelledRoomSettings& settings, ThreadPool& pool) {
  if (!inputs.up || !(norm(*inputs.up) > 0))
    throw_bad_input({}, "up", "nothing tells which way is up", "give \"up\": [x, y, z] in scene.json");
  std::vector<MeasuredView> views;
  for (const PlaneView& view : inputs.views) views.push_back(measured_view_of(view));
  const RoomStructure structure = find_structure(views, *inputs.up, inputs.metres_per_unit, settings.structure, pool);
  if (structure.walls.empty()) {
    throw_bad_input({}, "walls", "there is no label, and no large upright plane ends what the photos see",
                    "show the walls in more photos, or train a scene that has segmentation_logits/");
  }
  RoomSettings found = settings.room;
  found.planes.stride = std::min(found.planes.stride, stride_for(views, settings.structure.across));
  RoomInputs labelled = inputs;
  labelled.labels = &structure_label_set();
  labelled.up = structure.up;
  labelled.objects.clear();
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      labelled.views[i].labels = structure_labels(views[i], structure, settings.structure);
      labelled.views[i].label_share = {};
      labelled.views[i].depth = std::move(views[i].depth);
    }
  });
  MeasuredRoom room = find_room(labelled, found, pool);
  room.found_by = RoomEvidence::kGeometry;
  room.warnings.insert(room.warnings.begin(),
                       "The run has no labels. Doors, windows, pictures and furniture are not found without them.");
  return room;
}

}  // namespace aligngs
