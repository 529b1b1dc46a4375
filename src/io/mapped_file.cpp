#include "io/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csetjmp>
#include <csignal>
#include <cstring>
#include <mutex>
#include <string>

#include "core/error.h"
#include "io/waiting_file.h"

namespace aligngs {
namespace {

// A page fault also maps its surroundings, if the page cache holds them in one piece. They are up to this many bytes,
// aligned to as many (a huge page).
constexpr uint64_t kFaultAround = uint64_t(2) << 20;

// Place at which the handler continues; null outside of a copy. Signals have no other way to pass anything
// on.
thread_local sigjmp_buf* volatile copy_in_progress = nullptr;
struct sigaction previous_handler {};

void on_bus_error(int signal) {
  if (sigjmp_buf* const target = copy_in_progress) siglongjmp(*target, 1);
  // Not from a copy: whoever handled it before, or the system, gets it again on return.
  sigaction(SIGBUS, &previous_handler, nullptr);
  raise(signal);
}

void install_handler() {
  static std::once_flag once;
  std::call_once(once, [] {
    struct sigaction action {};
    action.sa_handler = on_bus_error;
    sigemptyset(&action.sa_mask);
    sigaction(SIGBUS, &action, &previous_handler);
  });
}

/// False when some of the bytes cannot be read. No object with a destructor lives here: the jump
/// would leave it out.
bool copy_unless_gone(const char* from, size_t count, char* out) {
  sigjmp_buf here;
  if (sigsetjmp(here, 1) != 0) {
    copy_in_progress = nullptr;
    return false;
  }
  copy_in_progress = &here;
  std::atomic_signal_fence(std::memory_order_seq_cst);  // the copy stays between the two lines
  std::memcpy(out, from, count);
  std::atomic_signal_fence(std::memory_order_seq_cst);
  copy_in_progress = nullptr;
  return true;
}

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) : path_(path) {
  require_no_waiting(path);
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.number < 0) {
    throw_bad_input(path, "", std::string("cannot open: ") + std::strerror(errno), "check the path");
  }
  struct stat status {};
  if (::fstat(file.number, &status) != 0 || !S_ISREG(status.st_mode))
    throw_bad_input(path, "", "this is not a file", "name a file");
  size_ = static_cast<uint64_t>(status.st_size);
  if (size_ == 0) return;
  void* const mapped = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.number, 0);
  if (mapped == MAP_FAILED) {
    const std::string reason = std::string("cannot be mapped into memory: ") + std::strerror(errno);
    if (errno == ENOMEM) throw_resources(path, reason, "raise the limit of the address space (ulimit -v)");
    throw_bad_input(path, "", reason, "copy it to a local disk");
  }
  bytes_ = static_cast<char*>(mapped);
  install_handler();
}

MappedFile::~MappedFile() {
  if (bytes_) ::munmap(bytes_, size_);
}

void MappedFile::copy(uint64_t offset, size_t count, char* out) const {
  if (count == 0) return;
  if (!copy_unless_gone(bytes_ + offset, count, out)) {
    throw_bad_input(path_, "offset " + std::to_string(offset),
                    "the file became shorter, or its disk failed, while it was read",
                    "try again once nothing else writes the file");
  }
  const uint64_t begin = offset / kFaultAround * kFaultAround;
  const uint64_t end = std::min(size_, (offset + count + kFaultAround - 1) / kFaultAround * kFaultAround);
  ::madvise(bytes_ + begin, end - begin, MADV_DONTNEED);  // the page cache keeps them
}

}  // namespace aligngs
