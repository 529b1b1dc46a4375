#include "io/jpeg_warnings.h"

#include <algorithm>
#include <cstdio>

#include "io/jpeg_segments.h"

namespace aligngs {
namespace {

/// Some cameras and programs fill a scan up before its end. More bytes than these, which differ, were pixels.
constexpr size_t kFewBytes = 16;

/// The entropy-coded bytes before the end of the picture.
std::string_view last_scan(std::string_view bytes) {
  SegmentWalker walker(bytes);
  uint8_t marker = 0;
  std::string_view content;
  size_t begin = 0;
  while (walker.next(marker, content)) {
    if (marker == kStartOfScan) begin = walker.position();
    if (marker == kEndOfImage && begin > 0) return bytes.substr(begin, walker.position() - 2 - begin);
  }
  return {};
}

bool is_filling(std::string_view scan, size_t count) {
  while (scan.ends_with('\xff')) scan.remove_suffix(1);  // libjpeg does not count these
  if (count <= kFewBytes) return true;
  if (count > scan.size()) return false;
  const std::string_view rest = scan.substr(scan.size() - count);
  return std::all_of(rest.begin(), rest.end(), [&](char byte) { return byte == rest.front(); });
}

bool has_odd_bytes_in_headers(std::string_view bytes) {
  SegmentWalker walker(bytes);
  uint8_t marker = 0;
  std::string_view content;
  while (walker.next(marker, content)) {
    if (walker.skipped().find_first_not_of('\xff') != std::string_view::npos) return true;
    if (marker == kStartOfScan) return false;
  }
  return false;
}

}  // namespace

// JWRN_HIT_MARKER, JWRN_HUFF_BAD_CODE, JWRN_ARITH_BAD_CODE, JWRN_JPEG_EOF, JWRN_MUST_RESYNC and JWRN_BOGUS_PROGRESSION
// come from coefficients that are not there: pixels are lost. JWRN_ADOBE_XFORM and JWRN_NOT_SEQUENTIAL are about
// headers, whose sense is clear. JWRN_EXTRANEOUS_DATA depends on the place. Bytes between headers are harmless, and so
// is filling at the end. Else the decoder has lost its place in the scan, and the bytes are the pixels that it missed.
bool means_damage(std::string_view warning, std::string_view bytes) {
  for (const std::string_view known : {"Unknown Adobe color transform", "Invalid SOS parameters for sequential JPEG"}) {
    if (warning.find(known) != std::string_view::npos) return false;
  }
  unsigned count = 0, marker = 0;
  if (std::sscanf(std::string(warning).c_str(), "Corrupt JPEG data: %u extraneous bytes before marker %x", &count,
                  &marker) != 2)
    return true;
  if (has_odd_bytes_in_headers(bytes)) return false;
  return marker != kEndOfImage || !is_filling(last_scan(bytes), count);
}

std::string without_odd_headers(std::string_view bytes) {
  constexpr size_t kStartOfImage = 2;  // bytes
  std::string out(bytes.substr(0, kStartOfImage));
  SegmentWalker walker(bytes);
  uint8_t marker = 0;
  std::string_view content;
  bool sequential = true, scan = false;
  while (walker.next(marker, content)) {
    if (scan) out += walker.skipped();
    const size_t begin = out.size();
    const size_t length = content.size() + (has_no_content(marker) || marker == kEndOfImage ? 2 : 4);
    out += bytes.substr(walker.position() - length, length);
    if (is_frame_header(marker)) sequential = marker == 0xc0 || marker == 0xc1 || marker == 0xc9;
    if (marker == kApp14 && content.starts_with("Adobe") && content.size() >= 12) {
      constexpr size_t kTransform = 4 + 11;  // marker and length; name, version and flags
      if (byte_at(out, begin + kTransform) > 2) out[begin + kTransform] = 1;
    }
    if (marker == kStartOfScan && sequential && content.size() >= 4) {
      constexpr char kWhole[3] = {0, 63, 0};  // first and last coefficient, bits of approximation
      out.replace(out.size() - 3, 3, kWhole, 3);
    }
    scan = scan || marker == kStartOfScan;
    if (marker == kEndOfImage) break;
  }
  return out;
}

}  // namespace aligngs
