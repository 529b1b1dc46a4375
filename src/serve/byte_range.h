// The Range header of a download that is resumed (RFC 9110, section 14).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace aligngs {

/// Bytes `first` to `first + count - 1` of a file.
struct ByteRange {
  uint64_t first = 0;
  uint64_t count = 0;
};

/// The part of a file that a request asks for.
struct AskedRange {
  enum class Kind {
    kWhole,          ///< no range, several ranges, or a header that is none: status 200
    kPart,           ///< status 206
    kBeyondTheFile,  ///< nothing of the range lies in the file: status 416
  };
  Kind kind = Kind::kWhole;
  ByteRange bytes;  ///< of kPart
};

/// `range`: "bytes=FIRST-LAST", "bytes=FIRST-" or "bytes=-LAST_COUNT"; empty: no header. `if_range`: the ETag that the
/// client has; a range counts only where it is `etag`. Dates there never match, as they do not tell two changes of one
/// second apart.
AskedRange asked_range(std::string_view range, std::string_view if_range, std::string_view etag, uint64_t size);

/// Value of Content-Range: "bytes 0-9/100".
std::string content_range(const ByteRange& bytes, uint64_t size);

/// Whether If-None-Match or If-Match (a list of ETags, or "*") names `etag`.
bool names_etag(std::string_view if_none_match, std::string_view etag);

}  // namespace aligngs
