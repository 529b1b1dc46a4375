// The run folder: who may write into it, and which file is where.
#pragma once

#include <filesystem>
#include <string_view>

namespace aligngs {

enum class RunMode {
  kNew,       ///< the folder must be absent, empty, or hold nothing but scene/
  kResume,    ///< go on with the run in it; begins one when there is none
  kOverwrite  ///< what a run wrote there before is removed first; scene/ stays
};

class RunFolder {
 public:
  explicit RunFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path record() const { return folder_ / "run.json"; }
  std::filesystem::path config() const { return folder_ / "config.toml"; }
  std::filesystem::path events() const { return folder_ / "events.ndjson"; }
  std::filesystem::path checkpoints() const { return folder_ / "checkpoints"; }
  std::filesystem::path scene_ply() const { return folder_ / "scene.ply"; }
  std::filesystem::path labelled_ply() const { return folder_ / "scene.labels.ply"; }
  std::filesystem::path classes() const { return folder_ / "classes.json"; }
  std::filesystem::path cameras() const { return folder_ / "cameras.json"; }
  std::filesystem::path sparse() const { return folder_ / "sparse" / "0"; }
  std::filesystem::path transforms() const { return folder_ / "transforms.json"; }

  bool has_run() const;  ///< it holds a run.json that this program wrote
  /// Whether `file` is of a training or its stages here, or lies in RUN/scene. Files of `export` are not.
  bool wrote(const std::filesystem::path& file) const;

  /// Applies the rules of the mode without changing anything; call before long checks. Error{kUsage} when
  /// the folder holds a run and the mode is kNew, or holds files that are not a run's.
  void check(RunMode mode) const;
  /// Error{kUsage} when a run here would write into or over the scene or photos that it is made from. The folder is or
  /// lies in `source`, or `source` lies in a folder that a run writes. RUN/scene is no such place.
  void require_apart_from(const std::filesystem::path& source) const;
  /// Error{kUsage} where `file` is of the run's training or stages, or lies in its scene. The scene is RUN/scene, the
  /// one of run.json, or `scene`, which may be empty. Files of `export` may be replaced. Files of other runs, scenes and
  /// data sets may not (replaceable_file.h, which says what `own_beginning` means).
  void require_not_of_run(const std::filesystem::path& file, const std::filesystem::path& scene = {},
                          std::string_view own_beginning = {}) const;
  /// check(), then creates the folder, removes a previous run (kOverwrite) and temporary files of killed writers.
  void prepare(RunMode mode) const;

 private:
  void require_removable() const;

  std::filesystem::path folder_;
};

}  // namespace aligngs
