#include "scene/import/import_capture.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "core/error.h"
#include "core/log.h"
#include "io/image_file.h"
#include "io/output_place.h"
#include "io/resample.h"
#include "scene/depth_cloud.h"
#include "scene/import/view_selection.h"
#include "scene/scene_writer.h"
#include "scene/undistort.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct Selection {
  std::vector<int> train, test;
};

std::vector<int> indices_of(const Capture& capture, const std::vector<std::string>& names, const char* list, bool skip_lost) {
  std::map<std::string, int> by_name;
  for (size_t i = 0; i < capture.frames.size(); ++i) by_name[capture.frames[i].name] = static_cast<int>(i);
  std::vector<int> indices;
  std::string unknown;
  for (const std::string& name : names) {
    const auto found = by_name.find(name);
    if (found != by_name.end()) indices.push_back(found->second);
    else unknown += " " + name;
  }
  if (!unknown.empty() && !skip_lost) throw_bad_input(capture.folder, list, "no frame with a pose is called" + unknown, "use the names of the image files without extension");
  if (!unknown.empty()) log_warning("{}: these frames have no pose and are left out:{}", list, unknown);
  return indices;
}

Selection select(const Capture& capture, const ImportOptions& options, ThreadPool& pool) {
  const int given = (options.views > 0) + (options.stride > 0) + !options.train_names.empty();
  if (given > 1) throw_usage("give only one of --views, --stride and --train");
  Selection selection;
  const bool own_split = given == 0 && !capture.train.empty();
  if (options.views > 0) {
    ViewSelectionOptions view_options;
    view_options.count = options.views;
    selection.train = select_views(capture, view_options, pool);
  } else if (options.stride > 0) {
    selection.train = select_stride(capture, options.stride);
  } else if (!options.train_names.empty()) {
    selection.train = indices_of(capture, options.train_names, "--train", false);
  } else if (own_split) {
    selection.train = indices_of(capture, capture.train, "train.txt", true);
  } else if (capture.frames.size() > kMaxUnselected) {
    log_info("choosing {} of {} frames (--views, --stride or --train change that)", kDefaultViews, capture.frames.size());
    ViewSelectionOptions view_options;
    view_options.count = kDefaultViews;
    selection.train = select_views(capture, view_options, pool);
  } else {
    selection.train.resize(capture.frames.size());
    std::iota(selection.train.begin(), selection.train.end(), 0);
    if (!capture.test.empty()) {  // only test names came with the capture: the others train
      const std::vector<int> test = indices_of(capture, capture.test, "test list", true);
      std::erase_if(selection.train, [&](int i) { return std::find(test.begin(), test.end(), i) != test.end(); });
    }
  }
  if (!options.test_names.empty()) {
    selection.test = indices_of(capture, options.test_names, "--test", false);
  } else if (given == 0 && !capture.test.empty()) {
    selection.test = indices_of(capture, capture.test, "test.txt", true);
  } else {
    const int wanted = options.test_views >= 0 ? options.test_views : static_cast<int>(selection.train.size()) / 3;
    selection.test = select_test_views(capture, selection.train, wanted, pool);
  }
  std::erase_if(selection.test, [&](int i) { return std::find(selection.train.begin(), selection.train.end(), i) != selection.train.end(); });
  if (selection.train.empty()) throw_bad_input(capture.folder, "train", "no training view is left", "give other names");
  return selection;
}

/// NeuRIS' preparation of ScanNet: the middle 1248/1296 of the width and 936/968 of the height, resized to 640x480.
struct CropToNeuris {
  static constexpr int kWidth = 640, kHeight = 480;
  static constexpr double kShareX = 1248.0 / 1296, kShareY = 936.0 / 968;

  static Camera camera(const Camera& c) {
    Camera out = c;
    const double w = c.width * kShareX, h = c.height * kShareY;
    const double sx = kWidth / w, sy = kHeight / h;
    out.width = kWidth;
    out.height = kHeight;
    out.fx = c.fx * sx;
    out.fy = c.fy * sy;
    out.cx = (c.cx - (c.width - w) / 2) * sx;
    out.cy = (c.cy - (c.height - h) / 2) * sy;
    return out;
  }

  template <class T, class Sample>
  static Image<T> map(const Image<T>& image, Sample sample) {
    Image<T> out(kWidth, kHeight, image.channels);
    const double w = image.width * kShareX, h = image.height * kShareY;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double u = (image.width - w) / 2 + (x + 0.5) * w / kWidth, v = (image.height - h) / 2 + (y + 0.5) * h / kHeight;
        for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = sample(image, u, v, c);
      }
    }
    return out;
  }

  static float bilinear(const ImageF& image, double u, double v, int c) {
    const double x = std::clamp(u - 0.5, 0.0, image.width - 1.0), y = std::clamp(v - 0.5, 0.0, image.height - 1.0);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y), x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
    const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    return (image.at(x0, y0, c) * (1 - fx) + image.at(x1, y0, c) * fx) * (1 - fy) + (image.at(x0, y1, c) * (1 - fx) + image.at(x1, y1, c) * fx) * fy;
  }
  static float nearest(const ImageF& image, double u, double v, int c) {
    return image.at(std::clamp(static_cast<int>(u), 0, image.width - 1), std::clamp(static_cast<int>(v), 0, image.height - 1), c);
  }
};

/// One frame brought to a pinhole camera.
struct PreparedFrame {
  SceneViewParts parts;
  ImageF depth;   ///< sensor depth, scene units, may be smaller than the image
};

PreparedFrame prepare(const Capture& capture, const CapturedFrame& frame, const ImportOptions& options) {
  PreparedFrame out;
  const LensModel lens = lens_of(frame.camera, frame.image);
  Camera camera = lens.distorted() ? undistorted_camera(lens, frame.image) : lens.pinhole();
  out.depth = read_capture_depth(capture, frame);
  if (lens.distorted() && !out.depth.empty()) out.depth = undistort_depth(out.depth, lens, camera);
  if (lens.distorted() || options.neuris_crop) {
    ImageF image = to_float(read_image(frame.image));
    if (lens.distorted()) image = undistort_image(image, lens, camera);
    if (options.neuris_crop) {
      camera = CropToNeuris::camera(camera);
      image = CropToNeuris::map(image, CropToNeuris::bilinear);
      if (!out.depth.empty()) out.depth = CropToNeuris::map(out.depth, CropToNeuris::nearest);
    }
    Image<uint8_t> bytes(image.width, image.height, image.channels);
    for (size_t i = 0; i < image.data.size(); ++i) bytes.data[i] = static_cast<uint8_t>(std::clamp(image.data[i], 0.f, 1.f) * 255 + 0.5f);
    out.parts.image = std::move(bytes);
  } else {
    out.parts.image_file = frame.image;
  }
  camera.world_to_camera = frame.world_to_camera;
  out.parts.name = frame.name;
  out.parts.camera = camera;
  return out;
}

/// Keeps what the fused cloud needs of each training view.
struct CloudInputs {
  std::vector<Camera> cameras;
  std::vector<ImageF> depths, colors;

  void add(const PreparedFrame& frame) {
    const Image<uint8_t> bytes = frame.parts.image.empty() ? read_image(frame.parts.image_file) : frame.parts.image;
    ImageF color = to_float(bytes);
    if (color.channels == 4) {  // alpha plays no part here
      ImageF rgb(color.width, color.height, 3);
      for (size_t i = 0; i < rgb.pixels(); ++i) std::copy_n(&color.data[4 * i], 3, &rgb.data[3 * i]);
      color = std::move(rgb);
    }
    cameras.push_back(frame.parts.camera.resized(frame.depth.width, frame.depth.height));
    depths.push_back(frame.depth);
    colors.push_back(resize_area(color, frame.depth.width, frame.depth.height));
  }

  PointCloud fuse(double voxel, ThreadPool& pool) const {
    std::vector<DepthCloudView> views;
    for (size_t i = 0; i < cameras.size(); ++i) views.push_back({cameras[i], &depths[i], &colors[i], nullptr});
    DepthCloudOptions options;
    options.voxel = voxel;
    return fuse_depth_cloud(views, options, pool).cloud;
  }
};

/// Everything that is read: what was given, and the folders of the files that it refers to elsewhere.
std::vector<fs::path> sources_of(const Capture& capture, const ImportOptions& options) {
  std::set<fs::path> folders;
  for (const CapturedFrame& frame : capture.frames) {
    for (const fs::path& file : {frame.image, frame.depth}) {
      if (!file.empty()) folders.insert(real_place(file).parent_path());
    }
  }
  std::vector<fs::path> sources = options.sources.empty() ? std::vector<fs::path>{capture.folder} : options.sources;
  sources.insert(sources.end(), {options.sfm, capture.mesh});
  sources.insert(sources.end(), folders.begin(), folders.end());
  return sources;
}

}  // namespace

ImportReport import_capture(const Capture& capture, const fs::path& output, const ImportOptions& options, ThreadPool& pool) {
  const std::vector<fs::path> sources = sources_of(capture, options);
  require_scene_place(output, options.overwrite, sources);  // before views are chosen, which takes long
  const Selection selection = select(capture, options, pool);
  SceneWriter writer(output, options.overwrite, sources);
  ImportReport report;
  report.train = selection.train.size();
  report.test = selection.test.size();
  report.skipped = capture.skipped.size();
  const bool use_sfm = !options.sfm.empty();

  CloudInputs inputs;
  SceneParts parts;
  parts.split.train.emplace();
  parts.split.test.emplace();
  Progress progress(options.progress, "import", report.train + report.test);
  size_t done = 0;
  for (const bool train : {true, false}) {
    for (const int index : train ? selection.train : selection.test) {
      PreparedFrame frame = prepare(capture, capture.frames[index], options);
      if (!frame.depth.empty()) {
        if (train && !use_sfm) {
          inputs.add(frame);
          if (options.depth_prior) frame.parts.prior_depth = frame.depth;
          report.depth_prior = report.depth_prior || options.depth_prior;
        }
        if (capture.metric) frame.parts.truth_depth = std::move(frame.depth);
      }
      (train ? *parts.split.train : *parts.split.test).push_back(frame.parts.name);
      writer.add_view(frame.parts);
      progress.update(++done);
    }
  }

  if (use_sfm) {
    AlignedSfm sfm = align_sfm(capture, options.sfm);
    report.cloud_source = "sfm";
    report.sfm_rmse = sfm.rmse;
    report.sfm_cameras = sfm.cameras;
    parts.cloud = std::move(sfm.cloud);
  } else if (!inputs.cameras.empty()) {
    report.cloud_source = "sensor depth";
    parts.cloud = inputs.fuse(options.voxel, pool);
  } else if (capture.cloud.size() > 0) {
    report.cloud_source = "capture";
    parts.cloud = capture.cloud;
  } else {
    report.cloud_source = "none";
  }
  report.points = parts.cloud.size();
  parts.description = {capture.metric, capture.up, capture.layout + ", cloud from " + report.cloud_source};
  if (report.depth_prior) parts.priors.depth = PriorJson{"sensor", "", {}};
  parts.truth_mesh_file = capture.mesh;
  writer.finish(parts);
  return report;
}

}  // namespace aligngs
