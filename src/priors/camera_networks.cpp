#include "priors/camera_networks.h"

namespace aligngs {

// AUC at 30 degrees: mean over 19 data sets, by the publishers of the benchmark. The commercial weights are of the same
// network as VGGT-1B; their own figure is not published.
const std::vector<CameraNetwork>& camera_networks() {
  static const std::vector<CameraNetwork> order = {
      {"vggt-1b-commercial", "the most accurate cameras (pose AUC 0.70) with commercial use allowed"},
      {"da3-base", "free to use, pose AUC 0.57 with a ninth of the arithmetic"},
      {"da3-small", "free to use, pose AUC 0.48, the smallest"},
      {"lingbot-map", "no published accuracy, and its provenance is an open question"},
      {"vggt-1b", "pose AUC 0.70, non-commercial use only"},
      {"da3-giant", "non-commercial use only"},
      {"da3-large", "non-commercial use only"},
  };
  return order;
}

const CameraNetwork* best_camera_network(const ModelStore& store) {
  for (const CameraNetwork& network : camera_networks()) {
    if (store.installed(published_model(network.model))) return &network;
  }
  return nullptr;
}

std::string method_of_camera_network(const std::string& model) { return model.rfind("da3-", 0) == 0 ? "da3" : "vggt"; }

}  // namespace aligngs
