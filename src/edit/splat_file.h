// A file of splats as a person gives it: an object for a room, or a scene to look at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gaussians/gaussian_model.h"

namespace aligngs {

struct SplatFile {
  GaussianModel model;
  std::string class_name;  ///< the commonest class of a labelled file; empty: none, or of unknown labels
};

/// Splats in the common layout of 3DGS, with or without labels. Error{kBadInput} for a file that is none, for values
/// that are not finite, and for one without Gaussians or with more than 20 million.
SplatFile read_splat_file(const std::filesystem::path& file);

/// The class that most Gaussians have; -1: none has one.
int commonest_label(const std::vector<uint16_t>& labels);

}  // namespace aligngs
