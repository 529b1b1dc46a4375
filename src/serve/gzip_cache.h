// Compressed texts of the server, each made once.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

namespace aligngs {

/// Holds gzip streams by name and version, and drops the oldest beyond its limit. Safe to use from several threads.
class GzipCache {
 public:
  using Stream = std::shared_ptr<const std::string>;

  explicit GzipCache(size_t limit_bytes) : limit_(limit_bytes) {}

  /// The stream of this version; null when there is none.
  Stream find(const std::string& name, const std::string& version) const;
  /// Compresses `text` and keeps the stream in place of an older version. A stream larger than the limit is not kept.
  Stream add(const std::string& name, const std::string& version, const std::string& text);
  size_t bytes() const;

 private:
  struct Entry {
    std::string name, version;
    Stream stream;
  };

  const size_t limit_;
  mutable std::mutex mutex_;
  std::deque<Entry> entries_;  ///< the oldest first
  size_t bytes_ = 0;
};

}  // namespace aligngs
