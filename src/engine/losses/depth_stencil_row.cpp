#include "engine/losses/depth_stencil_row.h"

#include <cstddef>
#include <vector>

#include "core/target_clones.h"
#include "engine/formulas/normal_terms.h"
#include "engine/losses/normal_row.h"

namespace aligngs {
namespace {

constexpr int kCentral = static_cast<int>(FiniteDifference::kCentral);

// Neighbour flags of a row, 1 where the pixel is joined to the one on that side.
struct JoinedRow {
  std::vector<int> before, after, above, below;
};

// Joined, in the sense of depth_stencil, for pixels z and their neighbours in `other`.
template <class T>
ALIGNGS_ALWAYS_INLINE void join(const T* __restrict z, const uint8_t* __restrict valid, const T* other,
                                const uint8_t* other_valid, int count, bool as_printed, int* __restrict out) {
  const int least = as_printed ? kDepthLoose : kDepthTight, any = as_printed ? 1 : 0;
  for (int x = 0; x < count; ++x) {
    const T jump = other[x] - z[x], size = jump < T(0) ? -jump : jump;
    const int near = size <= T(kDepthJumpShare) * z[x] ? 1 : 0;
    out[x] = (near | any) & (int(valid[x]) >= least ? 1 : 0) & (int(other_valid[x]) >= least ? 1 : 0);
  }
}

template <class T>
ALIGNGS_ALWAYS_INLINE void stencils(const StencilMap<T>& map, int y, const T* __restrict inverse_length,
                                    bool as_printed, JoinedRow& joined, uint8_t* __restrict stencil) {
  const int width = map.width;
  const size_t row = static_cast<size_t>(y) * width;
  const T* z = map.depth + row;
  const uint8_t* valid = map.validity + row;
  join(z + 1, valid + 1, z, valid, width - 1, as_printed, joined.before.data() + 1);
  join(z, valid, z + 1, valid + 1, width - 1, as_printed, joined.after.data());
  if (y > 0) join(z, valid, z - width, valid - width, width, as_printed, joined.above.data());
  if (y + 1 < map.height) join(z, valid, z + width, valid + width, width, as_printed, joined.below.data());
  const int* __restrict before = joined.before.data();
  const int* __restrict after = joined.after.data();
  const int* __restrict above = joined.above.data();
  const int* __restrict below = joined.below.data();
  const int only = as_printed ? kCentral : 0;  // the one difference that counts; 0: any
  for (int x = 0; x < width; ++x) {
    const int h = static_cast<int>(difference_of(before[x] != 0, after[x] != 0)),
              v = static_cast<int>(difference_of(above[x] != 0, below[x] != 0));
    const int whole = only != 0 ? (h == only ? 1 : 0) & (v == only ? 1 : 0) : (h != 0 ? 1 : 0) & (v != 0 ? 1 : 0);
    stencil[x] = static_cast<uint8_t>((whole & (inverse_length[x] > T(0) ? 1 : 0)) != 0 ? h | v << 2 : 0);
  }
}

ALIGNGS_ALWAYS_INLINE bool has_before(int code) { return reach_of(static_cast<FiniteDifference>(code)).before != 0; }
ALIGNGS_ALWAYS_INLINE bool has_after(int code) { return reach_of(static_cast<FiniteDifference>(code)).after != 0; }

template <class T>
ALIGNGS_ALWAYS_INLINE void gather(const StencilMap<T>& map, int y, const uint8_t* __restrict stencil,
                                  T* __restrict in) {
  const int width = map.width;
  const size_t stride = static_cast<size_t>(width);
  const T* __restrict z = map.depth + static_cast<size_t>(y) * stride;
  // At the end of a row or column nothing is joined: the pixel replaces its neighbour.
  const T *above = y > 0 ? z - width : z, *below = y + 1 < map.height ? z + width : z;
  T *right = in + kInRight * stride, *left = in + kInLeft * stride, *top = in + kInTop * stride,
    *bottom = in + kInBottom * stride;
  for (int x = 0; x + 1 < width; ++x) right[x] = has_after(stencil[x] & 3) ? z[x + 1] : z[x];
  right[width - 1] = z[width - 1];
  left[0] = z[0];
  for (int x = 1; x < width; ++x) left[x] = has_before(stencil[x] & 3) ? z[x - 1] : z[x];
  for (int x = 0; x < width; ++x) top[x] = has_before(stencil[x] >> 2) ? above[x] : z[x];
  for (int x = 0; x < width; ++x) bottom[x] = has_after(stencil[x] >> 2) ? below[x] : z[x];
  T *right_offset = in + kInRightOffset * stride, *left_offset = in + kInLeftOffset * stride;
  T *top_offset = in + kInTopOffset * stride, *bottom_offset = in + kInBottomOffset * stride,
    *used = in + kInUsed * stride;
  for (int x = 0; x < width; ++x) {
    const int h = stencil[x] & 3, v = stencil[x] >> 2;
    right_offset[x] = has_after(h) ? T(1) : T(0);
    left_offset[x] = has_before(h) ? T(-1) : T(0);
    top_offset[x] = has_before(v) ? T(-1) : T(0);
    bottom_offset[x] = has_after(v) ? T(1) : T(0);
    used[x] = stencil[x] != 0 ? T(1) : T(0);
  }
}

template <class T>
ALIGNGS_ALWAYS_INLINE void scatter(const T* __restrict out, int y, const uint8_t* __restrict stencil, int width,
                                   int height, T* __restrict gradient) {
  const size_t stride = static_cast<size_t>(width);
  const T *right = out, *left = out + stride, *top = out + 2 * stride, *bottom = out + 3 * stride;
  T* __restrict here = gradient + static_cast<size_t>(y) * stride;
  for (int x = 0; x < width; ++x) {  // differences that stop at the pixel itself
    const int h = stencil[x] & 3, v = stencil[x] >> 2;
    const T across = (has_after(h) ? T(0) : right[x]) + (has_before(h) ? T(0) : left[x]);
    const T along = (has_before(v) ? T(0) : top[x]) + (has_after(v) ? T(0) : bottom[x]);
    here[x] += stencil[x] != 0 ? across + along : T(0);
  }
  for (int x = 0; x + 1 < width; ++x) here[x + 1] += has_after(stencil[x] & 3) ? right[x] : T(0);
  for (int x = 1; x < width; ++x) here[x - 1] += has_before(stencil[x] & 3) ? left[x] : T(0);
  if (y > 0) {
    T* __restrict above = here - width;
    for (int x = 0; x < width; ++x) above[x] += has_before(stencil[x] >> 2) ? top[x] : T(0);
  }
  if (y + 1 < height) {
    T* __restrict below = here + width;
    for (int x = 0; x < width; ++x) below[x] += has_after(stencil[x] >> 2) ? bottom[x] : T(0);
  }
}

JoinedRow& cleared(int width) {
  thread_local JoinedRow joined;
  for (std::vector<int>* side : {&joined.before, &joined.after, &joined.above, &joined.below}) {
    side->assign(static_cast<size_t>(width), 0);
  }
  return joined;
}

// Compiled per instruction set: function versions cannot be templates.
ALIGNGS_TARGET_CLONES
void fill_stencils(const StencilMap<float>& map, int y, const float* inverse_length, bool as_printed, JoinedRow& joined,
                   uint8_t* stencil) {
  stencils<float>(map, y, inverse_length, as_printed, joined, stencil);
}

}  // namespace

void depth_stencil_row(const StencilMap<float>& map, int y, const float* inverse_length, bool as_printed,
                       uint8_t* stencil) {
  fill_stencils(map, y, inverse_length, as_printed, cleared(map.width), stencil);
}
void depth_stencil_row(const StencilMap<double>& map, int y, const double* inverse_length, bool as_printed,
                       uint8_t* stencil) {
  stencils<double>(map, y, inverse_length, as_printed, cleared(map.width), stencil);
}

ALIGNGS_TARGET_CLONES
void gather_stencil_row(const StencilMap<float>& map, int y, const uint8_t* stencil, float* in) {
  gather<float>(map, y, stencil, in);
}
void gather_stencil_row(const StencilMap<double>& map, int y, const uint8_t* stencil, double* in) {
  gather<double>(map, y, stencil, in);
}

ALIGNGS_TARGET_CLONES
void scatter_stencil_row(const float* out, int y, const uint8_t* stencil, int width, int height, float* gradient) {
  scatter<float>(out, y, stencil, width, height, gradient);
}
void scatter_stencil_row(const double* out, int y, const uint8_t* stencil, int width, int height, double* gradient) {
  scatter<double>(out, y, stencil, width, height, gradient);
}

}  // namespace aligngs
