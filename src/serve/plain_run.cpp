#include "serve/plain_run.h"

#include "core/error.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Files that a run reads and writes; its scene has a place of its own, which may be anywhere.
constexpr const char* kParts[] = {"run.json",         "config.toml", "classes.json", "cameras.json",
                                  "room.json",        "edits.json",  "page.json",    "scene.ply",
                                  "scene.labels.ply", "checkpoints", "edits",        "mesh",
                                  "object",           "live",        "control"};

void require_plain(const fs::path& root, const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status)) return;
  if (fs::is_symlink(status)) {
    const fs::path inside = fs::weakly_canonical(path, error).lexically_relative(root);
    if (error || inside.empty() || *inside.begin() == "..") {
      throw_bad_input(path, {}, "this is a link out of the run folder, which the page does not follow",
                      "put the file itself there, or use the command line");
    }
  }
  const fs::file_status target = fs::status(path, error);
  if (fs::exists(target) && !fs::is_regular_file(target) && !fs::is_directory(target)) {
    throw_bad_input(path, {}, "this is no regular file", "remove it from the run folder");
  }
}

}  // namespace

void require_plain_run(const fs::path& run) {
  std::error_code error;
  const fs::path root = fs::canonical(run, error);
  if (error) return;  // opening it tells why
  for (const char* part : kParts) {
    require_plain(root, root / part);
    for (fs::recursive_directory_iterator i(root / part, error), end; !error && i != end; i.increment(error))
      require_plain(root, i->path());
  }
}

}  // namespace aligngs
