// Random access to bytes that lie in a file or in memory, for formats whose parts are read one at a
// time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace aligngs {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  const std::filesystem::path& name() const { return name_; }
  uint64_t size() const { return size_; }
  /// A copy of `count` bytes from `offset`. Error{kBadInput} when they are not all within the
  /// source.
  std::string read(uint64_t offset, uint64_t count) const;
  /// The same into memory of the caller.
  void read_into(uint64_t offset, size_t count, char* out) const;

 protected:
  ByteSource(std::filesystem::path name, uint64_t size) : name_(std::move(name)), size_(size) {}
  virtual void copy(uint64_t offset, size_t count, char* out) const = 0;

 private:
  void require(uint64_t offset, uint64_t count) const;

  std::filesystem::path name_;
  uint64_t size_;
};

/// `bytes` must outlive the source.
std::unique_ptr<ByteSource> memory_source(std::string_view bytes, std::filesystem::path name_for_errors);
/// The file is mapped into memory. Error{kBadInput} when it cannot be opened, and on reading when
/// it has become shorter.
std::unique_ptr<ByteSource> file_source(const std::filesystem::path& path);

}  // namespace aligngs
