#include "scene/import/import_capture.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "core/error.h"
#include "core/letter_case.h"
#include "core/log.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/output_place.h"
#include "io/resample.h"
#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/sensor_cloud.h"
#include "scene/import/view_selection.h"
#include "scene/mesh_ply.h"
#include "scene/photo_fit.h"
#include "scene/photo_mask.h"
#include "scene/prior_maps.h"
#include "scene/scene_check.h"
#include "scene/scene_writer.h"
#include "scene/undistort.h"
#include "scene/up_direction.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct Selection {
  std::vector<int> train, test;
};

/// The first line of a list that a spreadsheet has written.
bool is_header(const std::string& name) {
  static const std::set<std::string> kWords = {"name",      "names", "file",   "files",      "filename",
                                               "file_name", "image", "images", "image_name", "photo",
                                               "photos",    "frame", "frames", "view"};
  return kWords.count(lower_case(name)) > 0;
}

std::vector<int> indices_of(const Capture& capture, const std::vector<std::string>& names, const char* list,
                            bool skip_lost) {
  const FrameNames frames(capture.frames);
  std::set<std::string> lost;
  for (const LeftOut& frame : capture.left_out) lost.insert({frame.name, view_name_of(frame.name)});
  std::vector<int> indices;
  std::string unknown;
  for (const std::string& name : names) {
    const int found = frames.find(name);
    if (found >= 0)
      indices.push_back(found);
    else if (!lost.count(as_utf8(name)) && !lost.count(view_name_of(name)) &&
             !(&name == &names.front() && names.size() > 1 && is_header(name)))
      unknown += (unknown.empty() ? " " : ", ") + as_utf8(name);
  }
  if (!unknown.empty() && !skip_lost)
    throw_bad_input(capture.folder, list, "no frame with a pose is called" + unknown,
                    "use the names of the image files, one a line");
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
    selection.train = indices_of(capture, capture.train, "the training list of the capture", true);
  } else if (capture.frames.size() > kMaxUnselected) {
    log_info("choosing {} of {} frames (--views, --stride or --train change that)", kDefaultViews,
             capture.frames.size());
    ViewSelectionOptions view_options;
    view_options.count = kDefaultViews;
    selection.train = select_views(capture, view_options, pool);
  } else {
    selection.train.resize(capture.frames.size());
    std::iota(selection.train.begin(), selection.train.end(), 0);
    if (!capture.test.empty()) {  // only test names came with the capture: the others train
      const std::vector<int> test = indices_of(capture, capture.test, "the test list of the capture", true);
      std::erase_if(selection.train, [&](int i) { return std::find(test.begin(), test.end(), i) != test.end(); });
    }
  }
  if (!options.test_names.empty()) {
    selection.test = indices_of(capture, options.test_names, "--test", false);
  } else if (given == 0 && !capture.test.empty()) {
    selection.test = indices_of(capture, capture.test, "the test list of the capture", true);
  } else {
    const int wanted = options.test_views >= 0 ? options.test_views : static_cast<int>(selection.train.size()) / 3;
    selection.test = select_test_views(capture, selection.train, wanted, pool);
  }
  std::erase_if(selection.test, [&](int i) {
    return std::find(selection.train.begin(), selection.train.end(), i) != selection.train.end();
  });
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
        const double u = (image.width - w) / 2 + (x + 0.5) * w / kWidth,
                     v = (image.height - h) / 2 + (y + 0.5) * h / kHeight;
        for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = sample(image, u, v, c);
      }
    }
    return out;
  }

  static float bilinear(const ImageF& image, double u, double v, int c) {
    const double x = std::clamp(u - 0.5, 0.0, image.width - 1.0), y = std::clamp(v - 0.5, 0.0, image.height - 1.0);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y), x1 = std::min(x0 + 1, image.width - 1),
              y1 = std::min(y0 + 1, image.height - 1);
    const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    return (image.at(x0, y0, c) * (1 - fx) + image.at(x1, y0, c) * fx) * (1 - fy) +
           (image.at(x0, y1, c) * (1 - fx) + image.at(x1, y1, c) * fx) * fy;
  }
  static float nearest(const ImageF& image, double u, double v, int c) {
    return image.at(std::clamp(static_cast<int>(u), 0, image.width - 1),
                    std::clamp(static_cast<int>(v), 0, image.height - 1), c);
  }
};

/// One frame brought to a pinhole camera.
struct PreparedFrame {
  SceneViewParts parts;
  Image<uint8_t> pixels;  ///< of the view, also where its file is copied
  ImageF depth;           ///< sensor depth, scene units, may be smaller than the image
};

/// Four channels, the last one 255 where the mask (of any size) counts the pixel.
Image<uint8_t> with_mask(const Image<uint8_t>& image, const fs::path& file, const CapturedFrame& frame) {
  constexpr int kSeen = 128;  // of the image's own alpha
  const Image<uint8_t> mask = read_mask(file, frame.image, frame.upright, image.width, image.height);
  Image<uint8_t> out(image.width, image.height, 4);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::copy_n(image.pixel(x, y), 3, out.pixel(x, y));
      const bool seen = image.channels < 4 || image.at(x, y, 3) >= kSeen;
      out.at(x, y, 3) = mask.at(x, y) != 0 && seen ? 255 : 0;
    }
  }
  return out;
}

/// Whether the photo lost detail when it was stored, so that its copy may as well. PNG is as it was taken.
bool is_lossy(const fs::path& file) { return file.extension() != ".png" && file.extension() != ".PNG"; }

void require_usable_depth(const CapturedFrame& frame, const ImageF& depth, const Camera& camera) {
  require_same_aspect({1, depth.height, depth.width}, camera.width, camera.height, frame.depth, "size");
  if (std::none_of(depth.data.begin(), depth.data.end(), [](float z) { return z > 0; })) {
    throw_bad_input(frame.depth, "values", "no pixel has a depth", "leave this frame out");
  }
}

PreparedFrame prepare(const Capture& capture, const CapturedFrame& frame, const ImportOptions& options) {
  PreparedFrame out;
  const LensModel lens = lens_of(frame.camera, frame.image);
  Camera camera = lens.distorted() ? undistorted_camera(lens, frame.image) : lens.pinhole();
  out.depth = read_capture_depth(capture, frame);
  if (lens.distorted() && !out.depth.empty()) out.depth = undistort_depth(out.depth, lens, camera);
  const std::string bytes = read_file(frame.image);
  out.pixels = frame.upright ? decode_image(bytes, frame.image) : decode_stored_image(bytes, frame.image);
  const fs::path mask = frame.mask.empty() ? find_mask(frame.image) : frame.mask;
  if (!mask.empty()) out.pixels = with_mask(out.pixels, mask, frame);
  const bool common = is_common_picture(bytes, frame.image);
  const bool large = options.max_side > 0 && std::max(camera.width, camera.height) > options.max_side;
  if (lens.distorted() || options.neuris_crop || large) {
    ImageF image = to_float(out.pixels);
    if (lens.distorted()) image = undistort_image(image, lens, camera);
    if (options.neuris_crop) {
      camera = CropToNeuris::camera(camera);
      image = CropToNeuris::map(image, CropToNeuris::bilinear);
      if (!out.depth.empty()) out.depth = CropToNeuris::map(out.depth, CropToNeuris::nearest);
    }
    if (large) {
      const double scale = double(options.max_side) / std::max(camera.width, camera.height);
      camera =
          camera.resized(std::max(1, int(camera.width * scale + 0.5)), std::max(1, int(camera.height * scale + 0.5)));
      image = resize_area(image, camera.width, camera.height);
    }
    out.pixels = to_bytes(image);
  }
  if (lens.distorted() || options.neuris_crop || large || !mask.empty() || !common) {
    constexpr int kQuality = 95;  // artefacts stay below the noise of a camera
    out.parts.image = out.pixels;
    if (!lens.distorted() && is_lossy(frame.image)) out.parts.jpeg_quality = kQuality;
  } else {
    out.parts.image_file = frame.image;
  }
  if (!out.depth.empty()) require_usable_depth(frame, out.depth, camera);
  camera.world_to_camera = frame.world_to_camera;
  out.parts.name = frame.name;
  out.parts.camera = camera;
  return out;
}

/// Everything that is read: what was given, and the folders of the files that it refers to elsewhere.
std::vector<fs::path> sources_of(const Capture& capture, const ImportOptions& options) {
  std::set<fs::path> folders;
  for (const CapturedFrame& frame : capture.frames) {
    for (const fs::path& file : {frame.image, frame.depth, frame.confidence, frame.mask}) {
      if (!file.empty()) folders.insert(real_place(file).parent_path());
    }
  }
  std::vector<fs::path> sources = options.sources.empty() ? std::vector<fs::path>{capture.folder} : options.sources;
  sources.insert(sources.end(), {options.sfm, capture.mesh});
  sources.insert(sources.end(), folders.begin(), folders.end());
  return sources;
}

}  // namespace

namespace {

/// Up as the layout has it, unless the cameras contradict; else from the floor or the cameras.
void set_up(const Capture& capture, SceneParts& parts) {
  std::vector<ViewUp> views;
  for (const CapturedFrame& frame : capture.frames) {
    views.push_back(view_up(frame.world_to_camera, frame.upright ? 1 : read_image_info(frame.image).orientation));
  }
  if (capture.up && agrees_with(views, *capture.up, capture.up_measured)) {
    parts.description.up = capture.up;
    parts.description.up_source = capture.up_source;
    return;
  }
  std::vector<Vec3d> points;
  for (const Vec3f& p : parts.cloud.positions) points.push_back(p.cast<double>());
  const auto up = estimate_up(views, {}, points);
  if (!up) return;
  parts.description.up = up->direction;
  parts.description.up_source = up->source;
}

PointCloud narrow(const CapturedCloud& cloud) {
  PointCloud out;
  for (const Vec3d& p : cloud.positions) out.positions.push_back(p.cast<float>());
  out.colors = cloud.colors;
  return out;
}

/// The reference mesh in the capture's world.
void set_truth_mesh(const Capture& capture, SceneParts& parts) {
  if (capture.mesh.empty() || !capture.to_original) {
    parts.truth_mesh_file = capture.mesh;
    return;
  }
  parts.truth_mesh = read_mesh_ply(capture.mesh);
  const Similarity from_original = capture.to_original->inverse();
  for (Vec3f& vertex : parts.truth_mesh.vertices) vertex = (from_original * vertex.cast<double>()).cast<float>();
}

/// The same check that training begins with; views that it refuses leave the split.
void check_as_training_does(const fs::path& folder, SplitJson& split, ImportReport& report) {
  Scene scene = open_scene(folder);
  const std::vector<SceneProblem> problems = leave_out_bad_views(scene, check_scene(scene));
  for (const SceneProblem& problem : problems) {
    if (problem.fatal) throw_bad_input(problem.path, problem.field, problem.message, problem.remedy);
    if (problem.field == kDepthOfViews) continue;  // SensorCloud has asked, and tells the unit of the files
    const std::string place = problem.path.lexically_relative(folder).generic_string();
    report.warnings.push_back((place == "." ? "" : place + ": ") + problem.message);
  }
  if (scene.left_out.empty()) return;
  report.left_out.insert(report.left_out.end(), scene.left_out.begin(), scene.left_out.end());
  for (const LeftOut& view : scene.left_out) {
    for (auto* list : {&*split.train, &*split.test}) std::erase(*list, view.name);
  }
  write_split_json(folder / "split.json", split);
}

}  // namespace

ImportReport import_capture(const Capture& capture, const fs::path& output, const ImportOptions& options,
                            ThreadPool& pool) {
  const std::vector<fs::path> sources = sources_of(capture, options);
  require_scene_place(output, options.overwrite, sources);  // before views are chosen, which takes long
  const Selection selection = select(capture, options, pool);
  SceneWriter writer(output, options.overwrite, sources);
  ImportReport report;
  report.left_out = capture.left_out;
  const bool use_sfm = !options.sfm.empty();

  SensorCloud sensor;
  SceneParts parts;
  parts.split.train.emplace();
  parts.split.test.emplace();
  Progress progress(options.progress, "import", selection.train.size() + selection.test.size());
  size_t done = 0;
  for (const bool train : {true, false}) {
    for (const int index : train ? selection.train : selection.test) {
      const CapturedFrame& captured = capture.frames[static_cast<size_t>(index)];
      use_or_leave_out(captured.name, report.left_out, [&] {
        PreparedFrame frame = prepare(capture, captured, options);
        const bool depth_prior = train && !use_sfm && !frame.depth.empty() && options.depth_prior;
        if (train && !use_sfm && !frame.depth.empty()) sensor.add(frame.parts.camera, frame.depth, frame.pixels);
        if (depth_prior) frame.parts.prior_depth = frame.depth;
        report.depth_prior = report.depth_prior || depth_prior;
        if (capture.metric) frame.parts.truth_depth = std::move(frame.depth);
        writer.add_view(frame.parts);
        (train ? *parts.split.train : *parts.split.test).push_back(frame.parts.name);
      });
      progress.update(++done);
    }
  }
  const auto require_enough_frames = [&] {
    const size_t kept = parts.split.train->size() + parts.split.test->size();
    const bool few = parts.split.train->size() < kFewestTrainingViews;
    require_enough(capture.folder, kept, report.left_out, few ? kept + 1 : 0, options.strict);
  };
  require_enough_frames();

  if (use_sfm) {
    AlignedSfm sfm = align_sfm(capture, options.sfm);
    report.cloud_source = "sfm";
    report.sfm_rmse = sfm.rmse;
    report.sfm_cameras = sfm.cameras;
    parts.cloud = std::move(sfm.cloud);
  } else if (!sensor.empty()) {
    report.cloud_source = "sensor depth";
    const std::string warning = sensor.contradiction(capture.metric, capture.depth_unit, narrow(capture.cloud));
    if (!warning.empty()) report.warnings.push_back(warning);
    parts.cloud = sensor.fuse(options.voxel, pool);
  } else if (capture.cloud.size() > 0) {
    report.cloud_source = "capture";
    parts.cloud = narrow(capture.cloud);
  } else {
    report.cloud_source = "none";
  }
  report.points = parts.cloud.size();
  parts.description.metric = capture.metric;
  parts.description.source = capture.layout + ", cloud from " + report.cloud_source;
  parts.description.to_original = capture.to_original;
  set_up(capture, parts);
  if (report.depth_prior) {
    parts.priors.depth = PriorJson{kSensorDepth, "", {}};
    parts.priors.depth_scale = DepthScale::kScene;
  }
  set_truth_mesh(capture, parts);
  writer.write(parts);
  try {
    check_as_training_does(writer.folder(), parts.split, report);
  } catch (const Error& error) {  // about a folder that is gone when somebody reads the message
    Error::Details details = error.details();
    if (lies_within(details.path, writer.folder())) details.path = capture.folder;
    throw Error(details);
  }
  require_enough_frames();
  writer.commit();
  report.train = parts.split.train->size();
  report.test = parts.split.test->size();
  return report;
}

}  // namespace aligngs
