#include "serve/served_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace aligngs {

namespace fs = std::filesystem;

namespace {

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }
  int release() { return std::exchange(value_, -1); }

 private:
  int value_;
};

bool lies_below(const fs::path& root, const fs::path& file) {
  const fs::path inside = file.lexically_relative(root);
  return !inside.empty() && *inside.begin() != ".." && *inside.begin() != ".";
}

/// The place of an open descriptor, links resolved.
std::string own_name(int descriptor) { return fmt::format("/proc/self/fd/{}", descriptor); }

}  // namespace

std::optional<ServedFile> ServedFile::open(const fs::path& root, std::string_view relative) {
  const fs::path asked{std::string(relative)};
  if (asked.empty() || asked.is_absolute()) return {};
  // O_PATH names a file without opening it: a FIFO is not waited for, a device does nothing.
  const Descriptor named(::open((root / asked).c_str(), O_PATH | O_CLOEXEC));
  struct stat status {};
  if (named.get() < 0 || ::fstat(named.get(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  std::error_code error;
  const fs::path found = fs::read_symlink(own_name(named.get()), error);
  if (error || !lies_below(root, found)) return {};
  Descriptor file(::open(own_name(named.get()).c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return {};
  ServedFile out;
  out.path_ = found;
  out.size_ = static_cast<uint64_t>(status.st_size);
  out.etag_ = fmt::format(
      "\"{:x}-{:x}-{:x}\"",
      static_cast<uint64_t>(status.st_mtim.tv_sec) * 1'000'000'000 + static_cast<uint64_t>(status.st_mtim.tv_nsec),
      status.st_size, status.st_ino);
  out.descriptor_ = file.release();
  return out;
}

ServedFile::~ServedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

ServedFile::ServedFile(ServedFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      size_(other.size_),
      etag_(std::move(other.etag_)) {}

ServedFile& ServedFile::operator=(ServedFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  path_ = std::move(other.path_);
  size_ = other.size_;
  etag_ = std::move(other.etag_);
  return *this;
}

size_t ServedFile::read(uint64_t offset, std::span<char> out) const {
  size_t got = 0;
  while (got < out.size()) {
    const ssize_t n = ::pread(descriptor_, out.data() + got, out.size() - got, static_cast<off_t>(offset + got));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    got += static_cast<size_t>(n);
  }
  return got;
}

std::optional<std::string> ServedFile::content(uint64_t limit) const {
  if (size_ > limit) return {};
  std::string bytes(static_cast<size_t>(size_), '\0');
  bytes.resize(read(0, bytes));
  return bytes;
}

}  // namespace aligngs
