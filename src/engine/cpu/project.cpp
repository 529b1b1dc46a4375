#include "engine/cpu/project.h"

#include <cmath>

#include "core/error.h"
#include "engine/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/project.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/gaussian_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

constexpr float kHalfLog2E = 0.72134752f;  ///< log2(e) / 2: exp(-m / 2) = 2^(-kHalfLog2E m)
constexpr float kLn2 = 0.69314718f;
/// The box is widened as in projection.h: relative and pixels.
constexpr float kWiden = 1.0001f, kMargin = 1e-3f;

HWY_INLINE hn::Mask<FloatTag> finite(FloatVec x) { return hn::Eq(hn::Sub(x, x), hn::Zero(FloatTag())); }

/// pixel_range of projection.h, as numbers.
HWY_INLINE void range(FloatVec mean, FloatVec extent, int size, FloatVec& first, FloatVec& end) {
  const FloatVec zero = hn::Zero(FloatTag()), top = constant(static_cast<float>(size)), half = constant(0.5f);
  first = hn::Min(hn::Max(hn::Ceil(hn::Sub(hn::Sub(mean, extent), half)), zero), top);
  end = hn::Min(hn::Max(hn::Add(hn::Floor(hn::Sub(hn::Add(mean, extent), half)), constant(1.0f)), zero), top);
}

/// Results of a batch, for the scalar code that stores them.
struct LaneBatch {
  HWY_ALIGN float fields[17][kLanes];  ///< in the order of Splat
  HWY_ALIGN float radius[kLanes], visible[kLanes], suspect[kLanes];
  HWY_ALIGN float x0[kLanes], y0[kLanes], x1[kLanes], y1[kLanes];  ///< pixels
};

/// Rows are loaded as quads and turned: gathers take several times as long. A quad of three numbers ends in the next
/// row, which the last one does not have.
HWY_INLINE void load_shapes(const GaussianModel& model, size_t first, const int32_t* rows, LaneShape& g) {
  const FloatTag d;
  HWY_ALIGN float position[4][kLanes], scale[4][kLanes], rotation[4][kLanes], opacity[kLanes];
  const float *positions[kLanes], *scales[kLanes], *rotations[kLanes];
  bool last = false;
  for (size_t k = 0; k < kLanes; ++k) {
    const size_t row = first + static_cast<size_t>(rows[k]);
    last |= row + 1 == model.size();
    positions[k] = model.positions.data() + 3 * row;
    scales[k] = model.log_scales.data() + 3 * row;
    rotations[k] = model.rotations.data() + 4 * row;
    opacity[k] = model.opacity_logits[row];
  }
  rows_to_lanes(rotations, 4, rotation);
  if (last) {
    for (size_t k = 0; k < kLanes; ++k) {
      for (size_t j = 0; j < 3; ++j) position[j][k] = positions[k][j];
      for (size_t j = 0; j < 3; ++j) scale[j][k] = scales[k][j];
    }
  } else {
    rows_to_lanes(positions, 4, position);
    rows_to_lanes(scales, 4, scale);
  }
  g.position = {hn::Load(d, position[0]), hn::Load(d, position[1]), hn::Load(d, position[2])};
  g.log_scale = {hn::Load(d, scale[0]), hn::Load(d, scale[1]), hn::Load(d, scale[2])};
  for (int k = 0; k < 4; ++k) g.rotation[k] = hn::Load(d, rotation[k]);
  g.opacity_logit = hn::Load(d, opacity);
}

/// The vector twin of project() in engine/formulas/projection.h and sh_color() in color.h, for the rows at `offsets`
/// from `first`.
void project_lanes(const GaussianModel& model, size_t first, const int32_t* rows, const ProjectionCamera<float>& camera,
                   const RasterSettings& raster, int sh_degree, LaneBatch& out) {
  const FloatTag d;
  LaneShape g;
  load_shapes(model, first, rows, g);

  const FloatVec zero = hn::Zero(d), one = constant(1.0f);
  const FloatVec parameters = hn::Add(
      hn::Add(hn::Add(g.position.x, hn::Add(g.position.y, g.position.z)),
              hn::Add(g.log_scale.x, hn::Add(g.log_scale.y, g.log_scale.z))),
      hn::Add(hn::Add(hn::Add(g.rotation[0], g.rotation[1]), hn::Add(g.rotation[2], g.rotation[3])), g.opacity_logit));
  const auto good = finite(parameters);
  const LaneCamera c(camera);
  const Lanes3 centre = c.to_camera(g.position);
  // exp(-logit) for logits down to -88 is finite; below, the opacity is 0 anyway.
  const FloatVec factor = constant(raster.dropout.factor());
  const FloatVec opacity =
      hn::Div(factor, hn::Add(one, fast_exp(d, hn::Min(hn::Neg(g.opacity_logit), constant(88.0f)))));
  auto visible = hn::And(
      good, hn::And(hn::Gt(centre.z, constant(raster.near_plane)), hn::Ge(opacity, constant(raster.alpha_min))));
  hn::Store(hn::IfThenElse(good, zero, one), d, out.suspect);
  hn::Store(zero, d, out.visible);
  if (hn::AllFalse(d, visible)) return;

  LaneFrame f;
  lane_frame(g, c, camera, centre, f);
  const FloatVec mean_x = hn::MulAdd(c.fx, f.raw_slope_x, c.cx), mean_y = hn::MulAdd(c.fy, f.raw_slope_y, c.cy);
  const FloatVec low_pass = constant(raster.low_pass);
  const FloatVec uu = dot3(f.u[0], f.u[0], f.u[1], f.u[1], f.u[2], f.u[2]);
  const FloatVec vv = dot3(f.v[0], f.v[0], f.v[1], f.v[1], f.v[2], f.v[2]);
  const FloatVec xy = dot3(f.u[0], f.v[0], f.u[1], f.v[1], f.u[2], f.v[2]);
  const FloatVec xx = hn::Add(uu, low_pass), yy = hn::Add(vv, low_pass);
  const Lanes3 area{hn::MulSub(f.u[1], f.v[2], hn::Mul(f.u[2], f.v[1])),
                    hn::MulSub(f.u[2], f.v[0], hn::Mul(f.u[0], f.v[2])),
                    hn::MulSub(f.u[0], f.v[1], hn::Mul(f.u[1], f.v[0]))};
  const FloatVec det = hn::Add(dot(area, area), hn::MulAdd(low_pass, hn::Add(uu, vv), hn::Mul(low_pass, low_pass)));
  visible = hn::And(visible, hn::And(finite(det), hn::Gt(det, zero)));
  visible = hn::And(visible, hn::And(finite(mean_x), finite(mean_y)));

  const auto is_1 = hn::Lt(g.log_scale.y, g.log_scale.x);
  const auto is_2 = hn::Lt(g.log_scale.z, hn::Min(g.log_scale.x, g.log_scale.y));
  Lanes3 normal = select_column(f.axes, is_1, is_2);
  const FloatVec facing = hn::Neg(dot(normal, centre));
  normal = scaled(normal, hn::IfThenElse(hn::Ge(facing, zero), one, constant(-1.0f)));
  const FloatVec distance = hn::Abs(facing);
  const FloatVec reach = hn::Mul(constant(3.0f), hn::Max(f.scale[0], hn::Max(f.scale[1], f.scale[2])));
  const FloatVec z_max = hn::Add(centre.z, reach);
  const FloatVec z_min = hn::Max(hn::Sub(centre.z, reach), constant(raster.near_plane));
  const FloatVec half_sum = hn::Mul(constant(0.5f), hn::Add(xx, yy));
  const FloatVec half_difference = hn::Mul(constant(0.5f), hn::Sub(xx, yy));
  const FloatVec spread = hn::Sqrt(hn::MulAdd(half_difference, half_difference, hn::Mul(xy, xy)));
  const FloatVec radius = hn::Mul(constant(3.0f), hn::Sqrt(hn::Add(half_sum, spread)));
  const FloatVec log_ratio = fast_log(d, hn::Max(one, hn::Div(opacity, constant(raster.alpha_min))));
  const FloatVec level = hn::Add(log_ratio, log_ratio);
  const auto extent = [&](FloatVec variance) HWY_ATTR {
    return hn::MulAdd(constant(kWiden), hn::Sqrt(hn::Mul(level, variance)), constant(kMargin));
  };
  FloatVec x0, x1, y0, y1;
  range(mean_x, extent(xx), camera.width, x0, x1);
  range(mean_y, extent(yy), camera.height, y0, y1);
  visible = hn::And(visible, hn::And(finite(radius), hn::And(finite(distance), finite(z_max))));
  visible = hn::And(visible, hn::And(hn::Lt(x0, x1), hn::Lt(y0, y1)));
  // F of log2(e)/2 A with A the inverse covariance.
  const FloatVec fxx = hn::Sqrt(hn::Div(hn::Mul(constant(kHalfLog2E), yy), det));
  const FloatVec fxy = hn::Neg(hn::Div(hn::Mul(constant(kHalfLog2E), hn::Div(xy, det)), fxx));
  const FloatVec fyy = hn::Sqrt(hn::Div(constant(kHalfLog2E), yy));
  visible = hn::And(visible, hn::And(finite(fxx), hn::And(finite(fxy), finite(fyy))));
  if (hn::AllFalse(d, visible)) return;

  Lanes3 ray{hn::Sub(g.position.x, c.centre[0]), hn::Sub(g.position.y, c.centre[1]),
             hn::Sub(g.position.z, c.centre[2])};
  const FloatVec length = hn::Sqrt(dot(ray, ray));
  ray = scaled(ray, hn::IfThenElseZero(hn::Gt(length, zero), hn::Div(one, length)));
  FloatVec basis[kShCoefficients];
  lane_sh_basis(sh_degree, ray, basis);
  const float* sh_rows[kLanes];
  for (size_t k = 0; k < kLanes; ++k) {
    sh_rows[k] = model.sh.data() + 3 * kShCoefficients * (first + static_cast<size_t>(rows[k]));
  }
  HWY_ALIGN float sh[3 * kShCoefficients][kLanes];
  rows_to_lanes(sh_rows, whole_quads(static_cast<size_t>(3 * sh_coefficient_count(sh_degree))), sh);
  FloatVec color[3] = {constant(0.5f), constant(0.5f), constant(0.5f)};
  for (int k = 0; k < sh_coefficient_count(sh_degree); ++k) {
    for (int ch = 0; ch < 3; ++ch) color[ch] = hn::MulAdd(hn::Load(d, sh[3 * k + ch]), basis[k], color[ch]);
  }
  const auto bad_color = hn::Not(finite(hn::Add(color[0], hn::Add(color[1], color[2]))));
  hn::Store(hn::IfThenElse(hn::Or(hn::Not(good), hn::And(visible, bad_color)), one, zero), d, out.suspect);
  visible = hn::AndNot(bad_color, visible);
  hn::Store(hn::IfThenElse(visible, one, zero), d, out.visible);

  const FloatVec fields[17] = {mean_x,
                               mean_y,
                               fxx,
                               fxy,
                               fyy,
                               opacity,
                               hn::Mul(log_ratio, constant(1.0f / kLn2)),
                               hn::Max(color[0], zero),
                               hn::Max(color[1], zero),
                               hn::Max(color[2], zero),
                               normal.x,
                               normal.y,
                               normal.z,
                               distance,
                               centre.z,
                               z_min,
                               z_max};
  for (int k = 0; k < 17; ++k) hn::Store(fields[k], d, out.fields[k]);
  hn::Store(radius, d, out.radius);
  hn::Store(x0, d, out.x0);
  hn::Store(y0, d, out.y0);
  hn::Store(x1, d, out.x1);
  hn::Store(y1, d, out.y1);
}

/// Projects rows [begin, end); returns the first row that may have a parameter that is not finite, or -1.
int64_t ProjectRows(const GaussianModel& model, const RasterSettings& raster, int sh_degree, size_t begin, size_t end,
                    ProjectedView& view) {
  int64_t suspect = -1;
  LaneBatch batch;
  int32_t rows[kLanes];
  for (size_t i = begin; i < end; i += kLanes) {
    const size_t n = HWY_MIN(kLanes, end - i);
    for (size_t k = 0; k < kLanes; ++k) rows[k] = static_cast<int32_t>(HWY_MIN(k, n - 1));
    project_lanes(model, i, rows, view.camera, raster, sh_degree, batch);
    for (size_t k = 0; k < n; ++k) {
      if (batch.suspect[k] != 0 && suspect < 0) suspect = static_cast<int64_t>(i + k);
      view.rects[i + k] = {};
      if (batch.visible[k] == 0 || raster.dropout.drops(i + k)) continue;
      const IntegerRect tiles = tiles_of({static_cast<int>(batch.x0[k]), static_cast<int>(batch.y0[k]),
                                          static_cast<int>(batch.x1[k]), static_cast<int>(batch.y1[k])});
      view.rects[i + k] = {static_cast<uint16_t>(tiles.x0), static_cast<uint16_t>(tiles.y0),
                           static_cast<uint16_t>(tiles.x1), static_cast<uint16_t>(tiles.y1)};
      view.radius[i + k] = batch.radius[k];
      float* splat = reinterpret_cast<float*>(&view.splats[i + k]);
      for (int field = 0; field < 17; ++field) splat[field] = batch.fields[field][k];
    }
  }
  return suspect;
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {
namespace {

constexpr size_t kProjectedRowsPerTask = 512;  ///< rows per task

bool row_is_finite(const GaussianModel& model, size_t i) {
  float sum = 0;
  for (int k = 0; k < 3; ++k) sum += 0 * model.positions[3 * i + k] + 0 * model.log_scales[3 * i + k];
  for (int k = 0; k < 4; ++k) sum += 0 * model.rotations[4 * i + k];
  for (int k = 0; k < 3 * kShCoefficients; ++k) sum += 0 * model.sh[3 * kShCoefficients * i + k];
  return is_finite(sum + 0 * model.opacity_logits[i]);
}

}  // namespace

HWY_EXPORT(ProjectRows);

void project_view(const GaussianModel& model, const Camera& camera, const RasterSettings& raster, int sh_degree,
                  ThreadPool& pool, ProjectedView& view) {
  const size_t n = model.size();
  view.camera = make_projection_camera<float>(camera, raster);
  view.width = camera.width;
  view.height = camera.height;
  view.tiles_x = (camera.width + kTileSize - 1) / kTileSize;
  view.tiles_y = (camera.height + kTileSize - 1) / kTileSize;
  if (view.tiles_x > 65535 || view.tiles_y > 65535) {
    throw Error({ErrorKind::kFailed,
                 "the camera's image is larger than a million pixels on a side",
                 {},
                 "camera",
                 "render at a smaller size"});
  }
  view.splats.resize(n);
  view.rects.resize(n);
  view.radius.resize(n);
  std::vector<int64_t> suspects((n + kProjectedRowsPerTask - 1) / kProjectedRowsPerTask, -1);
  pool.parallel_for(n, kProjectedRowsPerTask, [&](size_t begin, size_t end, int) {
    suspects[begin / kProjectedRowsPerTask] =
        HWY_DYNAMIC_DISPATCH(ProjectRows)(model, raster, sh_degree, begin, end, view);
  });
  view.non_finite = -1;
  for (const int64_t row : suspects) {
    // A finite row whose image overflows is only culled.
    if (row >= 0 && view.non_finite < 0 && !row_is_finite(model, static_cast<size_t>(row))) view.non_finite = row;
  }
}

}  // namespace aligngs::cpu
#endif
