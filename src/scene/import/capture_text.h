// Small parsers that the layout readers share.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/rigid.h"

namespace aligngs {

/// All numbers of a text file, "nan" and "inf" included, exponents also with D; '#' starts a comment. Those of a .npy
/// file in the order of its rows. Error{kBadInput} for other words, and for numbers that are too large for an array.
std::vector<double> read_numbers(const std::filesystem::path& file);

/// The names of a list: one a line, or several with commas between them. Blanks belong to names; lines that begin with
/// '#' are comments. Error{kBadInput} without any name: nobody asks for no frame, and all of them would be used.
std::vector<std::string> read_name_list(const std::filesystem::path& file);

/// A rigid motion from 16 (or 12) row-major numbers. Error{kBadInput} unless the rotation is one within 1e-2 and the
/// last of four rows is 0 0 0 1. A column-major matrix, which has the translation there, is named.
Rigidd rigid_from_matrix(std::span<const double> m, const std::filesystem::path& file, const std::string& field);
/// The same for a matrix whose rotation is scaled by one factor, which is returned: its columns are that long.
Rigidd rigid_from_scaled_matrix(std::span<const double> m, const std::filesystem::path& file, const std::string& field,
                                double& scale);
bool all_finite(const double* values, size_t count);

/// OpenGL camera-to-world (x right, y up, z back) to OpenCV world-to-camera.
Rigidd opencv_world_to_camera_from_opengl(const Rigidd& camera_to_world);

/// Order of people: runs of digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b);

/// Files of a folder with one of the given extensions (lower case, with dot), in natural order; hidden ones are not
/// listed.
std::vector<std::filesystem::path> list_files(const std::filesystem::path& folder,
                                              const std::vector<std::string>& extensions);
/// `stem`.txt, or `stem`.npy where only that is there.
std::filesystem::path numbers_file(const std::filesystem::path& stem);
std::filesystem::path first_existing(const std::vector<std::filesystem::path>& candidates);

}  // namespace aligngs
