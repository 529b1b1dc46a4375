// One HTML file that shows a room without a server: the page of `aligngs view` with the room inside.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "edit/apply_edit.h"
#include "edit/export/export_options.h"

namespace aligngs {

struct HtmlSceneInfo {
  std::string name;               ///< shown as the title
  bool metric = false;            ///< the scene's units are metres
  bool estimated = false;         ///< a network estimates them
  std::filesystem::path cameras;  ///< cameras.json of the run; left out when it cannot be read
  std::filesystem::path room;     ///< room.json of the run, for the plan and sizes; left out when it cannot be read
  std::string room_text;          ///< the content of room.json with the edits; empty: that of the file
  std::filesystem::path notes;    ///< page.json of the run (page_notes.h); may be absent, Error{kBadInput} when damaged
};

/// Content of the file.
struct HtmlParts {
  const EditableRoom& room;              ///< with its edits
  const EditableRoom* before = nullptr;  ///< the trained room that `room` was made of, for the switch; may be absent
  bool mesh = true;                      ///< the meshes of both, where they have one
  MeshOptions mesh_options = {};         ///< how far they are simplified
};

/// Bytes of the file, by what needs them.
struct HtmlSize {
  uint64_t page = 0;         ///< the page itself
  uint64_t splats = 0;       ///< of the edited room
  uint64_t mesh = 0;         ///< of the edited room
  uint64_t before = 0;       ///< splats that the edits removed or changed, and the edits
  uint64_t before_mesh = 0;  ///< of the room before
  uint64_t total() const { return page + splats + mesh + before + before_mesh; }
};

/// Estimate before anything is written: a part of the splats is compressed. It is within a tenth of the truth in rooms.
HtmlSize estimate_html(const HtmlParts& parts, const HtmlSceneInfo& info);

struct HtmlReport {
  uint64_t bytes = 0;
  size_t gaussians = 0;                        ///< of the edited room, in the file
  size_t triangles = 0, triangles_before = 0;  ///< of the mesh of the edited room; before it was simplified
};

/// Exact positions, classes and objects. Colours, opacities, scales and rotations are rounded below visible
/// differences. Values are stored column by column, so that they compress to about a tenth of scene.ply. Gaussians that
/// nobody can see (opacity below 1/255) are left out. Meshes are as packed_mesh.h has them, the edits as
/// edited_scene.h.
HtmlReport write_html(const std::filesystem::path& path, const HtmlParts& parts, const HtmlSceneInfo& info,
                      ThreadPool& pool);

/// The data in the file: a JSON line {"state", "room", "count", "columns": [{"name", "type", "step"}]}, then each
/// column's numbers, little-endian. A value is its number x step; "label", "instance" and "confidence" have step 1.
/// "room" is room.json or null. The splats are those of `before` where it is given.
std::string packed_scene(const HtmlParts& parts, const HtmlSceneInfo& info);

}  // namespace aligngs
