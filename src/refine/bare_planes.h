// Surfaces too bare to be measured lie on planes of what was measured, where the photos allow it.
#pragma once

#include "refine/class_fit.h"
#include "refine/known_surfaces.h"
#include "refine/label_paths.h"
#include "refine/measured_planes.h"
#include "refine/photo_depth.h"

namespace aligngs {

/// Doubts about a plane where a network gave the photos depth, and perhaps labels. A cost of 0 leaves a doubt out.
struct PlaneDoubts {
  float far = 0;       ///< cost of a plane far from the depth between measured pixels
  double reach = 0.2;  ///< relative distance that costs half of it
  float turned = 0;    ///< cost of a plane that faces another way than the depth around the pixel
  double turn = 30;    ///< degrees that cost half of it
  float foreign = 1;   ///< cost of a class that was never measured on the plane
  ClassFitSettings classes;
};

struct BarePlaneSettings {
  MeasuredPlaneSettings planes;
  PlaneSettings without_labels =
      small_planes_along_axes();  ///< in place of planes.along_axes for photos without labels
  int width = 320;                ///< pixels; larger photos are divided among planes at this width
  int neighbours = 24;            ///< photos that are asked about a place, those that see most of the same
  LabelPathSettings paths;
  // Costs of a pixel that was measured: on a plane, and beside all.
  double reach = 0.015;       ///< relative distance from a plane that costs half of 1
  float of_own_depth = 0.5f;  ///< cost of staying where it is
  // Costs of the others: on a plane, and at the depth that lies between the measured ones.
  float of_between = 0.1f;     ///< added to what the latter costs as a surface
  float photo = 0.2f;          ///< where the photos' correlation is 0
  float hides = 0.5f;          ///< per photo that measured something behind the surface; counted twice at most
  float confirmed = 0.5f;      ///< taken off where another photo measured the same
  double agreement = 0.02;     ///< relative: depth that confirms
  double least_hidden = 0.04;  ///< relative: depth that is behind
  double farthest = 1.05;      ///< times what the photo measured: planes end there
  PlaneDoubts doubts;
  double strength = 3;     ///< weight of a plane where a sure measurement weighs 1
  double certainty = 0.3;  ///< of a pixel on a plane that was not measured itself
};

struct BarePlaneReport {
  std::vector<ScenePlane> planes;
  double on_planes = 0;  ///< share of the pixels that lie on one
};

/// For depth of a network that stereo and planes have corrected: it is nearly right where nothing was measured.
inline BarePlaneSettings bare_planes_of_network() {
  BarePlaneSettings settings;
  settings.doubts.far = 1;
  settings.doubts.turned = 0.5f;
  return settings;
}

/// Changes depth and certainty of `depths` (one per view; photo_depth()'s). Every pixel lies on one of the planes, or
/// on none, as its neighbours do where the photo shows no edge (refine/label_paths.h). Without planes nothing changes.
/// `labels`: one H x W map per view, each of which may be empty; or no maps at all.
/// Pixels on a known surface stay on it and find no other plane. A rug and its floor, or a door and its wall, are nearer
/// to each other than points of one plane are. Other pixels may lie on known planes, too.
/// Deterministic for any number of threads.
BarePlaneReport lay_on_bare_planes(const std::vector<MatchView>& views, const std::vector<Image<uint16_t>>& labels,
                                   const BarePlaneSettings& settings, const StereoSettings& stereo, ThreadPool& pool,
                                   std::vector<PhotoDepth>& depths, const KnownSurfaces& known = {});

}  // namespace aligngs
