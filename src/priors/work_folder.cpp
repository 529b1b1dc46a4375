#include "priors/work_folder.h"

#include <unistd.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "core/temporary_paths.h"

namespace aligngs {

namespace fs = std::filesystem;

WorkFolder::WorkFolder(const fs::path& scene) {
  fs::path beside = fs::absolute(scene).lexically_normal();
  if (!beside.has_filename()) beside = beside.parent_path();  // "scene/"
  remove_abandoned(beside);
  path_ = temporary_beside(beside, ".work-" + std::to_string(getpid()));
  note_temporary_path(path_);
  std::error_code error;
  fs::create_directories(path_, error);
  if (!error) {
    lock_.emplace(path_);
    return;
  }
  forget_temporary_path(path_);
  throw_resources(path_, error.message(), "choose a folder that you may write to");
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  if (keep_log)
    leave_log_alone();
  else if (!keep)
    fs::remove_all(path_, ignored);
  forget_temporary_path(path_);
}

void WorkFolder::leave_log_alone() const {
  std::vector<fs::path> others;
  std::error_code error;
  for (fs::directory_iterator entry(path_, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path() != log()) others.push_back(entry->path());
  }
  for (const fs::path& other : others) fs::remove_all(other, error);
}

}  // namespace aligngs
