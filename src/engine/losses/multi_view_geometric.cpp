#include "engine/losses/multi_view_geometric.h"

#include <array>
#include <cmath>

#include "core/error.h"
#include "engine/formulas/two_views.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

void require_photo(const TrainingView& view) {
  const Camera& camera = view.data.camera;
  const ImageF& photo = view.data.color;
  if (photo.width == camera.width && photo.height == camera.height && photo.channels == 3) return;
  throw Error({ErrorKind::kFailed,
               "the photo of view " + view.data.name + " does not have the size of its camera",
               {},
               "color",
               "bring every map of a view to the size of its camera (prepare_view)"});
}

}  // namespace

template <class T>
void keep_neighbour_depth(const MapLossInputs<T>& in, MapLossWorkspace<T>& workspace) {
  compute_depth_map(in, workspace);
  for (size_t i = 0; i < workspace.depth.size(); ++i) {
    if (workspace.validity[i] != kDepthTight) workspace.depth[i] = T(0);
  }
  workspace.neighbour_depth.swap(workspace.depth);
}

template <class T>
ViewAgreement compare_with_neighbour(const MapLossInputs<T>& in, MapLossWorkspace<T>& workspace) {
  require_photo(in.neighbour->view);
  const TwoViews<T> views(in.view.data.camera, in.neighbour->view.data.camera);
  const int width = in.maps.width, height = in.maps.height;
  workspace.agreement.resize(in.maps.pixels());
  workspace.agreement_slope.resize(in.maps.pixels());
  const auto [count, distance] = sum_rows<2>(in.pool, height, workspace.row_sums, [&](int y) {
    double valid = 0, sum = 0;
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      Reprojection<T> r;
      if (workspace.validity[i] == kDepthTight) {
        r = forward_backward(views, in.neighbour->depth, workspace.depth[i], {T(x) + T(0.5), T(y) + T(0.5)});
      }
      const T w = r.valid ? std::exp(-r.distance) : T(0);
      workspace.agreement[i] = w;
      workspace.agreement_slope[i] = w * r.slope;
      valid += r.valid ? 1 : 0;
      sum += static_cast<double>(w * r.distance);
    }
    return std::array<double, 2>{valid, sum};
  });
  return {count, distance};
}

template <class T>
double multi_view_geometric_loss(const MapLossInputs<T>& in, double weight, const ViewAgreement& agreement,
                                 MapLossWorkspace<T>& workspace) {
  if (!enough_valid(agreement.count, static_cast<double>(in.maps.pixels()))) return 0;
  const T factor = static_cast<T>(weight / agreement.count);
  const int width = in.maps.width;
  for_each_row(in.pool, in.maps.height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * width;
    for (size_t i = begin; i < begin + width; ++i) {
      workspace.depth_gradient[i] += factor * workspace.agreement_slope[i];
    }
  });
  return agreement.distance / agreement.count;
}

template void keep_neighbour_depth<float>(const MapLossInputs<float>&, MapLossWorkspace<float>&);
template void keep_neighbour_depth<double>(const MapLossInputs<double>&, MapLossWorkspace<double>&);
template ViewAgreement compare_with_neighbour<float>(const MapLossInputs<float>&, MapLossWorkspace<float>&);
template ViewAgreement compare_with_neighbour<double>(const MapLossInputs<double>&, MapLossWorkspace<double>&);
template double multi_view_geometric_loss<float>(const MapLossInputs<float>&, double, const ViewAgreement&,
                                                 MapLossWorkspace<float>&);
template double multi_view_geometric_loss<double>(const MapLossInputs<double>&, double, const ViewAgreement&,
                                                  MapLossWorkspace<double>&);

}  // namespace aligngs
