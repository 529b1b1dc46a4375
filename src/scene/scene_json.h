// The small JSON files of a scene folder: scene.json, split.json, priors.json, exposure.json.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace aligngs {

/// Mark in scene.json of folders that this program wrote, which it may replace when asked to (scene_place.h).
inline constexpr const char* kWrittenBy = "written_by";
inline constexpr const char* kThisProgram = "aligngs";

/// scene.json: {"written_by": "aligngs", "units": "metres" | "arbitrary", "up": [x, y, z] | null, "up_source": "...",
/// "source": "...", "units_estimate": {"model": "...", "spread": s, "photos": n}, "to_original": {"scale": s,
/// "translation": [x, y, z]}}.
struct SceneJson {
  bool metric = false;
  std::optional<UnitsEstimate> units_estimate;  ///< a network guessed the metres
  std::optional<Vec3d> up;                      ///< unit
  std::string source;
  std::string up_source;  ///< where `up` comes from; empty: not known
  /// From this world to that of the files it was imported from, where it was moved or scaled; the rotation is the
  /// identity.
  std::optional<Similarity> to_original;
  bool refined = false;  ///< `aligngs refine` corrected cameras and prior depth together ("cameras_refined"); read only
};

/// split.json: {"train": [names], "test": [names]}; a list that is absent is nullopt.
struct SplitJson {
  std::optional<std::vector<std::string>> train, test;
};

/// One entry of priors.json: what made a prior.
struct PriorJson {
  std::string model;                            ///< e.g. "sensor", "simulated", "vggt-1b"
  std::string weights;                          ///< checksum of the weights; empty when there are none
  std::map<std::string, std::string> settings;  ///< anything worth knowing later
};

/// priors.json: {"depth": {..., "scale": "scene" | "metres" | "own" | "per_view"},
///               "semantics": {..., "kind": "logits" | "scores" | "probabilities"}}.
struct PriorsJson {
  std::optional<PriorJson> depth, semantics;
  std::optional<DepthScale> depth_scale;
  std::optional<SemanticKind> kind;
};

/// exposure.json: {"log_gains": {view: [red, green, blue]}}: logarithms of what a photo's linear light is multiplied by
/// against the mean photo. Within +-kMaxLogGain.
using ExposureJson = std::map<std::string, Vec3f>;
inline constexpr double kMaxLogGain = 3;  // a factor of 20, over four stops

/// Bytes of the largest scene.json that is read; a split of a million names fits.
inline constexpr size_t kMaxSceneFile = size_t(64) << 20;

/// An absent file gives the defaults; a malformed one is Error{kBadInput} naming the field.
SceneJson read_scene_json(const std::filesystem::path& path);
SplitJson read_split_json(const std::filesystem::path& path);
PriorsJson read_priors_json(const std::filesystem::path& path);
ExposureJson read_exposure_json(const std::filesystem::path& path);

void write_scene_json(const std::filesystem::path& path, const SceneJson& scene);
void write_split_json(const std::filesystem::path& path, const SplitJson& split);
void write_priors_json(const std::filesystem::path& path, const PriorsJson& priors);
void write_exposure_json(const std::filesystem::path& path, const ExposureJson& exposure);

const char* name_of(SemanticKind kind);
const char* name_of(DepthScale scale);

/// Scale of prior depth: as priors.json states it. Older files state it by depth.settings.units, which `aligngs priors`
/// wrote ("arbitrary": own, "metres": metres). Depth that `aligngs refine` corrected, that of a sensor and measured
/// depth are in scene units, and so is depth that the file does not mention. All other depth is per_view, which
/// assumes least.
DepthScale depth_scale_of(const PriorsJson& priors, bool refined);
/// Whether depth_scale_of() has to assume: the file mentions depth of a network, and says neither scale nor units.
bool assumes_depth_scale(const PriorsJson& priors, bool refined);

}  // namespace aligngs
