// Objects by votes of the photos: one thing in a photo is one object, and two things of a class are two.
#pragma once

#include <cstdint>
#include <vector>

#include "gaussians/instances.h"
#include "scene/segment_file.h"

namespace aligngs {

/// A photo shows a Gaussian inside of a segment, or of none.
struct SegmentSighting {
  uint32_t gaussian = 0;
  uint16_t segment = 0;  ///< index into PhotoSegments::segments, or SegmentMap::kNone
  float pixels = 0;      ///< of the photo, > 0
};

struct PhotoSegments {
  std::vector<Segment> segments;
  std::vector<SegmentSighting> seen;  ///< by Gaussian
};

/// Pieces of a class (cells of its density links) join in the order of their votes, as long as these are for joining. A
/// photo that shows both pieces votes with the chance that a pixel of each lies in the same segment. The chance that
/// they lie in two segments of one class counts against it. Segments of different classes say nothing.
struct ObjectVoteOptions {
  double cell = 1;           ///< side of a cell / link distance of the class
  double enough_pixels = 2;  ///< of each piece in a photo for a full vote; fewer give a part of it
  double touching = 0.5;     ///< votes for joining pieces that density links: without photos that alone decides
  double apart = 1;          ///< votes against joining pieces that nothing links
};

/// As find_instances(), with the votes of the photos. A class of which no photo has a segment of a thing is grouped by
/// density alone, and so is everything without photos. Groups that are too small to be objects go to the neighbour for
/// which most votes are. The same for any number of threads.
std::vector<Instance> vote_instances(const GaussianModel& model, GaussianLabels& labels,
                                     const std::vector<PhotoSegments>& photos, double extent,
                                     const InstanceOptions& options, const ObjectVoteOptions& votes, ThreadPool& pool);

}  // namespace aligngs
