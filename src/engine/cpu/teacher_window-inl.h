// Bilinear samples of the teacher under one block of pixels; compiled once per instruction set.
#if defined(ALIGNGS_ENGINE_CPU_TEACHER_WINDOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_TEACHER_WINDOW_INL_H_
#undef ALIGNGS_ENGINE_CPU_TEACHER_WINDOW_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_TEACHER_WINDOW_INL_H_
#endif

#include <cmath>
#include <cstring>

#include <hwy/highway.h>

#include "core/half.h"
#include "engine/cpu/semantic_block.h"
#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// kLanes half-precision numbers as float.
HWY_INLINE FloatVec load_half(const uint16_t* p) {
  const FloatTag d;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3  // these convert in hardware
  const hn::Rebind<hwy::float16_t, FloatTag> dh;
  return hn::PromoteTo(d, hn::LoadU(dh, reinterpret_cast<const hwy::float16_t*>(p)));
#else
  HWY_ALIGN float values[kLanes];
  for (size_t i = 0; i < kLanes; ++i) values[i] = half_to_float(p[i]);
  return hn::Load(d, values);
#endif
}

/// out[0 .. padded) = scale row[0 .. channels) as float, zero-padded.
HWY_INLINE void load_half_row(const uint16_t* row, float scale, size_t channels, size_t padded,
                              float* HWY_RESTRICT out) {
  const FloatTag d;
  const FloatVec factor = hn::Set(d, scale);
  size_t c = 0;
  for (; c + kLanes <= channels; c += kLanes) hn::Store(hn::Mul(factor, load_half(row + c)), d, out + c);
  if (c < channels) {  // the tail is copied so that nothing behind the map is read
    uint16_t tail[kLanes] = {};
    std::memcpy(tail, row + c, (channels - c) * sizeof(uint16_t));
    hn::Store(hn::Mul(factor, load_half(tail)), d, out + c);
    c += kLanes;
  }
  for (; c < padded; c += kLanes) hn::Store(hn::Zero(d), d, out + c);
}

/// Position of pixel i of a line of `size` in a line of `source` pixels; the rule of teacher_taps.
HWY_INLINE void source_pair(int i, int size, int source, int& low, int& high, float& share) {
  const double at = (i + 0.5) * source / size - 0.5, floor_at = std::floor(at);
  share = static_cast<float>(at - floor_at);
  low = static_cast<int>(floor_at);
  high = HWY_MIN(low + 1, source - 1);
  low = HWY_MIN(HWY_MAX(low, 0), source - 1);
  if (high < 0) high = 0;
}

HWY_INLINE TeacherWindow teacher_window(const SemanticTarget& target, int x, int y, int width, int height) {
  TeacherWindow w;
  for (int i = 0; i < kBlockSize; ++i) {  // pixels beyond the image repeat the last one
    source_pair(HWY_MIN(x + i, width - 1), width, target.width, w.column0[i], w.column1[i], w.column_share[i]);
    source_pair(HWY_MIN(y + i, height - 1), height, target.height, w.row0[i], w.row1[i], w.row_share[i]);
  }
  w.first_column = w.column0[0];
  w.columns = w.column1[kBlockSize - 1] + 1 - w.first_column;
  // A teacher much finer than the image leaves gaps between the pixels' columns: those are not worth blending.
  w.separable = w.columns <= 2 * kBlockSize;
  if (!w.separable || target.confidence.empty()) return w;
  for (int r = w.row0[0]; r <= w.row1[kBlockSize - 1] && w.separable; ++r) {
    const float* confidence = &target.confidence[size_t(r) * target.width + w.first_column];
    for (int c = 0; c < w.columns; ++c) w.separable &= confidence[c] > 0;
  }
  return w;
}

/// The window as float, [row][column][padded], from row0[0] on.
HWY_INLINE void load_teacher_window(const SemanticTarget& target, const TeacherWindow& w, size_t padded,
                                    AlignedArray<float>& out) {
  const size_t channels = static_cast<size_t>(target.channels);
  const int rows = w.row1[kBlockSize - 1] + 1 - w.row0[0];
  out.resize(static_cast<size_t>(rows) * w.columns * padded);
  float* to = out.data();
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < w.columns; ++c, to += padded) {
      const size_t pixel = size_t(w.row0[0] + r) * target.width + w.first_column + c;
      load_half_row(&target.probabilities[pixel * channels], target.scale.empty() ? 1.0f : target.scale[pixel],
                    channels, padded, to);
    }
  }
}

/// Blends the window's rows for pixel row j into columns[column][padded].
HWY_INLINE void blend_teacher_rows(const float* window, const TeacherWindow& w, int j, size_t padded,
                                   float* HWY_RESTRICT columns) {
  const FloatTag d;
  const size_t row_length = static_cast<size_t>(w.columns) * padded;
  const float* HWY_RESTRICT first = window + static_cast<size_t>(w.row0[j] - w.row0[0]) * row_length;
  const float* HWY_RESTRICT second = window + static_cast<size_t>(w.row1[j] - w.row0[0]) * row_length;
  const FloatVec first_share = hn::Set(d, 1 - w.row_share[j]), second_share = hn::Set(d, w.row_share[j]);
  for (size_t i = 0; i < row_length; i += kLanes) {
    const FloatVec low = hn::Mul(first_share, hn::Load(d, first + i));
    hn::Store(hn::MulAdd(second_share, hn::Load(d, second + i), low), d, columns + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
