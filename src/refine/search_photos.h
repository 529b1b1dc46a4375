// Photos as a search looks at them: a wide one in small copies, where the same patch shows more of what is around it.
#pragma once

#include <deque>
#include <vector>

#include "core/image.h"
#include "refine/guided_match.h"

namespace aligngs {

/// A photo in which tracks begin, or in which their points are looked for.
struct TrackPhoto {
  int view = 0;                      ///< its number in observations
  const MatchView* match = nullptr;  ///< with depth where tracks begin
  const ImageF* mask = nullptr;      ///< 0 = no corner here; may be null or empty
};

/// The photos themselves for a near search. For a wide one, photos larger than 320 x 240 are reduced to as many pixels.
/// The search window grows with the photo, but the patches do not, so larger photos give more wrong matches.
class SearchPhotos {
 public:
  /// The photos outlive it.
  SearchPhotos(const std::vector<TrackPhoto>& photos, bool wide);
  SearchPhotos(const SearchPhotos&) = delete;
  SearchPhotos& operator=(const SearchPhotos&) = delete;

  const MatchView& match(size_t photo) const { return *photos_[photo].match; }
  /// Empty = corners anywhere.
  const ImageF& mask(size_t photo) const;
  /// Overlap of photos: one entry per photo.
  std::vector<const MatchView*> matches() const;

  /// A place in the photo that was given, from one in the photo that is searched, and back.
  Vec2d to_given(size_t photo, const Vec2d& pixel) const;
  Vec2d from_given(size_t photo, const Vec2d& pixel) const;
  /// A match found in the photo that is searched, in pixels of the one that was given.
  Match to_given(size_t photo, Match found) const;

 private:
  struct Searched {
    const MatchView* match = nullptr;
    const ImageF* mask = nullptr;
    double across = 1, down = 1;  ///< pixels of the given photo per pixel of the searched one
  };
  struct Copy {
    MatchView match;
    ImageF mask;
  };
  std::vector<Searched> photos_;
  std::deque<Copy> copies_;  ///< a deque: growing moves none
};

}  // namespace aligngs
