// One file over HTTP(S) to disk, resumed where an earlier attempt ended.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace aligngs {

struct DownloadRequest {
  std::string url;
  /// Target file; until it is complete it is `<target>.part`, and `<target>.part.etag` remembers
  /// which version of the file that is.
  std::filesystem::path target;
  uint64_t expected_bytes = 0;  ///< 0: whatever the server says
  std::string bearer_token;     ///< sent to the first host only; empty: none
  int attempts = 5;             ///< connections before giving up
  double first_pause = 1;       ///< seconds before the second attempt; doubled each time
  /// Bytes so far (those of earlier attempts included) and in total (0: unknown).
  std::function<void(uint64_t done, uint64_t total)> progress;
};

/// Leaves `<target>.part` complete for the caller to check and to rename; returns its size.
/// Errors: kResources (disk full, no permission), kFailed (server or network; what is there stays
/// for the next time), kInterrupted (a signal asked to stop).
uint64_t download_to_part(const DownloadRequest& request);

/// `<target>.part`
std::filesystem::path part_of(const std::filesystem::path& target);

/// Whether this program was built with libcurl.
bool can_download();

}  // namespace aligngs
