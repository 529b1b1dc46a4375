#include "io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "core/stop_signal.h"
#include "core/temporary_paths.h"
#include "io/abandoned_paths.h"
#include "io/file_system_error.h"
#include "io/output_place.h"
#include "io/waiting_file.h"

namespace aligngs {
namespace {

constexpr size_t kBufferBytes = size_t(1) << 20;  // 1 MiB: few system calls, little memory

std::string system_message(int code) { return std::strerror(code); }

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

/// A rename is durable only when the folder that holds the name is flushed too.
void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // a folder that may be written but not read: nothing more can be done
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
  require_file_place(path_);
  static std::atomic<unsigned> counter{0};
  std::error_code error;
  std::filesystem::create_directories(folder_of(path_), error);
  if (error) {
    throw_resources(path_, "cannot create the folder " + folder_of(path_).string() + ": " + error.message(),
                    remedy_for_write(error.value()));
  }
  remove_abandoned_file(path_);
  temporary_ = temporary_beside(path_, ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
  note_temporary_path(temporary_);
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    const int code = errno;
    forget_temporary_path(temporary_);
    throw_resources(path_, "cannot create the file: " + system_message(code), remedy_for_write(code));
  }
  lock_temporary(descriptor_);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  forget_temporary_path(temporary_);
}

void AtomicFile::flush() {
  size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t written = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0) {
      if (errno == EINTR) continue;
      const int code = errno;
      throw_resources(path_, "cannot write: " + system_message(code), remedy_for_write(code));
    }
    done += static_cast<size_t>(written);
  }
  buffer_.clear();
}

void AtomicFile::write(const void* data, size_t bytes) {
  const char* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const size_t part = std::min(bytes, kBufferBytes - buffer_.size());
    buffer_.append(from, part);
    from += part;
    bytes -= part;
    if (buffer_.size() == kBufferBytes) flush();
  }
}

void AtomicFile::commit() {
  stop_if_requested();
  flush();
  int code = ::fsync(descriptor_) != 0 ? errno : 0;
  if (::close(std::exchange(descriptor_, -1)) != 0 && code == 0) code = errno;
  if (code == 0) {
    const auto lock = hold_temporary_paths();
    if (::rename(temporary_.c_str(), path_.c_str()) != 0)
      code = errno;
    else
      forget_temporary_path(temporary_);
  }
  if (code != 0) throw_resources(path_, "cannot finish the file: " + system_message(code), remedy_for_write(code));
  temporary_.clear();
  sync_folder(folder_of(path_));
}

void write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  AtomicFile file(path);
  file.write(content);
  file.commit();
}

std::string read_file(const std::filesystem::path& path, uint64_t limit) {
  require_no_waiting(path);
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw_bad_input(path, "", "cannot open: " + system_message(errno), "check the path");
  struct Closer {
    int descriptor;
    ~Closer() { ::close(descriptor); }
  } closer{descriptor};
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || S_ISDIR(status.st_mode)) {
    throw_bad_input(path, "", "this is a folder, not a file", "name a file");
  }
  const auto refuse_size = [&] {
    throw_bad_input(path, "", "larger than " + std::to_string(limit) + " bytes", "check that this is the right file");
  };
  if (status.st_size > 0 && uint64_t(status.st_size) > limit) refuse_size();

  // The size is only a hint: pipes and /proc say 0, and a file may grow while it is read.
  std::string content(size_t(status.st_size) + 1, '\0');
  size_t size = 0;
  while (true) {
    if (size == content.size()) content.resize(content.size() + std::max(content.size(), kBufferBytes));
    const ssize_t got = ::read(descriptor, content.data() + size, content.size() - size);
    if (got < 0) {
      if (errno == EINTR) continue;
      throw_bad_input(path, "", "cannot read: " + system_message(errno), "check the disk");
    }
    if (got == 0) break;
    size += static_cast<size_t>(got);
    if (size > limit) refuse_size();
  }
  content.resize(size);
  return content;
}

}  // namespace aligngs
