#include "cli/folder_kind.h"

#include "core/error.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

bool is_scene(const fs::path& folder) {
  return fs::exists(folder / "scene.json") || fs::exists(folder / "split.json") || fs::exists(folder / "sparse");
}

bool is_run(const fs::path& folder) { return fs::exists(folder / "run.json"); }

bool is_batch(const fs::path& folder) {
  return fs::is_directory(folder / "leases") && fs::is_directory(folder / "records") &&
         fs::exists(folder / "list.json");
}

/// The run or scene that a folder lies in, at most as deep as theirs go; empty: none.
fs::path owner_of(const fs::path& folder) {
  constexpr int kDeepest = 4;  // RUN/renders/test/rgb
  std::error_code error;
  fs::path above = fs::weakly_canonical(folder, error);
  for (int i = 0; !error && i < kDeepest && above.has_relative_path(); ++i) {
    above = above.parent_path();
    if (is_run(above) || fs::exists(above / "scene.json")) return above;
  }
  return {};
}

}  // namespace

FolderKind kind_of_folder(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return FolderKind::kAbsent;
  if (!fs::is_directory(path, error)) return FolderKind::kFile;
  if (is_run(path)) return FolderKind::kRun;
  if (is_scene(path)) return FolderKind::kScene;
  if (is_batch(path)) return FolderKind::kBatch;
  const fs::path owner = owner_of(path);
  if (owner.empty()) return FolderKind::kOther;
  return is_run(owner) ? FolderKind::kPartOfRun : FolderKind::kPartOfScene;
}

void refuse_folder(const fs::path& path, FolderKind kind, const std::string& wanted) {
  const std::string give = "give " + wanted;
  switch (kind) {
    case FolderKind::kAbsent:
      throw_bad_input(path, "", "there is no such folder", "check the name");
    case FolderKind::kFile:
      throw_bad_input(path, "", "this is a file, not " + wanted, give);
    case FolderKind::kRun:
      throw_bad_input(path, "", "this is a run folder, not " + wanted, give);
    case FolderKind::kScene:
      throw_bad_input(path, "", "this is a scene folder, not " + wanted,
                      give + ", which `aligngs run " + path.string() + " -o RUN` makes");
    case FolderKind::kBatch:
      throw_bad_input(path, "", "this is the folder of a batch, not " + wanted,
                      "give one of its rooms: " + (path / "rooms").string() + "/ROOM");
    case FolderKind::kPartOfRun:
    case FolderKind::kPartOfScene:
      throw_bad_input(path, "",
                      std::string("this is a part of the ") +
                          (kind == FolderKind::kPartOfRun ? "run" : "scene folder") + " " + owner_of(path).string() +
                          ", not " + wanted,
                      "give " + owner_of(path).string());
    case FolderKind::kOther:
      break;
  }
  throw_bad_input(path, "", "this is not " + wanted, give);
}

void require_run_of(const fs::path& path) {
  const FolderKind kind = kind_of_folder(path);
  if (kind != FolderKind::kRun) refuse_folder(path, kind, "a run folder");
}

}  // namespace aligngs
