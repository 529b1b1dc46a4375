#include "mesh/fusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/log.h"
#include "core/progress.h"
#include "core/quantile.h"
#include "core/steady_seconds.h"
#include "mesh/face_filter.h"
#include "mesh/marching_cubes.h"
#include "mesh/tsdf_volume.h"
#include "mesh/unseen_surface.h"
#include "scene/depth_normals.h"

namespace aligngs {
namespace {

// In metres: finer than the 2 cm at which meshes are compared, coarser than depth noise.
constexpr double kMinVoxel = 0.005, kMaxVoxel = 0.015;
constexpr double kMinTruncation = 0.03, kMaxTruncation = 0.05;
constexpr double kFootprintsPerVoxel = 1.5;
constexpr double kResidualsPerVoxel = 0.75;  // finer voxels would mesh the noise of the depth, at four times the size
constexpr double kVoxelsPerTruncation = 4;
constexpr double kResidualsPerTruncation = 3;
constexpr double kMinVoxelsPerTruncation = 2;   // below, the field has no slope left to interpolate
constexpr double kMinComponentArea = 0.0025;    // m^2: 5 x 5 cm
constexpr double kMinComponentExtent = 0.10;    // m
constexpr double kUnseenTolerance = 0.03;       // m: thickness of things, and roughness of fused surfaces
constexpr double kHoleTolerance = 0.02;         // m: between a view's depth and the surface that closes a hole
constexpr double kMaxInterpolatedWeight = 0.3;  // of a photo's: it saw nothing itself
constexpr double kMaxNearness = 4;              // (median depth / depth)^2 is capped at its square
constexpr int kStatisticsStride = 4;            // pixels between the samples of medians

/// Half the diagonal of the box between the 5 % and 95 % quantiles of surface points and camera centres.
double extent_of(std::vector<double> (&coordinates)[3]) {
  double squared = 0;
  for (auto& values : coordinates) {
    const double size = nearest_rank_of(values, 0.95) - nearest_rank_of(values, 0.05);
    squared += size * size;
  }
  return 0.5 * std::sqrt(squared);
}

class Fusion {
 public:
  Fusion(const std::vector<FusionFrame>& frames, const FusionOptions& options, ThreadPool& pool)
      : frames_(frames), options_(options), pool_(pool) {}

  FusionResult run() {
    const double start = steady_seconds();
    check_fusion_frames(frames_);
    check_options();
    FusionResult result;
    choose_depth_range();
    if (report_.pixels > 0) {
      choose_lengths();
      weigh_pixels();
      result.mesh = fuse();
      report_.unseen_triangles =
          remove_unseen_surface(result.mesh, seeing_cameras(), kUnseenTolerance * report_.metre, pool_);
      report_.cleaning = clean_mesh(result.mesh, component_limits());
      close_holes(result.mesh);
      filter_noise(result.mesh);
    }
    report_.vertices = result.mesh.vertices.size();
    report_.triangles = result.mesh.triangles.size();
    report_.seconds = steady_seconds() - start;
    result.report = report_;
    return result;
  }

 private:
  void check_options() const {
    const auto in_unit = [](double v) { return v >= 0 && v <= 1; };
    if (!in_unit(options_.depth_quantile) || !in_unit(options_.single_view_weight) ||
        !in_unit(options_.contradicted_weight) || !in_unit(options_.min_cosine) || options_.interpolated_weight < 0 ||
        options_.interpolated_weight > kMaxInterpolatedWeight || options_.max_depth_factor <= 0) {
      throw_usage("a fusion setting is out of range",
                  "quantile, weights and cosine lie in [0, 1], interpolated_weight in [0, 0.3]");
    }
  }

  void choose_depth_range() {
    std::vector<double> depths;
    std::vector<double> coordinates[3];
    for (const FusionFrame& frame : frames_) {
      ++(frame.interpolated ? report_.interpolated_views : report_.training_views);
      if (frame.interpolated) continue;
      const ImageF usable = usable_depth(frame, options_.min_alpha, options_.max_depth);
      const Rigidd to_world = frame.camera.world_to_camera.inverse();
      for (int axis = 0; axis < 3; ++axis) coordinates[axis].push_back(to_world.translation[axis]);
      for (int y = 0; y < usable.height; y += kStatisticsStride) {
        for (int x = 0; x < usable.width; x += kStatisticsStride) {
          const double z = usable.at(x, y);
          if (z == 0) continue;
          depths.push_back(z);
          const Vec3d p = to_world * (frame.camera.ray(x + 0.5, y + 0.5) * z);
          for (int axis = 0; axis < 3; ++axis) coordinates[axis].push_back(p[axis]);
        }
      }
    }
    report_.max_depth = options_.max_depth > 0
                            ? options_.max_depth
                            : options_.max_depth_factor * nearest_rank_of(depths, options_.depth_quantile);
    report_.median_depth = nearest_rank_of(depths, 0.5);
    if (!options_.metric) {
      const double extent = options_.extent > 0 ? options_.extent : extent_of(coordinates);
      if (extent > 0) report_.metre = extent / kTypicalExtent;
    }
    for (const FusionFrame& frame : frames_) {
      depths_.push_back(usable_depth(frame, options_.min_alpha, report_.max_depth));
      if (frame.interpolated) continue;
      const auto& data = depths_.back().data;
      report_.pixels += data.size() - static_cast<size_t>(std::count(data.begin(), data.end(), 0.0f));
    }
  }

  void choose_lengths() {
    std::vector<double> footprints;
    for (size_t i = 0; i < frames_.size(); ++i) {
      if (frames_[i].interpolated) continue;
      const double focal = 0.5 * (frames_[i].camera.fx + frames_[i].camera.fy);
      for (int y = 0; y < depths_[i].height; y += kStatisticsStride) {
        for (int x = 0; x < depths_[i].width; x += kStatisticsStride) {
          if (const float z = depths_[i].at(x, y); z > 0) footprints.push_back(z / focal);
        }
      }
    }
    report_.median_footprint = nearest_rank_of(footprints, 0.5);
    report_.two_view_residual = two_view_residual(frames_, depths_, pool_);
    const double metre = report_.metre;
    const double finest =
        std::max(kFootprintsPerVoxel * report_.median_footprint, kResidualsPerVoxel * report_.two_view_residual);
    report_.voxel = options_.voxel > 0 ? options_.voxel : std::clamp(finest, kMinVoxel * metre, kMaxVoxel * metre);
    report_.truncation = options_.truncation;
    if (!(options_.truncation > 0)) {
      const double wanted =
          std::max(kVoxelsPerTruncation * report_.voxel, kResidualsPerTruncation * report_.two_view_residual);
      report_.truncation = std::max(std::clamp(wanted, kMinTruncation * metre, kMaxTruncation * metre),
                                    kMinVoxelsPerTruncation * report_.voxel);
    }
  }

  void weigh_pixels() {
    std::vector<Image<uint8_t>> supports(frames_.size());
    size_t counts[4] = {};
    for (size_t i = 0; i < frames_.size(); ++i) {
      if (frames_[i].interpolated) continue;
      supports[i] = pixel_support(frames_, depths_, i, pool_, options_.consistency);
      for (const uint8_t s : supports[i].data) ++counts[s];
    }
    const double total = static_cast<double>(std::max<size_t>(report_.pixels, 1));
    report_.confirmed = static_cast<double>(counts[static_cast<int>(PixelSupport::kConfirmed)]) / total;
    report_.single_view = static_cast<double>(counts[static_cast<int>(PixelSupport::kSingleView)]) / total;
    report_.contradicted = static_cast<double>(counts[static_cast<int>(PixelSupport::kContradicted)]) / total;
    weights_.resize(frames_.size());
    if (options_.tangent_distance) slopes_.resize(frames_.size());
    pool_.parallel_for(frames_.size(), 1, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        weights_[i] = weights_of(i, supports[i]);
        if (options_.tangent_distance) slopes_[i] = slopes_of(frames_[i]);
      }
    });
  }

  /// Weight of a pixel: cosine / depth^2 (relative to the median depth), times the factor of its support.
  ImageF weights_of(size_t index, const Image<uint8_t>& support) const {
    const FusionFrame& frame = frames_[index];
    ImageF fitted;
    if (frame.normal.empty()) fitted = camera_normals(depths_[index], frame.camera);
    const ImageF& normals = frame.normal.empty() ? fitted : frame.normal;
    ImageF weight(frame.camera.width, frame.camera.height, 1);
    for (int y = 0; y < weight.height; ++y) {
      for (int x = 0; x < weight.width; ++x) {
        const double z = depths_[index].at(x, y);
        if (z == 0) continue;
        const double nearness = std::min(report_.median_depth / z, kMaxNearness);
        const double factor = frame.interpolated ? options_.interpolated_weight : factor_of(support.at(x, y));
        const double facing = cosine(normals.pixel(x, y), frame.camera.ray(x + 0.5, y + 0.5));
        weight.at(x, y) = static_cast<float>(factor * facing * nearness * nearness);
      }
    }
    return weight;
  }

  /// -n . r per pixel, at least the flattest look that counts; 1 without a normal.
  ImageF slopes_of(const FusionFrame& frame) const {
    if (frame.normal.empty()) return {};
    ImageF slope(frame.camera.width, frame.camera.height, 1, 1.0f);
    for (int y = 0; y < slope.height; ++y) {
      for (int x = 0; x < slope.width; ++x) {
        const float* n = frame.normal.pixel(x, y);
        const Vec3d normal{n[0], n[1], n[2]}, ray = frame.camera.ray(x + 0.5, y + 0.5);
        const double length = norm(normal);
        if (length > 0)
          slope.at(x, y) = static_cast<float>(std::max(-dot(normal, ray) / length, options_.min_cosine * norm(ray)));
      }
    }
    return slope;
  }

  double factor_of(uint8_t support) const {
    switch (static_cast<PixelSupport>(support)) {
      case PixelSupport::kConfirmed:
        return 1;
      case PixelSupport::kSingleView:
        return options_.single_view_weight;
      case PixelSupport::kContradicted:
        return options_.contradicted_weight;
      case PixelSupport::kNone:
        break;
    }
    return 0;
  }

  /// 0 for a pixel that looks along the surface. Without a normal (a lone pixel, a corner) the least that counts.
  double cosine(const float* normal, const Vec3d& ray) const {
    const Vec3d n{normal[0], normal[1], normal[2]};
    const double length = norm(n);
    if (!(length > 0)) return options_.min_cosine;
    const double c = -dot(n, ray) / (length * norm(ray));
    return c > options_.min_cosine ? c : 0;
  }

  TsdfView view(size_t i) const {
    const FusionFrame& frame = frames_[i];
    TsdfView view;
    view.camera = &frame.camera;
    view.depth = &depths_[i];
    view.color = frame.color.empty() ? nullptr : &frame.color;
    view.weight = &weights_[i];
    view.slope = slopes_.empty() || slopes_[i].empty() ? nullptr : &slopes_[i];
    view.observed_only = frame.interpolated;
    return view;
  }

  TriangleMesh fuse() {
    TsdfOptions settings;
    settings.voxel = report_.voxel;
    settings.truncation = report_.truncation;
    settings.max_bytes = options_.max_bytes;
    settings.carve = options_.carve;
    TsdfVolume volume(settings);
    report_.budget_bytes = volume.max_bytes();
    for (size_t i = 0; i < frames_.size(); ++i) {
      if (!frames_[i].interpolated) volume.reserve(view(i), pool_);
    }
    report_.blocks = volume.blocks();
    report_.predicted_bytes = volume.predicted_bytes();
    log_info("fusion: voxel {:.4g}, truncation {:.4g}, {} blocks, {} of {} predicted", report_.voxel,
             report_.truncation, report_.blocks, format_bytes(report_.predicted_bytes),
             format_bytes(report_.budget_bytes));
    volume.allocate();
    // Interpolated views last: they only touch what training views have observed.
    std::vector<TsdfView> views;
    for (const bool interpolated : {false, true}) {
      for (size_t i = 0; i < frames_.size(); ++i) {
        if (frames_[i].interpolated == interpolated) views.push_back(view(i));
      }
    }
    if (options_.device) {
      log_info("fusion: on {}", options_.device->name());
      volume.integrate(views, *options_.device);
    } else {
      for (const TsdfView& v : views) volume.integrate(v, pool_);
    }
    return extract_surface(volume, pool_, {options_.min_weight});
  }

  std::vector<Camera> seeing_cameras() const {
    std::vector<Camera> cameras;
    for (const FusionFrame& frame : frames_) {
      if (!frame.interpolated) cameras.push_back(frame.camera);
    }
    return cameras;
  }

  void close_holes(TriangleMesh& mesh) {
    std::vector<HoleWitness> witnesses;
    for (size_t i = 0; i < frames_.size(); ++i) {
      if (!frames_[i].interpolated) witnesses.push_back({&frames_[i].camera, &depths_[i]});
    }
    HoleFillingOptions options;
    options.max_size = options_.max_hole;
    options.tolerance = kHoleTolerance * report_.metre;
    report_.holes = close_seen_borders(mesh, witnesses, options);
  }

  void filter_noise(TriangleMesh& mesh) {
    FaceFilterOptions options;
    options.rounds = options_.face_filter;
    options.max_shift = report_.voxel;
    filter_faces(mesh, options, pool_);
  }

  ComponentLimits component_limits() const {
    ComponentLimits limits;
    const double metre = report_.metre;
    limits.min_area =
        options_.min_component_area == 0 ? kMinComponentArea * metre * metre : options_.min_component_area;
    limits.min_extent =
        options_.min_component_extent == 0 ? kMinComponentExtent * metre : options_.min_component_extent;
    return limits;
  }

  const std::vector<FusionFrame>& frames_;
  const FusionOptions& options_;
  ThreadPool& pool_;
  FusionReport report_;
  std::vector<ImageF> depths_, weights_, slopes_;
};

}  // namespace

std::string FusionReport::text() const {
  return fmt::format(
      "{} views{}, voxel {:.4g}, truncation {:.4g}, depth up to {:.4g}, two-view residual {:.4g}, pixels {:.0f} % "
      "confirmed {:.0f} % single {:.0f} % contradicted, {} blocks, {} vertices, {} triangles, {} unseen ones removed, "
      "{} of {} components removed, {} of {} holes closed, {:.1f} s",
      training_views, interpolated_views ? fmt::format(" + {} interpolated", interpolated_views) : "", voxel,
      truncation, max_depth, two_view_residual, 100 * confirmed, 100 * single_view, 100 * contradicted, blocks,
      vertices, triangles, unseen_triangles, cleaning.removed_components, cleaning.components, holes.filled,
      holes.borders, seconds);
}

FusionResult fuse_depth(const std::vector<FusionFrame>& frames, const FusionOptions& options, ThreadPool& pool) {
  return Fusion(frames, options, pool).run();
}

}  // namespace aligngs
