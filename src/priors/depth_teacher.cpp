#include "priors/depth_teacher.h"

#include <algorithm>

#include "core/stop_signal.h"
#include "nn/depther.h"
#include "nn/huggingface.h"
#include "nn/preprocess/da3_images.h"
#include "nn/preprocess/vggt_images.h"
#include "priors/da3_prediction.h"
#include "priors/prior_files.h"
#include "priors/vggt_prediction.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

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
  PriorFiles fill(scene, "pred_depths", true);
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
  notes.depth->weights = digest_of_weights(store, model);  // reads the whole file: only now
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
  notes.depth->weights = digest_of_weights(store, model);  // reads the whole file: only now
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
  notes.depth->weights = digest_of_weights(store, model);
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  const std::unique_ptr<nn::DepthNetwork> network = nn::make_depth_network(compute, weights.backbone, weights.head);
  PriorFiles fill(scene, "pred_depths", false);
  Progress progress(options.progress, "depth", scene.train.size());
  for (const int i : scene.train) {
    stop_if_requested();
    const View& view = scene.views[size_t(i)];
    const ImageF depth = halved((*network)(compute, nn::normalised_image(photo_for_network(view))));
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

}  // namespace

const DepthFamily kVggtDepth = {DepthScale::kOwn,
                                true,
                                "one unknown scale for all photos, with confidence",
                                "use fewer views, --depth dpt-s",
                                fill_with_vggt,
                                add_vggt_depth};
const DepthFamily kDa3Depth = {DepthScale::kScene,
                               true,
                               "the units of the scene's cameras, which the network reads, with confidence",
                               "use fewer views, --depth da3-small",
                               fill_with_da3,
                               add_da3_depth};
const DepthFamily kDepthHeads = {DepthScale::kMetres,
                                 false,
                                 "metres, one photo at a time",
                                 "use a smaller network (--depth dpt-s or linear-s), smaller photos",
                                 fill_with_depther,
                                 add_depther};

}  // namespace aligngs
