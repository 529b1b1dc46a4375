// A folder that a person gave, where another kind was meant.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

enum class FolderKind {
  kAbsent,  ///< nothing is there
  kFile,
  kRun,        ///< it has a run.json
  kScene,      ///< it has a scene.json, or photos and a COLMAP model
  kBatch,      ///< of `aligngs batch`: its list and its rooms
  kPartOfRun,  ///< a folder within a run
  kPartOfScene,
  kOther
};

FolderKind kind_of_folder(const std::filesystem::path& path);

/// Error{kBadInput} unless the folder is a run, with words about what it is and what to give.
void require_run_of(const std::filesystem::path& path);

/// Error{kBadInput} always: the folder is neither a scene nor a run.
[[noreturn]] void refuse_folder(const std::filesystem::path& path, FolderKind kind, const std::string& wanted);

}  // namespace aligngs
