#include "priors/prior_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/half.h"
#include "core/stop_signal.h"
#include "io/file_system_error.h"
#include "io/npy.h"
#include "io/npz.h"
#include "nn/preprocess/pillow_resize.h"
#include "scene/confidence_file.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

std::string digest_of_weights(const ModelStore& store, const PublishedModel& model) {
  std::string all;
  for (const PublishedModel* part : with_needs(model)) {
    for (const ModelFile& file : part->files) {
      const auto located = store.find(*part, file);
      if (located) all += (all.empty() ? "" : "+") + store.digest(*part, file, *located);
    }
  }
  return all;
}

PriorStanding standing_of_prior(const Scene& scene, const PriorToMake& prior) {
  const std::optional<PriorJson>& noted = prior.noted;
  size_t there = 0;
  for (const int i : scene.train) there += !(scene.views[size_t(i)].*prior.map).empty();
  if (prior.overwrite) return PriorStanding::kReplace;
  if (there == 0) return PriorStanding::kAbsent;
  if (noted && noted->model == prior.model)
    return there == scene.train.size() && prior.complete ? PriorStanding::kKeep : PriorStanding::kReplace;
  throw_usage(fmt::format("{} has {} already (by {})", scene.folder.string(), prior.what,
                          noted && !noted->model.empty() ? noted->model : "files of unknown origin"),
              "--overwrite replaces it");
}

Image<uint8_t> photo_for_network(const View& view) { return nn::pillow_rgb_on_white(read_view_photo(view)); }

std::vector<NetworkInput> sizes_of_training_photos(const Scene& scene) {
  std::vector<NetworkInput> sizes;
  for (const int i : scene.train) {
    const Camera& camera = scene.views[size_t(i)].camera;
    sizes.push_back({camera.width, camera.height});
  }
  return sizes;
}

PriorFiles::PriorFiles(const Scene& scene, const char* maps, bool confidence)
    : scene_(scene), maps_(scene.folder / maps) {
  if (confidence) confidence_.emplace(scene.folder / "pred_confidence");
}

void PriorFiles::add_semantics(const std::string& view, const std::vector<int64_t>& shape,
                               const std::vector<uint16_t>& half) {
  const fs::path file = maps_.path() / (view + ".npz");
  make_folders(file.parent_path());
  write_npz_float16(file, shape, half.data());
}

void PriorFiles::add_segments(const std::string& view, const SegmentMap& segments) {
  if (!segments_) segments_.emplace(scene_.folder / "segments");
  const fs::path file = segments_->path() / (view + ".png");
  make_folders(file.parent_path());
  write_segments(file, segments);
}

void PriorFiles::add_depth(const std::string& view, const ImageF& depth) {
  std::vector<uint16_t> half(depth.data.size());
  std::transform(depth.data.begin(), depth.data.end(), half.begin(), float_to_half);
  const fs::path file = maps_.path() / (view + ".npy");
  make_folders(file.parent_path());
  write_npy_float16(file, {depth.height, depth.width}, half.data());
}

void PriorFiles::add_confidence(const std::string& view, const ImageF& map) {
  const fs::path file = confidence_->path() / (view + ".npy");
  make_folders(file.parent_path());
  write_confidence_map(file, map);
}

void PriorFiles::finish(std::optional<PriorJson> PriorsJson::*entry, const PriorsJson& notes) {
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

}  // namespace aligngs
