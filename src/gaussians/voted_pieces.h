// Pieces of a class that join by the votes of the photos (object_votes.h).
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/thread_pool.h"
#include "gaussians/object_votes.h"

namespace aligngs {

inline constexpr uint32_t kNoPiece = ~0u;

/// Pixels of a piece in a segment of a photo.
struct PieceView {
  uint32_t photo = 0;
  uint16_t segment = 0;  ///< SegmentMap::kNone: in no segment of a thing
  uint16_t label = 0;    ///< class that the photo gives the segment
  double pixels = 0;
  bool is_thing() const { return segment != SegmentMap::kNone; }
};
using PieceViews = std::vector<PieceView>;  ///< by photo, then segment
/// The order of PieceViews.
bool before(const PieceView& a, const PieceView& b);

/// Two pieces that may join; a < b.
struct PieceLink {
  uint32_t a = 0, b = 0;
  bool touches = false;
  double votes = 0;
};

/// Pieces of one class that join. They are numbered from 0; joined ones have the number of one of them. The same for any
/// number of threads.
class Pieces {
 public:
  /// `views` and `sizes` of each piece; a size counts its members.
  Pieces(std::vector<PieceViews> views, std::vector<size_t> sizes, const ObjectVoteOptions& options, ThreadPool& pool)
      : views_(std::move(views)), sizes_(std::move(sizes)), sets_(views_.size()), options_(options), pool_(pool) {}

  uint32_t of(uint32_t cell) { return sets_.find(cell); }
  size_t size(uint32_t piece) const { return sizes_[piece]; }

  /// Joins each time all pairs that are each other's best, until no votes are for joining.
  void join(std::vector<PieceLink> links);
  /// Links between pieces of at least `least` members that touch nothing of each other, but share a segment.
  std::vector<PieceLink> links_by_segments(size_t least);
  /// Pieces of fewer than `least` members join the touching piece of more for which most votes are.
  void join_small(size_t least);

 private:
  /// Brings links to the pieces of now: one for each pair, with its votes.
  void renew(std::vector<PieceLink>& links);
  void unite(uint32_t a, uint32_t b);

  std::vector<PieceViews> views_;
  std::vector<size_t> sizes_;
  DisjointSets sets_;
  ObjectVoteOptions options_;
  ThreadPool& pool_;
  std::vector<PieceLink> links_;
};

}  // namespace aligngs
