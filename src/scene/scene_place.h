// Folders that a scene may take: free ones, and those that hold a scene of this program's making.
#pragma once

#include <filesystem>
#include <vector>

namespace aligngs {

class FolderReplacement;

/// Whether scene.json says that this program wrote the folder.
bool is_own_scene(const std::filesystem::path& folder);

/// Puts that mark into scene.json, whose other fields stay as they are. Error{kBadInput} when it is no JSON object.
void mark_as_own(const std::filesystem::path& folder);

/// Error{kUsage} when `folder` is no place for a scene made from `sources` (files and folders):
///   it is a source, lies in one or holds one;
/// it is taken: it exists and is not empty, unless `overwrite` is set, and even then only is_own_scene() may be
/// replaced.
void require_scene_place(const std::filesystem::path& folder, bool overwrite,
                         const std::vector<std::filesystem::path>& sources = {});

/// Puts a finished scene in its place: require_scene_place() once more, then FolderReplacement::commit(). Files and
/// folders that somebody else laid beside the parts of the former scene stay there. They are linked or copied before
/// the former scene goes. Its masks stay as `masks.old` where the new scene has none, whose photos are perhaps others.
/// Error{kResources} when something cannot be kept; both scenes then stay as they were.
void place_scene(FolderReplacement& replacement, bool overwrite,
                 const std::vector<std::filesystem::path>& sources = {});

}  // namespace aligngs
