#include "engine/losses/map_losses.h"

#include <string>

#include "core/error.h"
#include "engine/losses/crease.h"
#include "engine/losses/depth_log.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/depth_pearson.h"
#include "engine/losses/multi_view_geometric.h"
#include "engine/losses/multi_view_photometric.h"
#include "engine/losses/normal_boundary.h"
#include "engine/losses/normal_consistency.h"
#include "engine/losses/photometric.h"
#include "engine/losses/prior_normal.h"
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

  const bool multi_view = in.neighbour && s.has_multi_view_weight();
  const bool depth_terms =
      s.pearson_weight != 0 || s.log_depth_weight != 0 || s.normal_consistency_weight != 0 || multi_view;
  if (depth_terms || (s.normal_boundary_weight != 0 && !s.paper_normals)) compute_depth_map(in, workspace);
  if (s.normal_consistency_weight != 0 || s.normal_boundary_weight != 0 || s.crease_weight != 0 ||
      s.prior_normal_weight != 0) {
    compute_unit_normals(in, workspace);
  }
  // loss() returns the unweighted value and adds weighted gradients.
  const auto add = [&](float weight, double& term, const auto& loss) {
    if (weight == 0) return;
    const double value = loss(static_cast<double>(weight));
    term += value;
    terms.total += weight * value;
  };
  add(s.pearson_weight, terms.pearson, [&](double w) { return pearson_depth_loss(in, w, workspace); });
  add(s.log_depth_weight, terms.log_depth, [&](double w) { return log_depth_loss(in, w, workspace); });
  add(s.normal_consistency_weight, terms.normal_consistency,
      [&](double w) { return normal_consistency_loss(in, w, workspace, gradients); });
  add(s.normal_boundary_weight, terms.normal_boundary,
      [&](double w) { return normal_boundary_loss(in, w, workspace, gradients); });
  add(s.crease_weight, terms.crease, [&](double w) { return crease_loss(in, w, workspace, gradients); });
  add(s.prior_normal_weight, terms.prior_normal,
      [&](double w) { return prior_normal_loss(in, w, workspace, gradients); });
  if (multi_view) {
    const ViewAgreement agreement = compare_with_neighbour(in, workspace);
    add(s.multi_view_geometric_weight, terms.multi_view_geometric,
        [&](double w) { return multi_view_geometric_loss(in, w, agreement, workspace); });
    add(s.multi_view_photometric_weight, terms.multi_view_photometric,
        [&](double w) { return multi_view_photometric_loss(in, w, agreement, workspace, gradients); });
  }
  if (depth_terms) chain_depth_map(in, workspace, gradients);
}

template void map_losses<float>(const MapLossInputs<float>&, LossTerms&, MapGradients<float>&);
template void map_losses<double>(const MapLossInputs<double>&, LossTerms&, MapGradients<double>&);

}  // namespace aligngs
