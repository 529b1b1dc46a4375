#include "priors/scene_priors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/half.h"
#include "core/log.h"
#include "core/stop_signal.h"
#include "io/file_system_error.h"
#include "io/folder_replacement.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "io/npz.h"
#include "nn/depther.h"
#include "nn/huggingface.h"
#include "nn/preprocess/da3_images.h"
#include "nn/preprocess/pillow_resize.h"
#include "nn/preprocess/vggt_images.h"
#include "priors/da3_prediction.h"
#include "priors/network_memory.h"
#include "priors/semantic_teacher.h"
#include "priors/vggt_prediction.h"
#include "scene/confidence_file.h"
#include "scene/prior_maps.h"
#include "scene/scene_json.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

bool begins(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

std::string digest_of(const ModelStore& store, const PublishedModel& model) {
  std::string all;
  for (const PublishedModel* part : with_needs(model)) {
    for (const ModelFile& file : part->files) {
      const auto located = store.find(*part, file);
      if (located) all += (all.empty() ? "" : "+") + store.digest(*part, file, *located);
    }
  }
  return all;
}

/// Effect of a prior that is already in the folder.
enum class Standing { kAbsent, kKeep, kReplace };

/// `complete`: whether what else the model makes is there.
Standing standing(const Scene& scene, const std::string& what, fs::path View::*map, bool overwrite,
                  const std::string& model, const std::optional<PriorJson>& noted, bool complete = true) {
  size_t there = 0;
  for (const int i : scene.train) there += !(scene.views[size_t(i)].*map).empty();
  if (overwrite) return Standing::kReplace;
  if (there == 0) return Standing::kAbsent;
  if (noted && noted->model == model)
    return there == scene.train.size() && complete ? Standing::kKeep : Standing::kReplace;
  throw_usage(fmt::format("{} has {} already (by {})", scene.folder.string(), what,
                          noted && !noted->model.empty() ? noted->model : "files of unknown origin"),
              "--overwrite replaces it");
}

/// The maps of one prior while they are made. They take the place of the old ones together, when all are there.
class PriorFill {
 public:
  /// `maps`: their folder in the scene; `confidence`: whether pred_confidence/ comes with them.
  PriorFill(const Scene& scene, const char* maps, bool confidence) : scene_(scene), maps_(scene.folder / maps) {
    if (confidence) confidence_.emplace(scene.folder / "pred_confidence");
  }

  void add_semantics(const std::string& view, const std::vector<int64_t>& shape, const std::vector<uint16_t>& half) {
    const fs::path file = maps_.path() / (view + ".npz");
    make_folders(file.parent_path());
    write_npz_float16(file, shape, half.data());
  }
  /// segments/ comes with the maps; without any, those of the maps that went are removed.
  void add_segments(const std::string& view, const SegmentMap& segments) {
    if (!segments_) segments_.emplace(scene_.folder / "segments");
    const fs::path file = segments_->path() / (view + ".png");
    fs::create_directories(file.parent_path());
    write_segments(file, segments);
  }
  void add_depth(const std::string& view, const ImageF& depth) {
    std::vector<uint16_t> half(depth.data.size());
    std::transform(depth.data.begin(), depth.data.end(), half.begin(), float_to_half);
    const fs::path file = maps_.path() / (view + ".npy");
    make_folders(file.parent_path());
    write_npy_float16(file, {depth.height, depth.width}, half.data());
  }
  void add_confidence(const std::string& view, const ImageF& map) {
    const fs::path file = confidence_->path() / (view + ".npy");
    make_folders(file.parent_path());
    write_confidence_map(file, map);
  }

  /// Until the last step priors.json does not say what made the maps, so that those of an end in between are of
  /// unknown origin.
  void finish(std::optional<PriorJson> PriorsJson::*entry, const PriorsJson& notes) {
    PriorsJson unknown = notes;
    unknown.*entry = std::nullopt;  // and with it its scale or kind
    stop_if_requested();
    const StopDeferral until_done;
    write_priors_json(scene_.folder / "priors.json", unknown);
    maps_.commit();
    if (confidence_)
      confidence_->commit();
    else if (entry == &PriorsJson::depth)
      fs::remove_all(scene_.folder / "pred_confidence");  // of the depth that went
    if (segments_)
      segments_->commit();
    else if (entry == &PriorsJson::semantics)
      fs::remove_all(scene_.folder / "segments");  // of the labels that went
    write_priors_json(scene_.folder / "priors.json", notes);
  }

 private:
  const Scene& scene_;
  FolderReplacement maps_;
  std::optional<FolderReplacement> confidence_, segments_;
};

Image<uint8_t> rgb_of(const View& view) { return nn::pillow_rgb_on_white(read_view_photo(view)); }

std::vector<Photo> photos_of(const Scene& scene) {
  std::vector<Photo> photos;
  for (const int i : scene.train) {
    const View& view = scene.views[size_t(i)];
    photos.push_back({view.name, view.image, view.camera.width, view.camera.height});
  }
  return photos;
}

/// Depth and confidence of all training views; depth of the lowest confidence is left out.
void write_network_depth(const Scene& scene, const std::vector<Photo>& photos, const std::vector<PredictedView>& views,
                         const PriorsJson& notes, double drop_percent, ScenePriorsReport& report) {
  const float least = drop_percent > 0 ? confidence_at(views, drop_percent) : 0;
  PriorFill fill(scene, "pred_depths", true);
  for (size_t i = 0; i < views.size(); ++i) {
    ImageF depth = views[i].depth;
    for (size_t k = 0; k < depth.data.size(); ++k) {
      if (!(views[i].confidence.data[k] >= least)) depth.data[k] = 0;
    }
    fill.add_depth(scene.views[size_t(scene.train[i])].name, depth);
    fill.add_confidence(photos[i].name, views[i].confidence);
    report.width = depth.width;
    report.height = depth.height;
    ++report.written;
  }
  fill.finish(&PriorsJson::depth, notes);
}

void fill_with_vggt(const Scene& scene, const ModelStore& store, const PublishedModel& model, PriorsJson notes,
                    const ScenePriorsOptions& options, ThreadPool& pool, ScenePriorsReport& report) {
  const std::vector<Photo> photos = photos_of(scene);
  const nn::Weights weights = nn::Weights::open(store.require(model).at(0));
  VggtInputs inputs = vggt_inputs(photos, pool);
  notes.depth->weights = digest_of(store, model);  // reads the whole file: only now
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  const nn::Vggt network(compute, weights);
  const std::vector<PredictedView> views =
      predict_vggt_views(compute, network, photos, std::move(inputs), {false, options.progress});
  write_network_depth(scene, photos, views, notes, options.drop_percent, report);
}

/// Depth in the units of the scene's cameras, which the network reads.
void fill_with_da3(const Scene& scene, const ModelStore& store, const PublishedModel& model, PriorsJson notes,
                   const ScenePriorsOptions& options, ThreadPool& pool, ScenePriorsReport& report) {
  const std::vector<Photo> photos = photos_of(scene);
  std::vector<Camera> cameras;
  for (const int i : scene.train) cameras.push_back(scene.views[size_t(i)].camera);
  const nn::Weights weights = nn::Weights::open(store.require(model).at(0));
  Da3Inputs inputs = da3_inputs(photos, pool);
  notes.depth->weights = digest_of(store, model);  // reads the whole file: only now
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  const nn::Da3 network(compute, weights);
  const std::vector<PredictedView> views =
      da3_depth_of_cameras(compute, network, photos, cameras, std::move(inputs), options.progress);
  write_network_depth(scene, photos, views, notes, options.drop_percent, report);
}

struct DepthWeights {
  nn::Weights backbone, head;
};

DepthWeights depth_weights(const ModelStore& store, const PublishedModel& model) {
  const auto located = store.find(model, model.files[0]);
  if (located) {
    const std::shared_ptr<const WeightFile> file = WeightFile::open(located->path);
    if (nn::is_huggingface_dpt(*file)) {
      return {nn::dinov2_from_huggingface(file, "backbone."), nn::dpt_head_from_huggingface(file)};
    }
  }
  const fs::path head = store.require(model).at(0);
  const fs::path backbone = store.require(published_model(model.needs.at(0))).at(0);
  return {nn::Weights::open(backbone), nn::Weights::open(head)};
}

/// Pixels of the training photos.
std::vector<NetworkInput> photo_sizes(const Scene& scene) {
  std::vector<NetworkInput> sizes;
  for (const int i : scene.train) {
    const Camera& camera = scene.views[size_t(i)].camera;
    sizes.push_back({camera.width, camera.height});
  }
  return sizes;
}

/// Depth at 1/2 of the photo's size: the heads decide at 1/14 to 1/4, the rest is interpolation.
ImageF halved(const nn::FeatureMap& depth) {
  const int w = std::max(1, int(depth.width / 2)), h = std::max(1, int(depth.height / 2));
  ImageF out(w, h, 1);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const auto sy = int64_t((y + 0.5) * double(depth.height) / h);
      const auto sx = int64_t((x + 0.5) * double(depth.width) / w);
      out.at(x, y) = depth.at(sy, sx)[0];
    }
  }
  return out;
}

void fill_with_depther(const Scene& scene, const ModelStore& store, const PublishedModel& model, PriorsJson notes,
                       const ScenePriorsOptions& options, ThreadPool& pool, ScenePriorsReport& report) {
  const DepthWeights weights = depth_weights(store, model);
  notes.depth->weights = digest_of(store, model);
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  const std::unique_ptr<nn::DepthNetwork> network = nn::make_depth_network(compute, weights.backbone, weights.head);
  PriorFill fill(scene, "pred_depths", false);
  Progress progress(options.progress, "depth", scene.train.size());
  for (const int i : scene.train) {
    stop_if_requested();
    const View& view = scene.views[size_t(i)];
    const ImageF depth = halved((*network)(compute, nn::normalised_image(rgb_of(view))));
    fill.add_depth(view.name, depth);
    report.width = depth.width;
    report.height = depth.height;
    progress.update(++report.written);
  }
  fill.finish(&PriorsJson::depth, notes);
}

/// All photos of VGGT get the largest height, or a square where one is upright.
void add_vggt_depth(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                    const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  const bool landscape = std::all_of(photos.begin(), photos.end(), [](const auto& p) { return p.width >= p.height; });
  nn::ImageSize size;
  for (const NetworkInput& photo : photos) {
    const nn::ImageSize one =
        nn::vggt_image_size(int(photo.width), int(photo.height), landscape ? nn::VggtFit::kCrop : nn::VggtFit::kPad);
    size = {std::max(size.width, one.width), std::max(size.height, one.height)};
  }
  add_vggt_memory(budget, nn::Weights::open(store.require(model).at(0)), options.precision, photos.size(), size.width,
                  size.height);
}

/// All photos of Depth Anything 3 are cut to the smallest sides.
void add_da3_depth(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                   const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  nn::ImageSize size{nn::kDa3Size, nn::kDa3Size};
  for (const NetworkInput& photo : photos) {
    const nn::ImageSize one = nn::da3_image_size(int(photo.width), int(photo.height));
    size = {std::min(size.width, one.width), std::min(size.height, one.height)};
  }
  add_da3_memory(budget, nn::Weights::open(store.require(model).at(0)), options.precision, photos.size(), size.width,
                 size.height);
}

void add_depther(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                 const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  NetworkInput largest;
  for (const NetworkInput& size : photos) {
    if (size.width * size.height > largest.width * largest.height) largest = size;
  }
  const DepthWeights weights = depth_weights(store, model);
  add_depth_network_memory(budget, weights.backbone, weights.head, largest, options);
}

using AddDepthMemory = void (*)(MemoryBudget&, const ModelStore&, const PublishedModel&,
                                const std::vector<NetworkInput>& photos, const NetworkMemoryOptions&);
using FillDepth = void (*)(const Scene&, const ModelStore&, const PublishedModel&, PriorsJson,
                           const ScenePriorsOptions&, ThreadPool&, ScenePriorsReport&);

/// Networks of one design.
struct DepthFamily {
  const char* begins;   ///< names of its models
  DepthScale scale;     ///< of its depth
  bool has_confidence;  ///< so that the lowest can be left out
  FillDepth fill;
  AddDepthMemory add_memory;
  const char* lighter;  ///< remedy where memory is too small
};
constexpr DepthFamily kDepthFamilies[] = {
    {"vggt", DepthScale::kOwn, true, fill_with_vggt, add_vggt_depth, "use fewer views, --depth dpt-s"},
    {"lingbot-map", DepthScale::kOwn, true, fill_with_vggt, add_vggt_depth, "use fewer views, --depth dpt-s"},
    {"da3-", DepthScale::kScene, true, fill_with_da3, add_da3_depth, "use fewer views, --depth da3-small"},
    {"nyu-", DepthScale::kMetres, false, fill_with_depther, add_depther,
     "use a smaller network (--depth dpt-s or linear-s), smaller photos"}};

const DepthFamily& depth_family(const PublishedModel& model) {
  for (const DepthFamily& family : kDepthFamilies) {
    if (begins(model.name, family.begins)) return family;
  }
  throw_usage(model.name + " is no network for depth", "see `aligngs priors --help` for the names");
}

}  // namespace

void add_depth_memory(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                      const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  depth_family(model).add_memory(budget, store, model, photos, options);
}

ScenePriorsReport fill_depth(const fs::path& folder, const ModelStore& store, const PublishedModel& model,
                             const ScenePriorsOptions& options) {
  const Scene scene = open_scene(folder);
  PriorsJson notes = read_priors_json(folder / "priors.json");
  ScenePriorsReport report;
  report.model = model.name;
  if (standing(scene, "depth", &View::prior_depth, options.overwrite, model.name, notes.depth) == Standing::kKeep) {
    report.was_there = true;
    return report;
  }
  ThreadPool pool(options.threads);
  const DepthFamily& family = depth_family(model);
  MemoryBudget budget(options.memory_limit);
  family.add_memory(budget, store, model, photo_sizes(scene), {options.precision, pool.size()});
  budget.require(model.name, std::string(family.lighter) + ", or more memory with --memory");
  notes.depth = PriorJson{model.name, "", {}};
  if (family.has_confidence) notes.depth->settings["drop_percent"] = fmt::format("{:g}", options.drop_percent);
  notes.depth_scale = family.scale;
  family.fill(scene, store, model, notes, options, pool, report);
  return report;
}

ScenePriorsReport fill_semantics(const fs::path& folder, const ModelStore& store, const PublishedModel& model,
                                 const ScenePriorsOptions& options) {
  const Scene scene = open_scene(folder);
  PriorsJson notes = read_priors_json(folder / "priors.json");
  ScenePriorsReport report;
  report.model = model.name;
  report.makes_segments = makes_segments(model);
  const bool complete = !report.makes_segments || has_segments(scene);
  if (standing(scene, "semantics", &View::semantics, options.overwrite, model.name, notes.semantics, complete) ==
      Standing::kKeep) {
    report.was_there = true;
    return report;
  }
  ThreadPool pool(options.threads);
  MemoryBudget budget(options.memory_limit);
  add_semantic_memory(budget, store, model, options.augment, photo_sizes(scene), {options.precision, pool.size()});
  budget.require(model.name, model.name == "ade20k-linear-s"
                                 ? "give it more memory with --memory, or leave classes out: --semantics none"
                                 : "use a light network (--semantics linear-s), or more memory with --memory");
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  const std::unique_ptr<SemanticTeacher> teacher =
      load_semantic_teacher(compute, store, model, options.augment, options.mask2former_heads);
  const int64_t classes = teacher->classes();
  if (scene.labels.size() != int(classes)) {
    throw_bad_input(folder / "labels.csv", "classes",
                    fmt::format("the scene has {} classes, the network knows {}", scene.labels.size(), classes),
                    "remove labels.csv: without it the classes are ADE20K's 150");
  }
  notes.semantics = PriorJson{model.name, digest_of(store, model), {}};
  if (options.augment) notes.semantics->settings["augmented"] = "yes";
  notes.kind = teacher->kind();
  PriorFill fill(scene, "segmentation_logits", false);
  Progress progress(options.progress, "semantics", scene.train.size());
  for (const int i : scene.train) {
    stop_if_requested();
    const View& view = scene.views[size_t(i)];
    const TeacherMapSize size = teacher->map_size(view.camera.width, view.camera.height);
    const Image<uint8_t> rgb = rgb_of(view);
    const nn::FeatureMap map = teacher->map(compute, rgb, size.width, size.height);
    std::vector<uint16_t> half(map.data.size());  // [classes][height][width]
    const int64_t places = map.places();
    for (int64_t p = 0; p < places; ++p) {
      for (int64_t c = 0; c < classes; ++c)
        half[size_t(c * places + p)] = float_to_half(map.data[size_t(p * classes + c)]);
    }
    fill.add_semantics(view.name, {classes, map.height, map.width}, half);
    if (const std::optional<SegmentMap> segments = teacher->segments(compute, rgb)) {
      fill.add_segments(view.name, *segments);
      report.segments += segments->list.size();
    }
    report.width = size.width;
    report.height = size.height;
    progress.update(++report.written);
  }
  fill.finish(&PriorsJson::semantics, notes);
  return report;
}

}  // namespace aligngs
