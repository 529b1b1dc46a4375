// The default network for cameras: the order of preference, and its reasons.
#pragma once

#include <string>
#include <vector>

#include "priors/model_store.h"

namespace aligngs {

struct CameraNetwork {
  std::string model;   ///< name of the weights
  std::string reason;  ///< for its place in the order, one line
};

/// All networks that find cameras, the preferred first. Accuracy of the poses decides among those that anyone may use;
/// those
/// with terms that not everyone can accept come after them.
const std::vector<CameraNetwork>& camera_networks();

/// The first that is installed; null: none. One that is not free to use in every way is taken only where no other is
/// installed.
const CameraNetwork* best_camera_network(const ModelStore& store);

/// "--method" of a network that finds cameras: "vggt" or "da3".
std::string method_of_camera_network(const std::string& model);

}  // namespace aligngs
