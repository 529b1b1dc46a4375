// Files for other programs, made from a room with its edits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "edit/apply_edit.h"

namespace aligngs {

/// "ply", "labels.ply", "glb", "obj", "sog", "spz", "splat", "usda".
const std::vector<std::string>& export_formats();

/// Error{kUsage} with a suggestion unless the format is one of `known`.
void require_export_format(const std::string& format, const std::vector<std::string>& known = export_formats());

struct ExportReport {
  std::vector<std::filesystem::path> files;
  size_t gaussians = 0, objects = 0;  ///< objects: nodes or groups, where the format has them
};

/// Parts of the room in a GLB or USD.
enum class RoomParts { kAll, kMesh, kSplats };

/// Writes one format, atomically file by file. Error{kUsage} for an unknown format (with a suggestion) or a mesh format
/// without a mesh; Error{kBadInput} for "labels.ply" of a room without labels. All other formats need none. `parts`: of a GLB or USD; other
/// formats hold what they hold.
ExportReport export_room(const EditableRoom& room, const std::string& format, const std::filesystem::path& path,
                         ThreadPool& pool, RoomParts parts = RoomParts::kAll);

/// scene.glb: under the node "room" one node per object, and the node "splats" with KHR_gaussian_splatting. An object
/// has extras (class, class_id, instance), linear COLOR_0, a material that uses it, and _FEATURE_ID_0 = object number.
/// y up, metres as the scene. The material is unlit (KHR_materials_unlit): the photos' light is in the colours. Viewers
/// that do not know splats draw points in their COLOR_0.
ExportReport write_glb(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool, RoomParts parts = RoomParts::kAll);
/// Wavefront OBJ: one "o" per object with its class as group, vertex colours after the positions. y up.
ExportReport write_obj(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool);
/// USD as text: under /room one Xform per object and structural part, with its class (SemanticsLabelsAPI:class), mesh
/// and splats. The mesh has vertex colours in linear light and a collider of its triangles. Splats are
/// ParticleField3DGaussianSplat of OpenUSD 26.03: linear scales, opacities in [0, 1]. y up, one unit is a metre.
/// Error{kUsage} for the mesh alone of a room without one.
ExportReport write_usda(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool, RoomParts parts = RoomParts::kAll);
/// SPZ version 3 (Niantic): gzip; right-up-back axes; 24-bit fixed-point positions, 8-bit everything else.
ExportReport write_spz(const std::filesystem::path& path, const GaussianModel& model);
/// SOG version 2 (PlayCanvas): a zip of lossless WebP images and meta.json.
ExportReport write_sog(const std::filesystem::path& path, const GaussianModel& model, ThreadPool& pool);
/// .splat: 32 bytes a Gaussian, colour without direction.
ExportReport write_splat(const std::filesystem::path& path, const GaussianModel& model);

}  // namespace aligngs
