// Files for other programs, made from a room with its edits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "edit/apply_edit.h"
#include "edit/export/export_mesh.h"
#include "edit/export/export_options.h"

namespace aligngs {

struct ExportReport;

enum class ExportTexture { kNone, kAsked, kAlways };

/// A file that a format has beside it when its mesh has a texture.
struct ExportBeside {
  std::filesystem::path (*path)(const std::filesystem::path& file);
  const char* beginning = "";  ///< of every such file that this program writes, where they begin alike
};

/// A format as a row. The choices and the help of `export`, its checks, its messages and the table of docs/editing.md
/// follow from it.
struct ExportFormat {
  const char* name;                   ///< of -f, and the ending of the file
  const char* title;                  ///< for the README; formats that share one are variants
  const char* help;                   ///< what the file has, one line
  bool splats = false, mesh = false;  ///< what it can hold
  ExportReport (*write)(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                        const ExportOptions& options);
  bool one_part = false;  ///< it can hold the splats or the mesh alone, where both are there
  bool needs_labels = false;
  bool of_run = false;                           ///< a trained run has RUN/scene.NAME of its own
  ExportTexture texture = ExportTexture::kNone;  ///< of its mesh
  const char* beginning = "";  ///< of every such file that this program writes, where they begin alike
  std::vector<ExportBeside> beside = {};
};
const std::vector<ExportFormat>& export_format_rows();

/// Their names.
const std::vector<std::string>& export_formats();

/// Error{kUsage} with a suggestion unless the format is one of `known`.
void require_export_format(const std::string& format, const std::vector<std::string>& known = export_formats());

struct ExportReport {
  std::vector<std::filesystem::path> files;
  size_t gaussians = 0, objects = 0;           ///< objects: named parts of the file, where the format has them
  size_t invisible = 0;                        ///< Gaussians with an opacity below 1/255, which were left out
  size_t triangles = 0, triangles_before = 0;  ///< of the mesh in the file; before it was simplified
  double error = 0;                            ///< units of the room, of the simplification
  size_t open_edges = 0;                       ///< of a mesh that was to be closed

  void describe(const ExportMesh& mesh);
};

/// Writes one format, atomically file by file. Error{kUsage} for an unknown format (with a suggestion) or a mesh format
/// without a mesh; Error{kBadInput} for "labels.ply" of a room without labels. All other formats need none.
ExportReport export_room(const EditableRoom& room, const std::string& format, const std::filesystem::path& path,
                         ThreadPool& pool, const ExportOptions& options = {});

/// scene.glb: under the node "room" one node per object, and the node "splats" with KHR_gaussian_splatting. An object
/// has extras (class, class_id, instance), linear COLOR_0 or texture coordinates, a material that uses it, and
/// _FEATURE_ID_0 = object number.
/// y up, metres as the scene. The material is unlit (KHR_materials_unlit): the photos' light is in the colours. Viewers
/// that do not know splats draw points in their COLOR_0.
ExportReport write_glb(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                       const ExportOptions& options = {});
/// collision.glb: positions and triangles alone, a node per object with its class, simplified to kColliderError. Axes
/// as write_glb.
ExportReport write_collision_glb(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                                 const ExportOptions& options = {});
/// Files that an OBJ or a USD with a texture has beside it, and how such a material begins.
std::filesystem::path texture_beside(const std::filesystem::path& path);
std::filesystem::path material_beside(const std::filesystem::path& path);
inline constexpr const char* kMaterialBeginning = "newmtl photos\nillum 0\nKd 1 1 1\n";
/// Wavefront OBJ: one "o" per object with its class as group, vertex colours after the positions. y up. With a texture:
/// texture coordinates instead, and beside the file its .mtl and .jpg of the same name.
ExportReport write_obj(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                       const ExportOptions& options = {});
/// USD as text: under /room one Xform per object and structural part, with its class (SemanticsLabelsAPI:class), mesh
/// and splats. The mesh has vertex colours in linear light, or a texture in a .jpg beside the file. An invisible mesh
/// simplified to kColliderError is its collider. Splats are ParticleField3DGaussianSplat of OpenUSD 26.03: linear
/// scales, opacities in [0, 1]. y up, one unit is a metre. Error{kUsage} for the mesh alone of a room without one.
ExportReport write_usda(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                        const ExportOptions& options = {});
/// The mesh of write_usda with its texture as one file, for phones: a stored zip whose files start at multiples of 64
/// bytes.
ExportReport write_usdz(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                        const ExportOptions& options = {});
/// SPZ version 3 (Niantic): gzip; right-up-back axes; 24-bit fixed-point positions, 8-bit everything else.
ExportReport write_spz(const std::filesystem::path& path, const GaussianModel& model);
/// Sentence about positions that SPZ keeps in steps of more than a thousandth of the extent; empty for finer ones.
std::string coarse_spz_warning(const GaussianModel& model, double extent);
/// SOG version 2 (PlayCanvas): a zip of lossless WebP images and meta.json.
ExportReport write_sog(const std::filesystem::path& path, const GaussianModel& model, ThreadPool& pool);
/// .splat: 32 bytes a Gaussian, colour without direction.
ExportReport write_splat(const std::filesystem::path& path, const GaussianModel& model);

}  // namespace aligngs
