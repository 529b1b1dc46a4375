#include "train/voted_objects.h"

#include "gaussians/object_votes.h"
#include "scene/segment_file.h"
#include "train/photo_segments.h"
#include "train/training_set.h"

namespace aligngs {

bool votes_for_objects(const Scene& scene, const TrainConfig& config) {
  return config.semantic.object_votes && has_segments(scene);
}

std::vector<Instance> number_objects(const GaussianModel& model, const Scene& scene, const TrainConfig& config,
                                     GaussianLabels& labels, ThreadPool& pool) {
  const double extent = robust_extent(scene);
  if (!votes_for_objects(scene, config)) return find_instances(model, labels, extent, {}, pool);
  const std::vector<float> near_planes =
      near_planes_of_training_views(scene, config, decide_prior_use(scene, config), pool);
  std::vector<PhotoSegments> photos;
  for (const int v : scene.train) {
    SegmentedView view;
    view.camera = working_camera(scene, config, v);
    view.near_plane = near_planes[photos.size()];
    view.segments = read_segments(segment_file_of(scene, scene.views[static_cast<size_t>(v)]), scene.labels.size());
    photos.push_back(sighted_segments(model, view, {}, pool));
  }
  return vote_instances(model, labels, photos, extent, {}, {}, pool);
}

}  // namespace aligngs
