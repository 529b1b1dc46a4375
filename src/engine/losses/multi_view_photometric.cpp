#include "engine/losses/multi_view_photometric.h"

#include <array>

#include "engine/formulas/depth_terms.h"
#include "engine/formulas/patch_score.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

template <class T>
void make_grey(const ImageF& photo, ThreadPool* pool, std::vector<T>& grey) {
  grey.resize(static_cast<size_t>(photo.width) * photo.height);
  for_each_row(pool, photo.height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * photo.width;
    for (size_t i = begin; i < begin + photo.width; ++i) {
      const float* c = &photo.data[3 * i];
      grey[i] = static_cast<T>(grey_of(c[0], c[1], c[2]));
    }
  });
}

template <class T>
BlendedPlane<T> plane_at(const RenderMaps<T>& maps, size_t i) {
  const size_t n = maps.pixels();
  return {{maps.normal[i], maps.normal[n + i], maps.normal[2 * n + i]}, maps.distance[i], maps.alpha[i]};
}

}  // namespace

template <class T>
double multi_view_photometric_loss(const MapLossInputs<T>& in, double weight, const ViewAgreement& agreement,
                                   MapLossWorkspace<T>& workspace, MapGradients<T>& gradients) {
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  if (!enough_valid(agreement.count, static_cast<double>(pixels))) return 0;
  const TwoViews<T> views(in.view.data.camera, in.neighbour->view.data.camera);
  make_grey(in.view.data.color, in.pool, workspace.grey);
  make_grey(in.neighbour->view.data.color, in.pool, workspace.neighbour_grey);
  const GreyImages<T> images{workspace.grey.data(), workspace.neighbour_grey.data()};
  const double share = patch_share(agreement.count, static_cast<double>(pixels));

  // Gradients wait in patch_gradient until it is known over how many patches the mean goes.
  workspace.patch_gradient.resize(4 * pixels);
  workspace.patch_used.resize(pixels);
  const auto [patches, total] = sum_rows<2>(in.pool, height, workspace.row_sums, [&](int y) {
    double count = 0, score = 0;
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      workspace.patch_used[i] = 0;
      const T w = workspace.agreement[i];
      if (!(w > T(0)) || !draws_patch(in.neighbour->seed, i, share)) continue;
      const PatchScore<T> s = patch_score(views, images, plane_at(in.maps, i), x, y);
      if (!s.used) continue;
      workspace.patch_used[i] = 1;
      T* g = &workspace.patch_gradient[4 * i];
      for (int k = 0; k < 3; ++k) g[k] = w * s.d_normal[k];
      g[3] = w * s.d_distance;
      count += 1;
      score += static_cast<double>(w * s.score);
    }
    return std::array<double, 2>{count, score};
  });
  if (patches == 0) return 0;
  const T factor = static_cast<T>(weight / patches);
  for_each_row(in.pool, height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * width;
    for (size_t i = begin; i < begin + width; ++i) {
      if (workspace.patch_used[i] == 0) continue;
      const T* g = &workspace.patch_gradient[4 * i];
      for (size_t k = 0; k < 3; ++k) gradients.normal[k * pixels + i] += factor * g[k];
      gradients.distance[i] += factor * g[3];
    }
  });
  return total / patches;
}

template double multi_view_photometric_loss<float>(const MapLossInputs<float>&, double, const ViewAgreement&,
                                                   MapLossWorkspace<float>&, MapGradients<float>&);
template double multi_view_photometric_loss<double>(const MapLossInputs<double>&, double, const ViewAgreement&,
                                                    MapLossWorkspace<double>&, MapGradients<double>&);

}  // namespace aligngs
