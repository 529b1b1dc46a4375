#include "edit/edit_products.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "edit/export/scene_export.h"
#include "io/atomic_file.h"
#include "io/drawn_picture.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "io/output_place.h"
#include "scene/mesh_ply.h"
#include "train/run_outputs.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

void write_json(const fs::path& path, const Json& json) { write_file_atomically(path, json_document(json)); }

}  // namespace

void write_room(const fs::path& folder, const EditableRoom& room) {
  write_scene_files(folder, room.gaussians.model, room.labels,
                    room.gaussians.has_labels() ? room.gaussians.labels : GaussianLabels());
  if (!room.mesh.vertices.empty()) write_mesh_ply(folder / "mesh" / "mesh.ply", room.mesh);
}

void write_object(const fs::path& folder, const EditableRoom& object, ThreadPool& pool) {
  write_room(folder, object);
  write_glb(folder / "object.glb", object, pool);
}

void write_before_after(const fs::path& path, const BeforeAfter& picture) {
  if (!picture.picture.empty()) write_drawn_picture(path, picture.picture);
}

void write_edited_record(const fs::path& path, RunRecord record, const std::string& command_line,
                         const std::string& scene, const fs::path& original, const std::vector<EditOperation>& edits,
                         size_t gaussians) {
  // Fields that the record does not know are kept by its writer.
  Json extra = {{"edited_from", original.filename().empty() ? original.parent_path().filename().string()
                                                            : original.filename().string()},
                {"edits", edits_json(edits)}};
  write_json(path, extra);
  record.status = RunStatus::kDone;
  record.stage = RunStage::kEdit;
  record.command = command_line;
  record.scene = scene;
  record.updated = record.finished = utc_now();
  record.reason = "edited";
  record.train.gaussians = gaussians;
  write_run_record(path, record);
}

void require_new_folder(const fs::path& folder, const std::vector<fs::path>& sources) {
  require_apart(folder, sources);
  require_empty_folder_place(folder, {"the place for the edited run is taken", "-o", "name a new or empty folder"});
}

EditableRoom centred(const EditableRoom& room) {
  EditableRoom out = room;
  GaussianModel& model = out.gaussians.model;
  if (model.size() == 0) return out;
  Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  for (size_t i = 0; i < model.size(); ++i) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], model.positions[3 * i + static_cast<size_t>(a)]);
      high[a] = std::max(high[a], model.positions[3 * i + static_cast<size_t>(a)]);
    }
  }
  const Vec3f middle = 0.5f * (low + high);
  for (size_t i = 0; i < model.positions.size(); ++i) model.positions[i] -= middle[static_cast<int>(i % 3)];
  for (Vec3f& v : out.mesh.vertices) v -= middle;
  return out;
}

}  // namespace aligngs
