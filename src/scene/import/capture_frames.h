// Shared by the layout readers when they put frames together. src/scene/import internal.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/import/capture.h"
#include "scene/import/intrinsics.h"

namespace aligngs {

/// Why depth is not used whose PNG has 8 bits: a picture of depth, which has no unit.
inline constexpr const char* kDepthOfEightBits = "its depth has 8 bits, as pictures of depth have: it has no unit";

/// EXIF orientations from here on turn a photo by a quarter.
inline constexpr int kFirstQuarterTurn = 5;
/// The remedy where depth or intrinsics fit such a photo only after its turn.
inline constexpr const char* kTurnedByExif =
    "the photo's EXIF orientation turns it by a quarter, and cameras and depth count for its stored pixels: store the "
    "photos upright, without an EXIF orientation";

/// Adds what `read` returns; what it throws as bad input leaves this frame out with a line.
template <class Read>
void add_frame(Capture& capture, const std::string& name, Read read) {
  use_or_leave_out(name, capture.left_out, [&] { capture.frames.push_back(read()); });
}

/// Pairs a frame with a camera whose image size is known: it is brought to the size of the photo, whose stored pixels
/// go first. Error{kBadInput} when the photo is missing, cannot be read or has another aspect.
/// `file`, which the camera is from, is named by errors of its lens.
void set_camera(CapturedFrame& frame, const ColmapCamera& camera, const std::filesystem::path& file);

/// Pairs it with intrinsics that come without a size, which are for the pixels as stored. Error{kBadInput} when they are
/// for photos of another size or that were turned (intrinsics.h).
void set_intrinsics(CapturedFrame& frame, const Intrinsics& lens);

/// "3 points without a usable position ..."
std::string note_of_unusable_points(size_t count);

/// The folder of this name in a folder, in small letters or in others ("Depth"); with this name where there is none.
std::filesystem::path folder_called(const std::filesystem::path& folder, const std::string& name);

/// The PNG when it is there, else the same that ends in .PNG; empty where there is neither. Error{kBadInput} where its
/// folder may not be entered.
std::filesystem::path file_if_there(const std::filesystem::path& file);

/// Sets the depth when the file is there.
void set_depth(CapturedFrame& frame, const std::filesystem::path& file);

/// For numbered files (img12.png) beside a list of `poses`: the index of each file's pose. Files and poses pair in
/// order when their numbers are equal, else by the number in the name. -1 where the list holds none. Error{kBadInput}
/// naming `file` when numbers do not help: names without one. Poses whose photo is missing get a line.
std::vector<int> poses_of_numbered(Capture& capture, const std::vector<std::filesystem::path>& photos, size_t poses,
                                   const std::filesystem::path& file);

/// Finds the frame of a name in a list: the one of that name, with or without extension. Else the only one whose path
/// ends like it, else the only one in another spelling (unicode_letters.h).
class FrameNames {
 public:
  explicit FrameNames(const std::vector<CapturedFrame>& frames);
  int find(const std::string& name) const;  ///< index of the frame; -1: none, or several

 private:
  int by_spelling(const std::string& name) const;

  std::vector<std::vector<std::string>> parts_;    ///< of each frame's name
  std::vector<std::vector<std::string>> spelled_;  ///< the same parts in their common spelling
};

/// Names that are paths of files become paths below the folder that all photos share, without extension and "..".
void shorten_names(Capture& capture);

/// Moves a world far from its origin to it, in double precision. Scales one of arbitrary units whose size is far from 1
/// by a power of ten. Capture::to_original takes it back.
void place_near_origin(Capture& capture);

}  // namespace aligngs
