#include "train/closed_room.h"

#include <algorithm>
#include <cmath>

#include "core/log.h"
#include "gaussians/initialise.h"
#include "gaussians/soft_labels.h"
#include "refine/unseen_layout.h"
#include "scene/kd_tree.h"
#include "train/rendered_view.h"

namespace aligngs {
namespace {

constexpr int kLongestSide = 320;      // pixels of a rendering: planes, openings and colours need no more
constexpr double kCell = 0.01;         // edge of a square / extent: 3 to 5 cm in a room, whose unseen walls are plain
constexpr double kTaken = 0.75;        // squares; a Gaussian this near to a square's centre covers it
constexpr float kTakenOpacity = 0.3f;  // if it is at least so opaque
constexpr float kOpacity = 0.95f;
constexpr float kThickness = 0.1f;  // of a Gaussian / its width, as in a start from depth
constexpr float kWidth = 0.7f;      // standard deviation / edge of a square: neighbours overlap without ripples
constexpr float kSureLogit = 8;     // of the class against all others: 0.95 among 150 classes

/// Trained scene in a training view.
LayoutView look(const Engine& engine, const GuideView& view, const RenderOptions& options) {
  const double shrink =
      std::min(1.0, static_cast<double>(kLongestSide) / std::max(view.camera.width, view.camera.height));
  LayoutView out;
  out.plane.camera = view.camera.resized(std::max(1, static_cast<int>(std::lround(view.camera.width * shrink))),
                                         std::max(1, static_cast<int>(std::lround(view.camera.height * shrink))));
  Rendering seen = render_labelled(engine, view, out.plane.camera, options);
  out.plane = plane_view_of(out.plane.camera, seen);
  out.color = std::move(seen.color);
  for (size_t i = 0; i < seen.alpha.data.size(); ++i) {
    const float alpha = seen.alpha.data[i];
    for (size_t c = 0; alpha > 0 && c < 3; ++c)
      out.color.data[3 * i + c] = std::clamp(out.color.data[3 * i + c] / alpha, 0.0f, 1.0f);
  }
  return out;
}

/// Leaves out what is covered already.
UnseenLayout without_covered(const UnseenLayout& layout, const GaussianModel& model, double cell) {
  std::vector<Vec3f> opaque;
  const std::vector<Vec3f> positions = positions_of(model);
  for (size_t i = 0; i < positions.size(); ++i) {
    if (opacity_of(model, i) >= kTakenOpacity) opaque.push_back(positions[i]);
  }
  const KdTree<float> tree(std::move(opaque));
  const float reach = static_cast<float>(kTaken * kTaken * cell * cell);
  UnseenLayout out;
  for (size_t i = 0; i < layout.cloud.size(); ++i) {
    uint32_t index = 0;
    float squared = 0;
    if (tree.nearest(layout.cloud.positions[i], 1, &index, &squared) > 0 && squared < reach) continue;
    out.cloud.positions.push_back(layout.cloud.positions[i]);
    out.cloud.colors.push_back(layout.cloud.colors[i]);
    out.cloud.normals.push_back(layout.cloud.normals[i]);
    out.labels.push_back(layout.labels[i]);
  }
  return out;
}

GaussianModel gaussians_of(const UnseenLayout& layout, double cell, int channels) {
  InitialiseOptions options;
  options.semantic_channels = channels;
  options.opacity = kOpacity;
  options.flat_ratio = kThickness;
  GaussianModel model = initialise_gaussians(layout.cloud, options);
  const size_t row = static_cast<size_t>(channels);
  for (size_t i = 0; i < model.size(); ++i) {
    const float width = static_cast<float>(std::log(kWidth * cell));
    model.log_scales[3 * i] = model.log_scales[3 * i + 1] = width;
    model.log_scales[3 * i + 2] = width + std::log(kThickness);
    // Rows have mean zero, as those of training.
    std::fill_n(&model.semantics[i * row], row, -kSureLogit / static_cast<float>(channels));
    model.semantics[i * row + layout.labels[i]] += kSureLogit;
  }
  return model;
}

/// New rows behind all others, with zero moments, whatever the engine keeps beside them.
void append(Engine& engine, const GaussianModel& added) {
  RestructurePlan plan = plan_keep(std::vector<uint8_t>(engine.size(), 1));
  const size_t first = plan.rows.size();
  RowOrigin copy;
  copy.kind = RowOrigin::Kind::kClone;
  plan.rows.resize(first + added.size(), copy);
  engine.restructure(plan);
  engine.reset_density_statistics();
  EngineState state;
  engine.save_state(state);
  const auto put = [first](const std::vector<float>& from, std::vector<float>& to, size_t width) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(first * width));
  };
  put(added.positions, state.model.positions, 3);
  put(added.log_scales, state.model.log_scales, 3);
  put(added.rotations, state.model.rotations, 4);
  put(added.opacity_logits, state.model.opacity_logits, 1);
  put(added.sh, state.model.sh, size_t(3) * kShCoefficients);
  put(added.semantics, state.model.semantics, static_cast<size_t>(added.semantic_channels));
  engine.load_state(state);
}

}  // namespace

size_t close_room(Engine& engine, const ClosedRoomRequest& request, ThreadPool& pool) {
  GaussianModel model;
  engine.store(model);
  if (model.semantic_channels == 0 || model.size() == 0) return 0;
  std::vector<LayoutView> views;
  for (const GuideView& view : request.views) views.push_back(look(engine, view, request.render));
  LayoutSettings settings;
  settings.cell = kCell * request.extent;
  UnseenLayout unseen = unseen_layout(views, plane_classes(request.labels), settings, pool);
  unseen = without_covered(unseen, model, settings.cell);
  if (unseen.cloud.size() == 0) return 0;
  const size_t allowed = request.most_gaussians - std::min(request.most_gaussians, model.size());
  if (unseen.cloud.size() > allowed) {
    log_info("closed room: left open, as it would take {} more Gaussians and {} are allowed", unseen.cloud.size(),
             allowed);
    return 0;
  }
  append(engine, gaussians_of(unseen, settings.cell, model.semantic_channels));
  return unseen.cloud.size();
}

}  // namespace aligngs
