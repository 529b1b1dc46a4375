#include "io/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace aligngs {
namespace {

class MemorySource : public ByteSource {
 public:
  MemorySource(std::string_view bytes, std::filesystem::path name)
      : ByteSource(std::move(name), bytes.size()), bytes_(bytes) {}

 protected:
  void copy(uint64_t offset, size_t count, char* out) const override {
    if (count > 0) std::memcpy(out, bytes_.data() + offset, count);
  }

 private:
  std::string_view bytes_;
};

class FileSource : public ByteSource {
 public:
  FileSource(const std::filesystem::path& path, int descriptor, uint64_t size)
      : ByteSource(path, size), descriptor_(descriptor) {}
  ~FileSource() override { ::close(descriptor_); }

 protected:
  void copy(uint64_t offset, size_t count, char* out) const override {
    while (count > 0) {
      const ssize_t got = ::pread(descriptor_, out, count, static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0)
        throw_bad_input(name(), "", std::string("cannot read: ") + std::strerror(errno),
                        "check the disk");
      if (got == 0)
        throw_bad_input(name(), "", "the file became shorter while it was read", "try again");
      offset += static_cast<uint64_t>(got);
      out += got;
      count -= static_cast<size_t>(got);
    }
  }

 private:
  int descriptor_;
};

}  // namespace

std::string ByteSource::read(uint64_t offset, uint64_t count) const {
  if (offset > size_ || count > size_ - offset) {
    throw_bad_input(name_, "offset " + std::to_string(offset),
                    std::to_string(count) + " bytes are needed there, the file has " +
                        std::to_string(size_) + " in all",
                    "the file is truncated or damaged; copy or create it again");
  }
  std::string bytes(static_cast<size_t>(count), '\0');
  copy(offset, bytes.size(), bytes.data());
  return bytes;
}

std::unique_ptr<ByteSource> memory_source(std::string_view bytes,
                                          std::filesystem::path name_for_errors) {
  return std::make_unique<MemorySource>(bytes, std::move(name_for_errors));
}

std::unique_ptr<ByteSource> file_source(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    throw_bad_input(path, "", std::string("cannot open: ") + std::strerror(errno),
                    "check the path");
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    throw_bad_input(path, "", "not a file", "check the path");
  }
  return std::make_unique<FileSource>(path, descriptor, static_cast<uint64_t>(status.st_size));
}

}  // namespace aligngs
