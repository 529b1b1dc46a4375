#include "priors/scene_from_photos.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/log.h"
#include "core/steady_seconds.h"
#include "io/picture_format.h"
#include "io/text_encoding.h"
#include "priors/given_poses.h"
#include "priors/scene_by_network.h"
#include "priors/teacher_list.h"
#include "priors/test_photos.h"
#include "priors/video_frames.h"
#include "priors/work_folder.h"
#include "scene/import/import_capture.h"
#include "scene/photo_lookup.h"
#include "scene/scene_place.h"
#include "scene/unused_masks.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr size_t kFewestPlaced = 3;  // two views leave most of a room unseen twice

/// The photos that have cameras must be enough to train on. If not, the error gives the outcome of every photo.
void require_enough_placed(const fs::path& folder, const std::vector<Photo>& photos,
                           const std::vector<LeftOut>& unplaced, bool strict, const std::string& remedy) {
  const auto reason_of = [&](const Photo& photo) {
    const auto without =
        std::find_if(unplaced.begin(), unplaced.end(), [&](const LeftOut& u) { return u.name == photo.name; });
    return without == unplaced.end() ? std::string() : without->reason;
  };
  const size_t all = photos.size();
  const auto placed = static_cast<size_t>(
      std::count_if(photos.begin(), photos.end(), [&](const Photo& photo) { return reason_of(photo).empty(); }));
  if (placed >= kFewestPlaced && 2 * placed >= all) {
    require_enough(folder, placed, unplaced, 0, strict, "photos");
    return;
  }
  std::string reasons;
  for (const Photo& photo : photos) {
    const std::string reason = reason_of(photo);
    reasons += fmt::format("\n    {}: {}", photo.name,
                           !reason.empty() ? reason : fmt::format("placed, but only {} photos hang together", placed));
  }
  const auto advised =
      std::find_if(unplaced.begin(), unplaced.end(), [](const LeftOut& u) { return !u.remedy.empty(); });
  throw_bad_input(folder, "poses", fmt::format("only {} of {} photos could be placed:{}", placed, all, reasons),
                  advised == unplaced.end() ? remedy : advised->remedy);
}

CapturedCloud captured(const PointCloud& cloud) {
  CapturedCloud out;
  for (const Vec3f& p : cloud.positions) out.positions.push_back(p.cast<double>());
  out.colors = cloud.colors;
  return out;
}

/// Undistorts and writes photos with cameras.
void import_photos(const Capture& capture, const fs::path& source, const fs::path& photos, const fs::path& scene,
                   const ScenePhotosOptions& options, bool depth_prior, ThreadPool& pool, ScenePhotosReport& report) {
  for (const std::string& note : capture.notes) log_info("{}", note);
  ImportOptions import;
  import.max_side = options.max_side;
  import.strict = options.strict;
  import.depth_prior = depth_prior;
  import.overwrite = options.overwrite;
  import.photos = photos;
  import.sources = {source, options.cameras};
  import.progress = options.progress;
  const bool own_split = options.test_every <= 0 && !(capture.train.empty() && capture.test.empty());
  if (!own_split) {
    require_training_photos(source, capture.frames.size(), options.test_every);
    for (size_t i = 0; i < capture.frames.size(); ++i) {
      (is_test_photo(i, options.test_every) ? import.test_names : import.train_names).push_back(capture.frames[i].name);
    }
  }
  if (import.test_names.empty() && (!own_split || capture.test.empty())) import.test_views = 0;
  const ImportReport imported = import_capture(capture, scene, import, pool);
  for (const LeftOut& frame : imported.left_out) {
    const bool known = std::any_of(report.unplaced.begin(), report.unplaced.end(),
                                   [&](const LeftOut& u) { return view_name_of(u.name) == frame.name; });
    if (!known) report.unplaced.push_back(frame);
  }
  report.placed = imported.train + imported.test;
  report.points = imported.points;
  report.train = imported.train;
  report.test = imported.test;
}

/// Photos that COLMAP can measure. The files of the others leave the folder that it reads.
std::vector<Photo> wide_photos(const std::vector<Photo>& photos, std::vector<LeftOut>& left_out) {
  std::vector<Photo> wide;
  for (const Photo& photo : photos) {
    const int side = std::min(photo.width, photo.height);
    if (side >= kLeastColmapSide) {
      wide.push_back(photo);
      continue;
    }
    left_out.push_back({photo.name,
                        fmt::format("its shorter side has {} pixels, and COLMAP needs {}", side, kLeastColmapSide),
                        "remove it, or raise --max-size"});
    std::error_code ignored;
    fs::remove(photo.file, ignored);
  }
  return wide;
}

void scene_by_colmap(const fs::path& source, const std::vector<Photo>& prepared, WorkFolder& work,
                     const fs::path& scene, const ScenePhotosOptions& options, ThreadPool& pool,
                     ScenePhotosReport& report) {
  const std::vector<Photo> photos = wide_photos(prepared, report.unplaced);
  require_enough(source, photos.size(), report.unplaced, kFewestPlaced, options.strict, "photos");
  ColmapPosesOptions colmap;
  colmap.shared_camera = options.shared_camera;
  colmap.threads = options.threads;
  colmap.progress = options.progress;
  ColmapPoses poses;
  try {
    poses = find_poses_with_colmap(photos, work.path(), colmap);
  } catch (const Error& error) {
    work.keep = error.kind() == ErrorKind::kFailed && fs::exists(work.log());
    throw;
  }
  if (!poses.second_failure.empty()) {
    work.keep_log = true;
    log_warning("the second attempt failed, so the cameras are those of the first: {}\n  log: {}", poses.second_failure,
                work.log().string());
  }
  report.unplaced.insert(report.unplaced.end(), poses.unplaced.begin(), poses.unplaced.end());
  report.placed = poses.model.images.size();
  report.reprojection_error = poses.reprojection_error;
  require_enough_placed(
      source, photos, poses.unplaced, options.strict,
      "take sharp, evenly lit photos from different places, each sharing about 60 % with a neighbour; "
      "or try --method vggt or da3, which need less overlap");
  write_colmap_binary(work.path() / "sparse", poses.model);
  Capture capture = read_colmap_capture(work.path());
  capture.layout = "photos, cameras by COLMAP";
  capture.cloud = captured(reliable_points(poses.model));
  finish_capture(capture);
  import_photos(capture, source, work.path() / "images", scene, options, false, pool, report);
}

void scene_by_given_poses(const fs::path& source, const fs::path& cameras, const PhotoList& listed,
                          const fs::path& scene, const ScenePhotosOptions& options, ThreadPool& pool,
                          ScenePhotosReport& report) {
  GivenPoses poses = read_given_poses(cameras, listed.folder, listed.photos);
  // The cameras may be for photos that the list left out for their names (hidden, or with a namesake).
  std::set<std::string> used;
  for (const CapturedFrame& frame : poses.capture.frames) used.insert(as_utf8(frame.image.filename().string()));
  std::erase_if(report.unplaced, [&](const LeftOut& photo) { return used.count(photo.name) > 0; });
  report.photos = poses.photos.size() + report.unplaced.size();
  require_enough(source, poses.photos.size(), report.unplaced, poses.photos.empty() ? 1 : 0, options.strict, "photos");
  report.unplaced.insert(report.unplaced.end(), poses.unplaced.begin(), poses.unplaced.end());
  require_enough_placed(source, poses.photos, poses.unplaced, options.strict,
                        "give the photos that the cameras were found for, or another --method");
  poses.capture.layout = "photos, cameras given (" + poses.capture.layout + ")";
  import_photos(poses.capture, source, listed.folder, scene, options, true, pool, report);
  if (report.points == 0) {
    log_warning(
        "there are no points: training starts from random ones; a COLMAP model with points3D, or ply_file_path in "
        "transforms.json, brings them");
  }
}

/// Frames of a video as a folder of photos.
void take_frames(const fs::path& video, const fs::path& folder, const ScenePhotosOptions& options) {
  const VideoFramesReport taken = take_video_frames(video, folder, {options.video_views, options.progress});
  log_info("{}: {} of {} frames taken, {} long{}", video.string(), taken.frames, taken.in_video,
           format_duration(taken.seconds),
           taken.looked_at < taken.in_video
               ? fmt::format("; {} were looked at, at most {} a second", taken.looked_at, kMostVideoRate)
               : "");
  constexpr double kWalk = 1.3;  // brightness of frames with one exposure differs by less, by what they show
  if (taken.exposure_walk > kWalk) {
    log_info(
        "the frames' brightness changes by a factor of {:.1f}, perhaps by automatic exposure; a locked exposure gives "
        "better colours",
        taken.exposure_walk);
  }
}

bool is_video(const fs::path& source) { return is_video_name(source) && !fs::is_directory(source); }

/// The photos of a folder, and the given cameras.
CheckedPhotos check_folder(const fs::path& folder, const fs::path& source, const ScenePhotosOptions& options) {
  CheckedPhotos checked;
  const bool given = options.method == PosesMethod::kGiven;
  checked.listed = given ? list_named_photos(folder) : list_photos(folder);
  const PhotoList& listed = checked.listed;
  const size_t found = listed.photos.size() + (given ? listed.left_out.size() : 0);
  if (given) checked.cameras = find_given_cameras(listed.folder, options.cameras);
  if (!is_camera_network_method(options.method) && found < kFewestPlaced) {
    throw_bad_input(source, "", fmt::format("{} photos are too few", found),
                    fmt::format("take at least {}, or use --method {}", kFewestPlaced, camera_method_words(" or ")));
  }
  require_enough(listed.folder, listed.photos.size(), listed.left_out, 0, options.strict && !given, "photos");
  if (!given) require_training_photos(source, listed.photos.size(), options.test_every);
  return checked;
}

}  // namespace

CheckedPhotos check_photos(const fs::path& source, const fs::path& scene, const ModelStore& store,
                           const ScenePhotosOptions& options) {
  require_scene_place(scene, options.overwrite, {source, options.cameras});
  const bool video = is_video(source);
  if (video && options.method == PosesMethod::kGiven) {
    throw_usage("--method given needs the photos that the cameras were found for, not a video",
                "give the folder of these photos, or another --method");
  }
  CheckedPhotos checked;
  if (video)
    require_readable_video(source);
  else
    checked = check_folder(source, source, options);
  if (is_camera_network_method(options.method)) store.require(published_model(options.model));
  if (options.method == PosesMethod::kColmap) require_colmap();
  return checked;
}

ScenePhotosReport make_scene_from_photos(const fs::path& source, const fs::path& scene, const ModelStore& store,
                                         const ScenePhotosOptions& options) {
  const double start = steady_seconds();
  CheckedPhotos checked = check_photos(source, scene, store, options);
  std::optional<WorkFolder> work;
  if (is_video(source)) {
    work.emplace(scene);
    take_frames(source, work->path() / "frames", options);
    checked = check_folder(work->path() / "frames", source, options);
  }
  const PhotoList& listed = checked.listed;
  if (!listed.unread.empty()) log_warning("left out, as their formats are not read:{}", listed.unread);
  ThreadPool pool(options.threads);
  ScenePhotosReport report;
  report.photos = listed.photos.size() + listed.left_out.size();
  report.unplaced = listed.left_out;
  if (options.method == PosesMethod::kGiven) {
    report.method = word_of(options.method);
    scene_by_given_poses(source, checked.cameras, listed, scene, options, pool, report);
  } else {
    if (!work) work.emplace(scene);
    std::vector<fs::path> files;
    for (const Photo& photo : listed.photos) files.push_back(photo.file);
    for (const SceneProblem& problem : unused_masks(listed.folder, files))
      log_warning("{}", text_of_unused_masks(problem));
    const std::vector<Photo> photos =
        prepare_photos(listed.photos, work->path() / "images", options.max_side, pool, report.unplaced);
    constexpr size_t kFewest = 2;  // one photo has no parallax
    require_enough(listed.folder, photos.size(), report.unplaced, kFewest, options.strict, "photos");
    if (is_camera_network_method(options.method)) {
      report.method = options.model;
      scene_by_network(photos, scene, store, options, pool, report);
    } else {
      report.method = word_of(options.method);
      scene_by_colmap(source, photos, *work, scene, options, pool, report);
    }
  }
  report.seconds = steady_seconds() - start;
  return report;
}

}  // namespace aligngs
