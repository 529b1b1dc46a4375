#include "io/folder_replacement.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/stop_signal.h"
#include "core/temporary_paths.h"
#include "io/file_system_error.h"
#include "io/folder_copy.h"
#include "io/output_place.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

fs::path beside(const fs::path& target, const char* end) {
  return temporary_beside(target, ".tmp-" + std::to_string(::getpid()) + end);
}

/// Two folders change places, or the first takes the free place of the second. False where the system or the disk
/// cannot do that at once.
bool exchange(const fs::path& a, const fs::path& b, bool replaced) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), replaced ? RENAME_EXCHANGE : RENAME_NOREPLACE) == 0;
}

}  // namespace

FolderReplacement::FolderReplacement(const fs::path& target) : target_(real_place(target)) {
  if (const fs::path place = first_protected_folder(target_); !place.empty())
    throw_resources(place, "this folder is protected against writing, so nothing in it can be replaced",
                    "let it be written (chmod -R u+w), or choose another folder");
  remove_abandoned(target_);
  temporary_ = beside(target_, "");
  note_temporary_path(temporary_);
  std::error_code error;
  fs::remove_all(temporary_, error);
  if (!error) fs::create_directories(temporary_, error);
  if (!error) {
    lock_.emplace(temporary_);
    return;
  }
  forget_temporary_path(temporary_);
  throw_resources(target_, "the folder cannot be created: " + error.message(), remedy_for_write(error.value()));
}

FolderReplacement::~FolderReplacement() {
  if (temporary_.empty()) return;
  std::error_code ignored;  // nothing to be done about a left-over while another error may be on its way
  fs::remove_all(temporary_, ignored);
  forget_temporary_path(temporary_);
}

void FolderReplacement::commit() {
  stop_if_requested();
  std::error_code error;
  {
    const auto lock = hold_temporary_paths();
    const bool replaced = fs::exists(target_, error);
    if (exchange(temporary_, target_, replaced)) {
      // The former content now has the temporary name, under which it is removed.
      if (!replaced) forget_temporary_path(temporary_);
    } else {
      move_in_two_steps(replaced, error);
    }
  }
  if (error)
    throw_resources(target_, "the folder cannot be put in place: " + error.message(), "check the disk and the rights");
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
  forget_temporary_path(temporary_);
  temporary_.clear();
}

/// The old folder moves aside first: rename() does not replace a folder that is not empty.
void FolderReplacement::move_in_two_steps(bool replaced, std::error_code& error) {
  const fs::path old = beside(target_, ".old");
  error.clear();
  if (replaced) fs::rename(target_, old, error);
  if (!error) fs::rename(temporary_, target_, error);
  std::error_code ignored;
  if (error && replaced && !fs::exists(target_, ignored)) fs::rename(old, target_, ignored);
  if (!error && replaced) fs::rename(old, temporary_, ignored);
}

}  // namespace aligngs
