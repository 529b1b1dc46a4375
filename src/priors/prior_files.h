// The files of one prior of a scene while a network makes them, and those that are there already.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "io/folder_replacement.h"
#include "priors/model_store.h"
#include "priors/network_memory.h"
#include "scene/scene.h"
#include "scene/scene_json.h"
#include "scene/segment_file.h"

namespace aligngs {

/// SHA-256 of every weight file of the model and of the models it needs, joined by "+". Reads whole files.
std::string digest_of_weights(const ModelStore& store, const PublishedModel& model);

/// Effect of a prior that is already in the folder.
enum class PriorStanding { kAbsent, kKeep, kReplace };

struct PriorToMake {
  std::string what;                       ///< for messages: "depth", "semantics"
  std::filesystem::path View::*map;       ///< of a view that has it
  const std::optional<PriorJson>& noted;  ///< of priors.json
  std::string model;                      ///< that is to make it
  bool overwrite = false;
  bool complete = true;  ///< whether other files of the model are there
};

/// Error{kUsage} where another model, or somebody else, made the prior and overwrite is not set.
PriorStanding standing_of_prior(const Scene& scene, const PriorToMake& prior);

/// The photo of a view as networks take it, on white where it is transparent.
Image<uint8_t> photo_for_network(const View& view);

/// Pixels of the training photos.
std::vector<NetworkInput> sizes_of_training_photos(const Scene& scene);

/// The maps of one prior. They take the place of the old ones together, when all are there.
class PriorFiles {
 public:
  /// `maps`: their folder in the scene; `confidence`: whether pred_confidence/ comes with them.
  PriorFiles(const Scene& scene, const char* maps, bool confidence);

  /// float16 [classes, height, width]
  void add_semantics(const std::string& view, const std::vector<int64_t>& shape, const std::vector<uint16_t>& half);
  /// segments/ comes with the maps; without any, those of the maps that went are removed.
  void add_segments(const std::string& view, const SegmentMap& segments);
  /// Writes float16.
  void add_depth(const std::string& view, const ImageF& depth);
  void add_confidence(const std::string& view, const ImageF& map);
  /// Until the last step priors.json does not tell what made the maps, so that those of an end in between are of
  /// unknown origin.
  void finish(std::optional<PriorJson> PriorsJson::*entry, const PriorsJson& notes);

 private:
  const Scene& scene_;
  FolderReplacement maps_;
  std::optional<FolderReplacement> confidence_, segments_;
};

}  // namespace aligngs
