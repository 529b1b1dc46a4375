#include "priors/colmap_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "core/error.h"
#include "core/log.h"
#include "io/file_system_error.h"
#include "priors/child_process.h"
#include "priors/colmap_options.h"
#include "scene/photo_mask.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Matches that agree with one relative pose, below which a pair is not used (COLMAP's own default).
constexpr int kFewestVerified = 15;
/// A photo with fewer features can hardly share enough of them with another one.
constexpr int kFewFeatures = 200;

using Arguments = std::vector<std::string>;

struct Attempt {
  const char* name;
  bool sensitive;
};

class ColmapRun {
 public:
  ColmapRun(fs::path work, const ColmapPosesOptions& options) : work_(std::move(work)), options_(options) {}

  void step(const Attempt& attempt, const std::string& name, uint64_t total, const std::string& mark, Arguments more,
            bool may_fail = false) const {
    Arguments arguments = {"colmap", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Progress progress(options_.progress, fmt::format("colmap {} ({})", name, attempt.name), total);
    uint64_t done = 0;
    const ChildResult result = run_child(arguments, work_ / "colmap.log", [&](const std::string& line) {
      if (line.find(mark) != std::string::npos) progress.update(std::min(++done, std::max<uint64_t>(total, 1) - 1));
    });
    refuse_full_disk(work_);
    if (result.status == 0 || (may_fail && result.status < 128)) {
      progress.update(total);
      return;
    }
    throw Error({ErrorKind::kFailed,
                 fmt::format("`colmap {}` ended with status {}:\n{}", name, result.status, result.last_lines),
                 work_ / "colmap.log", "", "see the end of this file"});
  }

  /// The names that the installed program has for its options.
  ColmapOptions options_of(const std::string& name) const {
    std::string help;
    run_child({"colmap", name, "-h"}, work_ / "colmap-help.log", [&](const std::string& line) { help += line + "\n"; });
    return ColmapOptions(help);
  }

  fs::path work() const { return work_; }
  std::string threads() const { return std::to_string(options_.threads > 0 ? options_.threads : -1); }

 private:
  fs::path work_;
  const ColmapPosesOptions& options_;
};

struct AttemptResult {
  std::vector<fs::path> models;  ///< folders
  ColmapModel largest;
  fs::path database;
};

AttemptResult run_attempt(const ColmapRun& run, const Attempt& attempt, size_t photos, bool one_camera) {
  const fs::path database = run.work() / (std::string(attempt.name) + ".db");
  const fs::path sparse = run.work() / attempt.name;
  fs::remove(database);
  fs::remove_all(sparse);
  make_folders(sparse);
  const std::string images = (run.work() / "images").string();
  const auto choose = [&](const char* quick, const char* sensitive) {
    return std::string(attempt.sensitive ? sensitive : quick);
  };
  Arguments extract = {"--database_path", database.string(), "--image_path", images};
  const ColmapOptions extractor = run.options_of("feature_extractor");
  extractor.add(extract, {"ImageReader.camera_model"}, "SIMPLE_RADIAL");
  extractor.add(extract, {"ImageReader.single_camera"}, one_camera ? "1" : "0");
  if (fs::is_directory(run.work() / kMaskFolder))
    extractor.add(extract, {"ImageReader.mask_path"}, (run.work() / kMaskFolder).string());
  extractor.add(extract, {"FeatureExtraction.use_gpu", "SiftExtraction.use_gpu"}, "0");
  extractor.add(extract, {"FeatureExtraction.num_threads", "SiftExtraction.num_threads"}, run.threads());
  extractor.add(extract, {"SiftExtraction.max_num_features"}, choose("4096", "6000"));
  if (attempt.sensitive) {
    // Affine shape and domain-size pooling match views that differ much; weak corners count, since
    // walls and furniture have few strong ones.
    extractor.add(extract, {"SiftExtraction.estimate_affine_shape"}, "1");
    extractor.add(extract, {"SiftExtraction.domain_size_pooling"}, "1");
    extractor.add(extract, {"SiftExtraction.peak_threshold"}, "0.004");
  }
  run.step(attempt, "feature_extractor", photos, "Processed file", extract);
  // Matching on processors takes the square of the features: 4096 are a tenth of a second a pair.
  Arguments match = {"--database_path", database.string()};
  const ColmapOptions matcher = run.options_of("exhaustive_matcher");
  matcher.add(match, {"FeatureMatching.use_gpu", "SiftMatching.use_gpu"}, "0");
  matcher.add(match, {"FeatureMatching.num_threads", "SiftMatching.num_threads"}, run.threads());
  matcher.add(match, {"FeatureMatching.guided_matching", "SiftMatching.guided_matching"}, choose("0", "1"));
  run.step(attempt, "exhaustive_matcher", 1, "block [", match);  // "Matching block [", since 3.12 "Processing block ["
  // Few photos have little to begin with: smaller angles, fewer shared points than for collections.
  Arguments map = {"--database_path", database.string(), "--image_path", images, "--output_path", sparse.string()};
  const ColmapOptions mapper = run.options_of("mapper");
  mapper.add(map, {"Mapper.num_threads"}, run.threads());
  mapper.add(map, {"Mapper.min_model_size"}, "3");
  mapper.add(map, {"Mapper.init_min_tri_angle"}, choose("8", "4"));          // degrees; default 16
  mapper.add(map, {"Mapper.init_min_num_inliers"}, choose("60", "40"));      // default 100
  mapper.add(map, {"Mapper.abs_pose_min_num_inliers"}, choose("20", "15"));  // default 30
  run.step(attempt, "mapper", photos, "Registering image", map, true);
  AttemptResult result;
  result.database = database;
  for (const auto& entry : fs::directory_iterator(sparse)) {
    if (!fs::exists(entry.path() / "images.bin")) continue;
    result.models.push_back(entry.path());
    ColmapModel model = read_colmap_model(entry.path());
    if (model.images.size() > result.largest.images.size()) result.largest = std::move(model);
  }
  return result;
}

double mean_error(const ColmapModel& model) {
  double sum = 0;
  for (const ColmapPoint& point : model.points) sum += point.error;
  return model.points.empty() ? 0 : sum / double(model.points.size());
}

}  // namespace

PointCloud reliable_points(const ColmapModel& model) {
  constexpr double kMaxError = 2;  // pixels; what 3DGS' readers keep
  PointCloud cloud;
  for (const ColmapPoint& point : model.points) {
    if (point.error > kMaxError) continue;
    cloud.positions.push_back(point.position.cast<float>());
    cloud.colors.push_back({point.color[0] / 255.f, point.color[1] / 255.f, point.color[2] / 255.f});
  }
  return cloud;
}

std::string why_unplaced(const ColmapDatabase& database, const std::string& photo,
                         const std::vector<std::string>& placed) {
  const ColmapDatabase::Photo* self = nullptr;
  std::map<uint32_t, std::string> names;
  for (const ColmapDatabase::Photo& p : database.photos) {
    names[p.id] = p.name;
    if (p.name == photo) self = &p;
  }
  if (!self) return "COLMAP could not read it";
  if (self->features < kFewFeatures) {
    return fmt::format("only {} features were found in it: too dark, too blurred or without texture", self->features);
  }
  // The strongest connection with a placed photo, and with any.
  int64_t best = 0, best_placed = 0;
  std::string with, with_placed;
  for (const ColmapDatabase::Pair& pair : database.pairs) {
    if (pair.first != self->id && pair.second != self->id) continue;
    const std::string& other = names[pair.first == self->id ? pair.second : pair.first];
    if (pair.verified > best) best = pair.verified, with = other;
    const bool other_placed = std::find(placed.begin(), placed.end(), other) != placed.end();
    if (other_placed && pair.verified > best_placed) best_placed = pair.verified, with_placed = other;
  }
  if (best == 0) {
    return fmt::format(
        "it shares nothing with any other photo ({} features, none agree): "
        "no overlap",
        self->features);
  }
  if (best < kFewestVerified) {
    return fmt::format(
        "its best partner {} shares only {} points with it ({} are needed): too "
        "little overlap",
        with, best, kFewestVerified);
  }
  if (placed.empty()) {
    return fmt::format("it shares {} points with {}, too few for a first pair of cameras", best, with);
  }
  if (best_placed >= kFewestVerified) {
    return fmt::format("it shares {} points with {}, but its position could not be told from them", best_placed,
                       with_placed);
  }
  return fmt::format("it overlaps with {} ({} points), which is not connected with the others", with, best);
}

void require_colmap() {
  if (!find_program("colmap").empty()) return;
  throw Error({ErrorKind::kFailed,
               "the program colmap is not in PATH",
               {},
               "--method colmap",
               "apt-get install colmap, or use --method vggt"});
}

ColmapPoses find_poses_with_colmap(const std::vector<Photo>& photos, const fs::path& work,
                                   const ColmapPosesOptions& options) {
  require_colmap();
  setenv("QT_QPA_PLATFORM", "offscreen", 0);  // it links to Qt, and there may be no screen
  bool one_camera = options.shared_camera;
  for (const Photo& photo : photos) {
    one_camera = one_camera && photo.width == photos[0].width && photo.height == photos[0].height;
  }
  const ColmapRun run(work, options);
  ColmapPoses poses;
  AttemptResult best = run_attempt(run, {"quick", false}, photos.size(), one_camera);
  if (best.largest.images.size() < photos.size()) {
    log_info("{} of {} photos placed; trying again with more sensitive features", best.largest.images.size(),
             photos.size());
    try {
      AttemptResult second = run_attempt(run, {"thorough", true}, photos.size(), one_camera);
      if (second.largest.images.size() >= best.largest.images.size()) best = std::move(second);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kFailed || best.largest.images.empty()) throw;
      poses.second_failure = error.details().message;
    }
  }
  std::vector<std::string> placed;
  for (const ColmapImage& image : best.largest.images) placed.push_back(image.name);
  if (placed.size() < photos.size()) {
    const ColmapDatabase database = read_colmap_database(best.database);
    for (const Photo& photo : photos) {
      const std::string name = photo.file.lexically_relative(work / "images").generic_string();
      if (std::find(placed.begin(), placed.end(), name) == placed.end())
        poses.unplaced.push_back({photo.name, why_unplaced(database, name, placed), ""});
    }
  }
  poses.other_models = std::max(0, int(best.models.size()) - 1);
  poses.reprojection_error = mean_error(best.largest);
  poses.model = std::move(best.largest);
  return poses;
}

}  // namespace aligngs
