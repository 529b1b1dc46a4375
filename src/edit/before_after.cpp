// The view that shows an edit best, and its picture.
#include <algorithm>
#include <cmath>

#include "edit/edit_session.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

constexpr size_t kCandidates = 6;  ///< views rendered before and after
constexpr int kGap = 4;            ///< pixels between the pictures

/// Positions of Gaussians that only one of the rooms has, or whose colour differs.
std::vector<Vec3d> changed_positions(const EditableRoom& before, const EditableRoom& after) {
  constexpr size_t kEnough = 4000;  // points say where to look
  std::vector<uint8_t> same(
      1 +
          [&] {
            uint32_t most = 0;
            for (const GaussianOrigin& o : before.origins) most = std::max(most, o.row);
            for (const GaussianOrigin& o : after.origins) most = std::max(most, o.row);
            return most;
          }(),
      0);
  std::vector<uint32_t> after_row(same.size(), 0xffffffffu);
  for (uint32_t i = 0; i < after.origins.size(); ++i) {
    if (!after.origins[i].filled) after_row[after.origins[i].row] = i;
  }
  std::vector<Vec3d> out;
  const GaussianModel& a = before.gaussians.model;
  const GaussianModel& b = after.gaussians.model;
  for (size_t i = 0; i < before.origins.size(); ++i) {
    if (before.origins[i].filled) continue;
    const uint32_t j = after_row[before.origins[i].row];
    if (j != 0xffffffffu && std::equal(a.sh.begin() + static_cast<std::ptrdiff_t>(48 * i),
                                       a.sh.begin() + static_cast<std::ptrdiff_t>(48 * i + 3),
                                       b.sh.begin() + static_cast<std::ptrdiff_t>(48 * size_t(j)))) {
      continue;
    }
    out.push_back({a.positions[3 * i], a.positions[3 * i + 1], a.positions[3 * i + 2]});
  }
  if (out.size() > kEnough) {
    std::vector<Vec3d> thinned;
    for (size_t k = 0; k < kEnough; ++k) thinned.push_back(out[k * out.size() / kEnough]);
    out = std::move(thinned);
  }
  return out;
}

std::vector<Vec3d> all_positions(const EditableRoom& room) {
  std::vector<Vec3d> out;
  for (const Vec3f& p : positions_of(room.gaussians.model)) out.push_back(p.cast<double>());
  return out;
}

double sum_of(const ImageF& image) {
  double sum = 0;
  for (const float v : image.data) sum += v;
  return sum;
}

/// How large the points appear in a view: the sum of 1 / z^2 over those in the image.
double prominence(const Camera& camera, const std::vector<Vec3d>& points) {
  double sum = 0;
  for (const Vec3d& p : points) {
    const Vec3d c = camera.world_to_camera * p;
    if (c.z > 0.05 && camera.contains(camera.project(c))) sum += 1 / (c.z * c.z);
  }
  return sum;
}

double difference(const ImageF& a, const ImageF& b) {
  double sum = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    sum += std::fabs(std::clamp(a.data[i], 0.f, 1.f) - std::clamp(b.data[i], 0.f, 1.f));
  }
  return sum;
}

Image<uint8_t> side_by_side(const Image<uint8_t>& left, const Image<uint8_t>& right) {
  Image<uint8_t> out(left.width + kGap + right.width, left.height, 3, 255);
  for (int y = 0; y < left.height; ++y) {
    std::copy_n(left.pixel(0, y), 3 * left.width, out.pixel(0, y));
    std::copy_n(right.pixel(0, y), 3 * right.width, out.pixel(left.width + kGap, y));
  }
  return out;
}

}  // namespace

BeforeAfter EditSession::compare(const EditableRoom& before, const EditableRoom& after) const {
  // An extraction leaves little: look at that. Otherwise look at the change.
  const bool little_left = 2 * after.origins.size() < before.origins.size();
  const std::vector<Vec3d> changed = little_left ? all_positions(after) : changed_positions(before, after);
  struct Candidate {
    double score;
    int view;
  };
  std::vector<Candidate> candidates;
  for (const std::vector<int>* split : {&scene().test, &scene().train}) {
    for (const int view : *split) candidates.push_back({prominence(run_->working_camera(view), changed), view});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  if (candidates.size() > kCandidates) candidates.resize(kCandidates);

  RenderOptions options;
  options.geometry = false;
  options.raster.near_plane = static_cast<float>(run_->config.train.near_plane * original_.gaussians.extent);
  const std::unique_ptr<Engine> left = make_cpu_engine(threads_), right = make_cpu_engine(threads_);
  left->load(before.gaussians.model);
  right->load(after.gaussians.model);
  BeforeAfter best;
  double most = -1;
  for (const Candidate& candidate : candidates) {
    const Camera camera = run_->working_camera(candidate.view);
    const Rendering a = left->render(camera, options), b = right->render(camera, options);
    const double d = little_left ? sum_of(b.alpha) : difference(a.color, b.color);
    if (d <= most) continue;
    most = d;
    best.view = scene().views[static_cast<size_t>(candidate.view)].name;
    best.picture = side_by_side(to_bytes(a.color), to_bytes(b.color));
  }
  return best;
}

}  // namespace aligngs
