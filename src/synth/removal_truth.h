// Pictures of a room without some of its objects: the truth for edits that take them away.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "synth/removal.h"
#include "synth/synth_scene.h"

namespace aligngs {

/// The room without the objects, lit anew, at the test views of the scene that it is from. The exposure, the noise and
/// the white balance of every picture are those of the scene's own picture.
struct RemovalTruth {
  Removal removal;
  std::vector<Image<uint8_t>> pictures;  ///< H x W x 3, per test view
  std::vector<Image<uint8_t>> masks;     ///< H x W, 255 where the scene's picture shows one of the objects
  TriangleMesh mesh;                     ///< with labels and colours
};
RemovalTruth make_removal_truth(const SynthScene& scene, const Removal& removal, ThreadPool& pool);

/// The scene folder with the truth of the removals in truth/without/.
void write_synth_scene(const SynthScene& scene, const std::filesystem::path& folder, bool overwrite,
                       const std::vector<RemovalTruth>& removals);

/// objects.json of a truth folder: name, class and box of every object, and the vertices [first, end) of mesh.ply that
/// are its surface.
std::string room_objects_json(const RoomModel& room);

/// Writes <folder>/<removal name>/: rgb/<view>.png, mask/<view>.png, mesh.ply and removal.json, which has the name,
/// the class and the box of every object.
void write_removal_truth(const SynthScene& scene, const RemovalTruth& truth, const std::filesystem::path& folder);

}  // namespace aligngs
