// Segments of a photo by EoMT: things one by one, and each stuff class once (the publisher's rules).
#pragma once

#include <vector>

#include "nn/eomt/semantic.h"
#include "scene/stuff_classes.h"

namespace aligngs::nn {

struct PanopticOptions {
  double class_threshold = 0.8;    ///< a query counts when its best class has a larger share
  double overlap_threshold = 0.8;  ///< pixels that a query wins per pixel of its mask, at least
  std::vector<int> stuff = ade20k_stuff_classes();
};

struct PanopticSegment {
  int id = 0, category = 0;
  float score = 0;  ///< share of the class, of the query that opened the segment
};

struct PanopticMap {
  int width = 0, height = 0;
  std::vector<int> segments;          ///< per pixel: an id, or -1
  std::vector<int> categories;        ///< per pixel: a class, or the number of classes where there is none
  std::vector<PanopticSegment> list;  ///< by id
};

/// prediction: of eomt_padded(); width, height: of the result, the photo's own size as published.
PanopticMap panoptic_map(Compute& compute, const EomtPrediction& prediction, const EomtPadded& padded, int width,
                         int height, const PanopticOptions& options = {});

}  // namespace aligngs::nn
