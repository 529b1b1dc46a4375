// The file of an edit's change: RUN/edits/NNNN-DIGEST.edit.
#pragma once

#include <filesystem>
#include <string>

#include "edit/edit_change.h"

namespace aligngs {

/// A gzip stream of a line of JSON and then the lists, little-endian.
std::string encode_change(const EditChange& change);
/// Error{kBadInput} for what is damaged or of another version.
EditChange decode_change(const std::string& bytes, const std::filesystem::path& name_for_errors);

/// Writes the file of a change into `folder`, atomically, and returns its name. The name tells its content, so that a
/// reader of an older list never sees the file of a newer one.
std::string write_change(const std::filesystem::path& folder, const EditChange& change);
EditChange read_change(const std::filesystem::path& file);

/// Whether a text has the form of such a name.
bool is_change_name(const std::string& name);

}  // namespace aligngs
