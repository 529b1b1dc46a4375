// How photos get their cameras: what a person asked for, and what follows from it and from the installed weights.
#pragma once

#include <string>

#include "priors/model_store.h"
#include "priors/poses_method.h"

namespace aligngs {

struct CameraRequest {
  PosesMethod method = PosesMethod::kAuto;
  std::string model;    ///< weights of the network; empty: see choose_cameras()
  std::string cameras;  ///< given: a COLMAP model or transforms.json; empty: the one beside the photos
  MetresChoice metres = MetresChoice::kAuto;
  bool camera_from_rays = false;
};

struct CameraChoice {
  PosesMethod method = PosesMethod::kAuto;  ///< another once it is made
  std::string model;                        ///< of a network; else empty
  std::string reason;                       ///< one sentence without a final stop
  bool chosen = false;                      ///< "auto" took the network, among those that are installed
};

/// The method of a word of "--method". Error{kUsage} for another word.
PosesMethod poses_method(const std::string& word);

/// "auto" is given where cameras are named. Else it is the method of the named weights or of an option that only one
/// method has. Else it is that of the first installed network of camera_teachers(). Error{kWeights} where there is
/// none. Error{kUsage} where the weights or an option are of another method. Weights that are named may be missing.
CameraChoice choose_cameras(const CameraRequest& request, const ModelStore& store);

/// The network of the cameras, for depth of photos that have cameras: named by an option, or the best installed one.
/// Null without one, or if its weights are missing. Error{kUsage} as above.
const PublishedModel* installed_camera_network(const CameraRequest& request, const ModelStore& store);

/// Why a network that nobody named may not be used in every way; empty where it may. `purpose`: "cameras", "depth".
std::string terms_of_choice(const PublishedModel& model, const char* purpose);

}  // namespace aligngs
