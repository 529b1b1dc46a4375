#include "cli/stages/path_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "cli/command.h"
#include "cli/stages/video_writer.h"
#include "core/angles.h"
#include "core/error.h"
#include "core/stop_signal.h"
#include "gaussians/soft_labels.h"
#include "io/drawn_picture.h"
#include "io/folder_replacement.h"
#include "io/image_file.h"
#include "io/output_place.h"
#include "room/camera_tour.h"
#include "room/room_json.h"
#include "scene/camera_path_json.h"
#include "train/run_folder.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr int kSmallest = 16, kLargest = 8192;  // pixels
constexpr float kSolid = 0.3f;                  // opacity of a Gaussian that is no haze
constexpr size_t kMostPathFrames = 100'000;     // an hour at 27 pictures a second

bool is_tour(const std::string& path) { return path == "orbit" || path == "walk"; }

/// Places of Gaussians that are no haze.
std::vector<Vec3d> solid_places(const GaussianModel& model) {
  std::vector<Vec3d> out;
  for (size_t i = 0; i < model.size(); ++i) {
    if (opacity_of(model, i) >= kSolid)
      out.push_back({model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]});
  }
  return out;
}

/// Up of the scene, else the mean up of its photos.
Vec3d up_of(const Scene& scene) {
  if (scene.up) return *scene.up;
  Vec3d sum;
  for (const View& v : scene.views) sum -= v.camera.world_to_camera.rotation.row(1);
  return norm(sum) > 1e-6 ? normalized(sum) : Vec3d{0, 0, 1};
}

CameraPath tour_of(const LoadedRun& run, const std::string& name, double seconds) {
  const fs::path measured = run.folder() / "room.json";
  const std::vector<Vec3d> places = solid_places(run.model);
  RoomInside room = fs::exists(measured) ? RoomInside::of_room(read_room(measured))
                                         : RoomInside::of_points(places, up_of(run.scene()));
  std::vector<Camera> photos;
  for (const int view : run.scene().train) photos.push_back(run.scene().views[static_cast<size_t>(view)].camera);
  room.add_obstacles(places, tour_height(room, photos));
  return name == "orbit" ? orbit_path(room, photos, seconds) : walk_path(room, photos, seconds);
}

CameraPath path_of(const LoadedRun& run, const PathStageOptions& options) {
  if (is_tour(options.path)) return tour_of(run, options.path, options.seconds.value_or(kTourSeconds));
  CameraPath path = read_camera_path(options.path);
  return options.seconds ? stretched(std::move(path), *options.seconds) : path;
}

Image<uint8_t> picture_of(LoadedRun& run, const Camera& camera) {
  RenderOptions options = run.render_options();
  options.labels = false;
  return to_bytes(run.engine->render(camera, options).color);
}

void require_free_folder(const fs::path& folder) {
  require_empty_folder_place(folder, {"the folder for the pictures is taken", "-o",
                                      "name a new or empty folder, a .mp4 file, or a .png file for one picture"});
}

/// Calls `take` with every picture in order.
template <class Take>
void draw_all(LoadedRun& run, const CameraPath& path, const PathStageOptions& options, size_t frames,
              const Take& take) {
  const Vec3d up = up_of(run.scene());
  Progress progress(options.progress, "pictures", frames);
  for (size_t i = 0; i < frames; ++i) {
    stop_if_requested();
    const CameraKey key = key_at(path, path.begin() + static_cast<double>(i) / options.frames_per_second);
    take(i, picture_of(run, camera_of(key, up, options.size.width, options.size.height)));
    progress.update(i + 1);
  }
}

}  // namespace

PictureSize parse_picture_size(const std::string& text) {
  PictureSize size;
  const char* end = text.data() + text.size();
  const auto [cross, first] = std::from_chars(text.data(), end, size.width);
  const bool parted = first == std::errc() && cross != end && *cross == 'x';
  const auto [rest, second] = std::from_chars(parted ? cross + 1 : end, end, size.height);
  const auto fits = [](int v) { return v >= kSmallest && v <= kLargest; };
  if (!parted || second != std::errc() || rest != end || !fits(size.width) || !fits(size.height)) {
    throw_usage("\"" + text + "\" is no size",
                fmt::format("give width and height in pixels, {} to {}, as 1920x1080", kSmallest, kLargest));
  }
  return size;
}

void require_path_place(const std::filesystem::path& run, const PathStageOptions& options) {
  const std::string ending = options.output.extension().string();
  RunFolder(run).require_not_of_run(options.output);
  if (!is_tour(options.path)) {
    if (!fs::exists(options.path)) {
      throw_bad_input(options.path, "--path", "there is no such file of key frames, and no such tour",
                      "give orbit, walk, or a file that the page saved");
    }
    require_apart(options.output, {options.path});
    read_camera_path(options.path);
  }
  for (const char* other : {".gif", ".webp", ".apng", ".avi", ".mov", ".mkv", ".webm", ".jpg", ".jpeg"}) {
    if (ending == other)
      throw Error({ErrorKind::kUsage, "files that end in " + ending + " are not written here", options.output, "-o",
                   "name FILE.mp4, FILE.png or a folder"});
  }
  if (ending == ".png" || ending == ".mp4") require_output_file(options.output);
  if (ending == ".png") return;
  if (ending == ".mp4" && can_write_video()) {
    if (options.size.width % 2 != 0 || options.size.height % 2 != 0)
      throw_usage("a video has even numbers of pixels", "choose another --size");
    return;
  }
  require_free_folder(ending == ".mp4" ? fs::path(options.output).replace_extension("") : options.output);
}

PathPictures render_path(LoadedRun& run, const PathStageOptions& options) {
  const std::string ending = options.output.extension().string();
  const CameraPath path = path_of(run, options);
  PathPictures out{options.output, 1, path.duration(), false};
  if (ending == ".png") {
    if (!(options.at >= 0 && options.at <= path.duration())) {
      throw_usage(fmt::format("--at {} is not on the way, which takes {:.3g} s", options.at, path.duration()));
    }
    const CameraKey key = key_at(path, path.begin() + options.at);
    write_drawn_picture(options.output,
                        picture_of(run, camera_of(key, up_of(run.scene()), options.size.width, options.size.height)));
    return out;
  }
  const double frames = std::floor(path.duration() * options.frames_per_second) + 1;
  if (frames > static_cast<double>(kMostPathFrames))
    throw_usage(fmt::format("{:.0f} pictures are more than {}", frames, kMostPathFrames),
                "use less --seconds or --fps");
  out.frames = static_cast<size_t>(frames);
  if (ending == ".mp4" && can_write_video()) {
    VideoWriter video(options.output, options.size.width, options.size.height, options.frames_per_second);
    draw_all(run, path, options, out.frames, [&](size_t, const Image<uint8_t>& picture) { video.add(picture); });
    video.commit();
    return out;
  }
  out.video_missing = ending == ".mp4";
  if (out.video_missing) out.output.replace_extension("");
  FolderReplacement folder(out.output);
  draw_all(run, path, options, out.frames, [&](size_t i, const Image<uint8_t>& picture) {
    write_png(folder.path() / fmt::format("frame_{:05}.png", i + 1), picture);
  });
  folder.commit();
  return out;
}

void render_view_picture(LoadedRun& run, const std::string& view, const PictureSize& size, const fs::path& file) {
  const std::vector<View>& views = run.scene().views;
  const auto found = std::find_if(views.begin(), views.end(), [&](const View& v) { return v.name == view; });
  if (found == views.end()) {
    std::vector<std::string> names;
    for (const View& v : views) names.push_back(v.name);
    const std::string near = nearest_word(view, names);
    throw_usage("there is no view \"" + view + "\"",
                near.empty() ? "cameras.json of the run lists the views" : "did you mean " + near + "?");
  }
  // The photo fits into the picture.
  Camera camera = found->camera;
  const double scale =
      std::min(static_cast<double>(size.width) / camera.width, static_cast<double>(size.height) / camera.height);
  camera.cx = 0.5 * size.width + (camera.cx - 0.5 * camera.width) * scale;
  camera.cy = 0.5 * size.height + (camera.cy - 0.5 * camera.height) * scale;
  camera.fx *= scale;
  camera.fy *= scale;
  camera.width = size.width;
  camera.height = size.height;
  write_drawn_picture(file, picture_of(run, camera));
}

}  // namespace aligngs
