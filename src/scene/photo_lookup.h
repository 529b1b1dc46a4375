// Finds the file that a name in a camera file means: one answer for `import`, given cameras, `train` and `run`.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/picture_format.h"

namespace aligngs {

/// A name that begins with a dot: "._IMG_1.jpg" is no photo but what macOS keeps beside one.
bool is_hidden(const std::filesystem::path& file);
/// A name from a camera file as a relative path: backslashes become slashes, "./" goes.
std::string slashed_name(std::string name);
/// The name of a view: the name of its image without extension (up to the last dot), subfolders kept, in UTF-8.
std::string view_name_of(const std::string& image_name);

/// Names are tried in this order, and the first rule that finds a file decides:
///   1. the very path below one of the folders;
///   2. the same with the name written in the other encoding (UTF-8, latin-1);
///   3. the same folder and stem, with another picture extension or none in the name ("a.JPG", "a.png" for "a.jpg");
///   4. the same in another spelling: cases, and letters that macOS decomposes (unicode_letters.h);
///   5. a photo elsewhere below `photos` whose path and the name end alike, up to the whole of the shorter one;
///   6. the same in another spelling.
/// Two files under one rule are no answer, since a guess would be silent.
class PhotoLookup {
 public:
  /// `photos`: the folder that holds them, searched with its subfolders; may be empty. `beside`: a folder to which
  /// names may be relative as well, not searched. `subfolders`: alike, after it, none before the others.
  explicit PhotoLookup(std::filesystem::path photos, std::filesystem::path beside = {},
                       std::vector<std::filesystem::path> subfolders = {});

  static constexpr const char* kMissing = "the photo is missing";

  struct Answer {
    std::filesystem::path file;  ///< empty: not found
    std::string problem;         ///< why not: missing, or which files it could be
  };
  /// Error{kBadInput} where nothing is found and a folder that it may lie in may not be read.
  Answer find(const std::string& name) const;
  const std::filesystem::path& photos() const { return photos_; }
  /// Whether it failed because several files could be meant.
  static bool is_ambiguous(const Answer& answer);

 private:
  struct Candidate {
    std::filesystem::path file;
    std::vector<std::string> parts;      ///< folders and stem below `photos`, in UTF-8
    std::vector<std::string> spellings;  ///< the common spelling of each part
  };
  struct Entry {
    std::filesystem::path path;
    std::string name, stem;  ///< in the common spelling
  };
  using Folders = std::vector<std::filesystem::path>;
  Answer exact(const Folders& folders, const std::string& name) const;
  Answer by_other_extension(const Folders& folders, const std::string& name) const;
  Answer by_other_spelling(const Folders& folders, const std::string& name) const;
  Answer by_ending(const std::string& name, bool any_spelling) const;
  /// A photo of this name of a kind that is not read, such as TIFF; empty: none.
  std::string of_unread_kind(const std::string& name) const;
  void require_readable_places(const std::string& name) const;
  const std::vector<Candidate>& candidates() const;
  const std::vector<Entry>& entries(const std::filesystem::path& folder) const;

  std::vector<Folders> places_;  ///< in order of preference; the folders of one place are equals
  std::filesystem::path photos_;
  mutable bool listed_ = false;
  mutable std::vector<Candidate> candidates_;
  mutable std::filesystem::path barred_;  ///< the first folder at or below `photos_` that may not be read; or empty
  mutable std::map<std::filesystem::path, std::vector<Entry>> entries_;  ///< of folders that were listed
};

/// The folders in which photos of a data set may lie: images/ when it is there, and the data set's own folder. Each
/// subfolder counts as well (input/, rgb/, ...) when there is no images/.
PhotoLookup photos_of_data_set(const std::filesystem::path& folder);

}  // namespace aligngs
