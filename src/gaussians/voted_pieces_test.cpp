#include "gaussians/voted_pieces.h"

#include <gtest/gtest.h>

#include <utility>

namespace aligngs {
namespace {

constexpr uint16_t kChairClass = 19;

PieceView shown(uint32_t photo, uint16_t segment, double pixels) { return {photo, segment, kChairClass, pixels}; }

/// Two touching pieces of ten members each that photos show like this; whether they join.
bool two_pieces_join(PieceViews first, PieceViews second) {
  ThreadPool pool(1);
  Pieces pieces({std::move(first), std::move(second)}, {10, 10}, {}, pool);
  pieces.join({{0, 1, true, 0}});
  return pieces.of(0) == pieces.of(1);
}

TEST(VotedPieces, WithoutPhotosTouchingDecides) { EXPECT_TRUE(two_pieces_join({}, {})); }

TEST(VotedPieces, TwoSegmentsOfOneClassKeepPiecesApart) {
  EXPECT_FALSE(two_pieces_join({shown(0, 1, 40)}, {shown(0, 2, 40)}));
}

TEST(VotedPieces, OneSegmentInMorePhotosOutvotesTwoInFewer) {
  EXPECT_TRUE(two_pieces_join({shown(0, 1, 40), shown(1, 5, 40)}, {shown(0, 2, 40), shown(1, 5, 40)}));
}

TEST(VotedPieces, PiecesThatTouchNothingJoinThroughASharedSegment) {
  ThreadPool pool(1);
  Pieces pieces({{shown(0, 1, 40), shown(1, 3, 40)}, {shown(0, 1, 40), shown(1, 3, 40)}}, {10, 10}, {}, pool);
  pieces.join({});
  EXPECT_NE(pieces.of(0), pieces.of(1));
  pieces.join(pieces.links_by_segments(5));
  EXPECT_EQ(pieces.of(0), pieces.of(1));
  EXPECT_EQ(pieces.size(pieces.of(0)), 20u);
}

TEST(VotedPieces, ASmallPieceGoesToWhatItTouches) {
  ThreadPool pool(1);
  Pieces pieces({{shown(0, 1, 40)}, {shown(0, 1, 40)}, {shown(0, 2, 40)}}, {2, 10, 10}, {}, pool);
  pieces.join({{0, 2, true, 0}});
  ASSERT_NE(pieces.of(0), pieces.of(2)) << "the photo is against it";
  pieces.join_small(5);
  EXPECT_EQ(pieces.of(0), pieces.of(2));
  EXPECT_NE(pieces.of(0), pieces.of(1));
}

}  // namespace
}  // namespace aligngs
