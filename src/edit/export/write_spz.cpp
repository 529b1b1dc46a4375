// SPZ version 3: facts from the format's public description (nianticlabs/spz, README). A gzip stream of a 16-byte
// header and one block per attribute.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "edit/export/scene_export.h"
#include "edit/export/upright.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/gzip.h"

namespace aligngs {
namespace {

constexpr uint32_t kSpzMagic = 0x5053474e;  // "NGSP"
constexpr uint32_t kSpzVersion = 3;
constexpr int kSpeedOverSize = 6;     // of zlib; 9 is three times slower and 1 % smaller
constexpr float kColorScale = 0.15f;  // of f_dc in a byte

uint8_t quantized(float v) { return static_cast<uint8_t>(std::clamp(std::lround(v), 0L, 255L)); }

/// 24-bit two's complement numbers have this many bits after the point: 12 (0.24 mm, +-2 km), fewer for larger scenes.
int fractional_bits(const GaussianModel& model) {
  float most = 0;
  for (const float p : model.positions) most = std::max(most, std::fabs(p));
  int bits = 12;
  while (bits > 0 && most * std::ldexp(1.f, bits) > 8388607.f) --bits;
  return bits;
}

/// Smallest three: two bits say which of x, y, z, w is left out, then sign and 9 bits of each of the others.
uint32_t packed_rotation(const Quaternionf& q) {
  const float v[4] = {q.x, q.y, q.z, q.w};
  uint32_t largest = 0;
  for (uint32_t i = 1; i < 4; ++i) {
    if (std::fabs(v[i]) > std::fabs(v[largest])) largest = i;
  }
  const bool negate = v[largest] < 0;
  uint32_t packed = largest;
  for (uint32_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const uint32_t sign = (v[i] < 0) != negate;
    const uint32_t magnitude = static_cast<uint32_t>(511 * std::min(1.f, std::fabs(v[i]) * 1.41421356f) + 0.5f);
    packed = packed << 10 | sign << 9 | magnitude;
  }
  return packed;
}

/// All 8 bits of the byte, steps of 1/128. The format's own encoder keeps 5 bits (degree 1) or 4, with steps of 1/16
/// and 1/8. These exceed most harmonics of a room, so nearly all view dependence would be lost.
uint8_t packed_harmonic(float v) { return quantized(v * 128 + 128); }

std::string body_of(const GaussianModel& model) {
  const size_t n = model.size();
  const int bits = fractional_bits(model);
  std::string out;
  append_little(out, kSpzMagic);
  append_little(out, kSpzVersion);
  append_little(out, static_cast<uint32_t>(n));
  append_little(out, static_cast<uint8_t>(model.sh_degree));
  append_little(out, static_cast<uint8_t>(bits));
  append_little(out, static_cast<uint16_t>(0));  // flags, reserved
  for (const float p : model.positions) {
    const int32_t fixed =
        static_cast<int32_t>(std::lround(std::clamp(p * std::ldexp(1.f, bits), -8388608.f, 8388607.f)));
    for (int byte = 0; byte < 3; ++byte) out += static_cast<char>(fixed >> (8 * byte) & 0xff);
  }
  for (size_t i = 0; i < n; ++i) out += static_cast<char>(quantized(255 * opacity_of(model, i)));
  for (size_t i = 0; i < n; ++i) {
    for (size_t c = 0; c < 3; ++c)
      out += static_cast<char>(quantized((model.sh[3 * kShCoefficients * i + c] * kColorScale + 0.5f) * 255));
  }
  for (const float s : model.log_scales) out += static_cast<char>(quantized((s + 10) * 16));
  for (size_t i = 0; i < n; ++i) {
    const float* r = &model.rotations[4 * i];
    append_little(out, packed_rotation(normalized(Quaternionf{r[0], r[1], r[2], r[3]})));
  }
  for (size_t i = 0; i < n; ++i) {
    for (int k = 1; k < sh_coefficient_count(model.sh_degree); ++k) {
      for (size_t c = 0; c < 3; ++c) {
        out += static_cast<char>(packed_harmonic(model.sh[3 * (kShCoefficients * i + static_cast<size_t>(k)) + c]));
      }
    }
  }
  return out;
}

}  // namespace

std::string coarse_spz_warning(const GaussianModel& model, double extent) {
  constexpr double kFine = 1e-3;  // of the extent: 3 mm in a room
  const double step = std::ldexp(1.0, -fractional_bits(model));
  if (step <= kFine * extent) return {};
  float farthest = 0;
  for (const float p : model.positions) farthest = std::max(farthest, std::fabs(p));
  return fmt::format(
      "positions in SPZ have steps of {:.2g} units, which is more than a thousandth of the room: the farthest Gaussian "
      "is {:.3g} units from the origin. -f ply keeps them exactly",
      step, farthest);
}

ExportReport write_spz(const std::filesystem::path& path, const GaussianModel& model) {
  constexpr size_t kMost = 10'000'000;  // readers refuse more
  if (model.size() > kMost)
    throw Error({ErrorKind::kFailed, "SPZ readers take at most 10 million Gaussians", path, {}, "export as PLY"});
  const Mat3d half_turn{{1, 0, 0, 0, -1, 0, 0, 0, -1}};  // right-down-front to right-up-back
  write_file_atomically(path, gzip_compressed(body_of(rotated(model, half_turn)), kSpeedOverSize));
  return {.files = {path}, .gaussians = model.size()};
}

ExportReport write_splat(const std::filesystem::path& path, const GaussianModel& model) {
  std::string out;
  for (size_t i = 0; i < model.size(); ++i) {
    for (size_t a = 0; a < 3; ++a) append_little(out, model.positions[3 * i + a]);
    for (size_t a = 0; a < 3; ++a) append_little(out, std::exp(model.log_scales[3 * i + a]));
    const Vec3f color = base_color_of(model, i);
    for (int c = 0; c < 3; ++c) out += static_cast<char>(quantized(255 * color[c]));
    out += static_cast<char>(quantized(255 * opacity_of(model, i)));
    const float* r = &model.rotations[4 * i];
    const Quaternionf q = normalized(Quaternionf{r[0], r[1], r[2], r[3]});
    for (const float v : {q.w, q.x, q.y, q.z}) out += static_cast<char>(quantized(128 * v + 128));
  }
  write_file_atomically(path, out);
  return {.files = {path}, .gaussians = model.size()};
}

}  // namespace aligngs
