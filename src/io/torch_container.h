// Files of torch.save, in both of its layouts: a ZIP archive (PyTorch 1.6 and later), and a row of
// pickles followed by the storages. Some published weights still use the latter, from before 1.6.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>

#include "io/byte_source.h"
#include "io/torch_tensors.h"
#include "io/zip_archive.h"

namespace aligngs {

class TorchContainer {
 public:
  /// Reads the pickle; storages are read one at a time when asked for. Error{kBadInput} for a file
  /// that is damaged or names a global outside torch_globals().
  explicit TorchContainer(std::unique_ptr<ByteSource> source);

  /// Whether a file that begins with these bytes (16 are enough) has the older layout.
  static bool is_legacy(std::string_view first_bytes);

  const PickleValue& root() const { return pickle_->root(); }
  const std::filesystem::path& name() const { return name_; }
  FloatArray read(const TorchView& view) const;

 private:
  struct Span {
    uint64_t offset = 0, bytes = 0;
  };
  void open_zip(std::unique_ptr<ByteSource> source);
  void open_legacy(std::unique_ptr<ByteSource> source);
  std::string storage_bytes(const TorchStorage& storage) const;

  std::filesystem::path name_;
  std::optional<ZipArchive> zip_;
  std::unique_ptr<ByteSource> source_;              ///< legacy only
  std::unordered_map<std::string, Span> storages_;  ///< legacy only, by key
  std::string prefix_;
  bool big_endian_ = false;
  std::optional<Pickle> pickle_;
};

}  // namespace aligngs
