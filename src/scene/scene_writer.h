// Writes a complete scene folder (design, section 4) from parts in memory, whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "io/folder_replacement.h"
#include "scene/camera.h"
#include "scene/label_set.h"
#include "scene/point_cloud.h"
#include "scene/scene_json.h"
#include "scene/scene_place.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Class values of one view before conversion, as segmentation_logits/ stores them.
struct SemanticMap {
  int channels = 0, width = 0, height = 0;
  std::vector<float> values;  ///< [C][height][width]
};

/// Everything of one view. Empty parts are not written.
struct SceneViewParts {
  std::string name;                    ///< stem of all files; unique within the scene
  Camera camera;                       ///< at the size of the image
  std::filesystem::path image_file;    ///< copied as it is; a JPEG or PNG of the camera's size
  Image<uint8_t> image;                ///< used when image_file is empty: 3 or 4 channels
  int jpeg_quality = 0;                ///< of `image`; 0: PNG (always for 4 channels)
  std::filesystem::path mask_file;     ///< copied; PNG, 0 = leave this pixel out (photo_mask.h)
  ImageF prior_depth;                  ///< scene units, 0 = none; any size of the image's aspect
  ImageF prior_confidence;             ///< of prior_depth, see confidence_file.h
  bool half_depth = false;             ///< float16 instead of float32 (0.05 % steps; values within 6e-5 .. 65504)
  SemanticMap semantics;               ///< written as float16
  ImageF truth_depth;                  ///< metres, 0 = none; written as uint16 millimetres
  Image<uint16_t> truth_labels;        ///< class or kNoLabel; written as uint8, 255 = none
  std::optional<Camera> truth_camera;  ///< exact pose and intrinsics; given for all views or for none
};

/// Everything that belongs to the scene as a whole.
struct SceneParts {
  SceneJson description;
  SplitJson split;                        ///< lists of view names; both absent: no split.json
  PriorsJson priors;                      ///< nothing set: no priors.json
  LabelSet labels;                        ///< no classes: no labels.csv (ADE20K-150)
  PointCloud cloud;                       ///< sparse/points3D.bin; with normals also sparse/points3D.ply
  std::filesystem::path truth_mesh_file;  ///< copied to truth/mesh.ply
  TriangleMesh truth_mesh;                ///< used when truth_mesh_file is empty
};

/// Collects a scene beside its place and puts it there on finish(): the folder appears complete or not at all.
class SceneWriter {
 public:
  /// Errors of require_scene_place(). `sources`: what the scene is made from.
  SceneWriter(std::filesystem::path folder, bool overwrite, std::vector<std::filesystem::path> sources = {});

  /// Writes the view's files at once, so that only one view need be in memory. A name that was used before
  /// or that leaves the folder, a file of another size than its camera: Error{kBadInput}. Maps that contradict each
  /// other, labels above 254: Error{kFailed}.
  void add_view(const SceneViewParts& view);
  /// Writes the rest and puts the folder in its place. Nothing may be called afterwards.
  void finish(const SceneParts& parts);

  /// The same in two steps: between them the scene lies complete in folder(), to be checked.
  void write(const SceneParts& parts);
  void commit();
  const std::filesystem::path& folder() const { return replacement_.path(); }

 private:
  struct Written {
    std::string name, image_name;
    Camera camera;
    std::optional<Camera> truth_camera;
  };

  std::filesystem::path write_image(const SceneViewParts& view) const;
  void write_models(const SceneParts& parts) const;

  bool overwrite_;
  std::vector<std::filesystem::path> sources_;
  FolderReplacement replacement_;
  std::vector<Written> views_;
};

/// Positions, normals (when there are any) and colours as bytes.
void write_cloud_ply(const std::filesystem::path& path, const PointCloud& cloud);

}  // namespace aligngs
