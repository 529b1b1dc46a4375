#include "engine/losses/map_losses.h"

#include <string>

#include "core/error.h"
#include "engine/losses/crease.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/depth_pearson.h"
#include "engine/losses/multi_view_geometric.h"
#include "engine/losses/multi_view_photometric.h"
#include "engine/losses/normal_boundary.h"
#include "engine/losses/normal_consistency.h"
#include "engine/losses/photometric.h"
#include "engine/losses/pixel_terms.h"
#include "engine/losses/unit_normal.h"

namespace aligngs {
namespace {

struct Size {
  int width = 0, height = 0;
};

void require_size(const Size& map, const Size& wanted, const std::string& view, const char* field) {
  if (map.width == wanted.width && map.height == wanted.height) return;
  throw Error({ErrorKind::kFailed,
               "a map of view " + view + " is " + std::to_string(map.width) + " x " + std::to_string(map.height) +
                   ", the rendering " + std::to_string(wanted.width) + " x " + std::to_string(wanted.height),
               {},
               field,
               "bring every map of a view to the size of its camera (prepare_view)"});
}

/// One loss of the maps: what it may read and where its gradients go.
template <class T>
struct MapLossCall {
  const MapLossInputs<T>& in;
  MapLossWorkspace<T>& workspace;
  MapGradients<T>& gradients;
  ViewAgreement agreement;  ///< with a neighbour
};

/// Returns the unweighted value and adds `weight` times the gradient.
template <class T>
using MapLoss = double (*)(const MapLossCall<T>& call, double weight);

template <class T>
struct MapLossRow {
  Loss loss;
  MapLoss<T> compute;
};

/// Losses that compare pixels, or that need sums over all of them first, with loops of their own.
template <class T>
constexpr MapLossRow<T> kLoopsOfTheirOwn[] = {
    {Loss::kPearson, [](const MapLossCall<T>& c, double w) { return pearson_depth_loss(c.in, w, c.workspace); }},
    {Loss::kNormalConsistency,
     [](const MapLossCall<T>& c, double w) { return normal_consistency_loss(c.in, w, c.workspace, c.gradients); }},
    {Loss::kNormalBoundary,
     [](const MapLossCall<T>& c, double w) { return normal_boundary_loss(c.in, w, c.workspace, c.gradients); }},
    {Loss::kCrease, [](const MapLossCall<T>& c, double w) { return crease_loss(c.in, w, c.workspace, c.gradients); }},
    {Loss::kMultiViewGeometric,
     [](const MapLossCall<T>& c, double w) { return multi_view_geometric_loss(c.in, w, c.agreement, c.workspace); }},
    {Loss::kMultiViewPhotometric,
     [](const MapLossCall<T>& c, double w) {
       return multi_view_photometric_loss(c.in, w, c.agreement, c.workspace, c.gradients);
     }},
};

template <class T>
double compute_loss(Loss loss, const MapLossCall<T>& call, double weight) {
  if (const PixelTermLoss<T> term = pixel_term_loss<T>(loss)) {
    return term(call.in, weight, call.workspace, call.gradients);
  }
  for (const MapLossRow<T>& row : kLoopsOfTheirOwn<T>) {
    if (row.loss == loss) return row.compute(call, weight);
  }
  throw Error({ErrorKind::kFailed, "no code computes the loss " + std::string(row_of(loss).name), {}, {}, {}});
}

}  // namespace

void require_map_sizes(const TrainingView& view, int width, int height) {
  const Size wanted{width, height};
  const ViewData& data = view.data;
  require_size({data.camera.width, data.camera.height}, wanted, data.name, "camera");
  require_size({data.color.width, data.color.height}, wanted, data.name, "color");
  const auto optional = [&](const auto& map, const char* field) {
    if (!map.empty()) require_size({map.width, map.height}, wanted, data.name, field);
  };
  optional(data.mask, "mask");
  optional(data.prior_depth, "prior_depth");
  optional(data.labels, "labels");
  optional(view.depth_weight, "depth_weight");
  optional(view.prior_normal, "prior_normal");
  optional(view.label_edge, "label_edge");
}

template <class T>
void map_losses(const MapLossInputs<T>& in, LossTerms& terms, MapGradients<T>& gradients) {
  require_map_sizes(in.view, in.maps.width, in.maps.height);
  MapLossWorkspace<T> own;
  MapLossWorkspace<T>& workspace = in.workspace ? *in.workspace : own;
  const LossSettings& s = in.settings;

  photometric_losses(in, workspace, terms, gradients);

  const bool neighbour = in.neighbour != nullptr;
  const bool depth_terms = s.needs(kNeedsDepth, neighbour);
  if (depth_terms || (s.needs(kNeedsGuardedDepth, neighbour) && !s.paper_normals)) compute_depth_map(in, workspace);
  if (s.needs(kNeedsUnitNormal, neighbour)) compute_unit_normals(in, workspace);
  MapLossCall<T> call{in, workspace, gradients, {}};
  if (neighbour && s.has(LossStage::kTwoViews)) call.agreement = compare_with_neighbour(in, workspace);
  for (const LossRow& row : kLossCatalogue) {
    const bool acts = row.stage == LossStage::kGeometry || (row.stage == LossStage::kTwoViews && neighbour);
    const float weight = s.weight[row.loss];
    if (acts && weight != 0) terms.add(row.loss, weight, compute_loss(row.loss, call, static_cast<double>(weight)));
  }
  if (depth_terms) chain_depth_map(in, workspace, gradients);
}

template void map_losses<float>(const MapLossInputs<float>&, LossTerms&, MapGradients<float>&);
template void map_losses<double>(const MapLossInputs<double>&, LossTerms&, MapGradients<double>&);

}  // namespace aligngs
