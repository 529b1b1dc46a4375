#include "io/folder_replacement.h"

#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

fs::path beside(const fs::path& target, const char* suffix) {
  fs::path path = target;
  path += suffix + std::to_string(::getpid());
  return path;
}

}  // namespace

FolderReplacement::FolderReplacement(fs::path target) : target_(fs::absolute(target).lexically_normal()) {
  if (target_.filename().empty()) target_ = target_.parent_path();  // "out/" means "out"
  temporary_ = beside(target_, ".tmp-");
  std::error_code error;
  fs::remove_all(temporary_, error);
  if (!error) fs::create_directories(temporary_, error);
  if (error) throw_resources(target_, "the folder cannot be created: " + error.message(), "choose a place you may write to");
}

FolderReplacement::~FolderReplacement() {
  std::error_code ignored;  // nothing to be done about a left-over while another error may be on its way
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void FolderReplacement::commit() {
  // The old folder moves aside first: rename() does not replace a folder that is not empty.
  const fs::path old = beside(target_, ".old.tmp-");
  std::error_code error;
  const bool replaced = fs::exists(target_, error);
  if (replaced) fs::rename(target_, old, error);
  if (!error) fs::rename(temporary_, target_, error);
  if (error) {
    std::error_code ignored;
    if (replaced && !fs::exists(target_, ignored)) fs::rename(old, target_, ignored);
    throw_resources(target_, "the folder cannot be put in place: " + error.message(), "check the disk and the rights");
  }
  temporary_.clear();
  std::error_code ignored;
  fs::remove_all(old, ignored);
}

}  // namespace aligngs
