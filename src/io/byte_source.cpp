#include "io/byte_source.h"

#include <cstring>
#include <utility>

#include "core/error.h"
#include "io/damaged_file.h"
#include "io/mapped_file.h"

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
  FileSource(const std::filesystem::path& path, std::unique_ptr<const MappedFile> file)
      : ByteSource(path, file->size()), file_(std::move(file)) {}

 protected:
  void copy(uint64_t offset, size_t count, char* out) const override { file_->copy(offset, count, out); }

 private:
  std::unique_ptr<const MappedFile> file_;
};

}  // namespace

void ByteSource::require(uint64_t offset, uint64_t count) const {
  if (offset <= size_ && count <= size_ - offset) return;
  throw_bad_input(name_, "offset " + std::to_string(offset),
                  std::to_string(count) + " bytes are needed there, the file has " + std::to_string(size_) + " in all",
                  kDamagedFileRemedy);
}

std::string ByteSource::read(uint64_t offset, uint64_t count) const {
  require(offset, count);
  std::string bytes(static_cast<size_t>(count), '\0');
  copy(offset, bytes.size(), bytes.data());
  return bytes;
}

void ByteSource::read_into(uint64_t offset, size_t count, char* out) const {
  require(offset, count);
  copy(offset, count, out);
}

std::unique_ptr<ByteSource> memory_source(std::string_view bytes, std::filesystem::path name_for_errors) {
  return std::make_unique<MemorySource>(bytes, std::move(name_for_errors));
}

std::unique_ptr<ByteSource> file_source(const std::filesystem::path& path) {
  return std::make_unique<FileSource>(path, std::make_unique<const MappedFile>(path));
}

}  // namespace aligngs
