// scene.ply in the standard 62-float 3DGS layout, and scene.labels.ply with a class per Gaussian.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gaussians/gaussian_model.h"

namespace aligngs {

struct PlyFile;

struct GaussianLabels {
  std::string label_set;            ///< e.g. "ade20k150"
  std::vector<uint16_t> label;      ///< class or kNoLabel
  std::vector<uint16_t> instance;   ///< 0 = none
  std::vector<uint8_t> confidence;  ///< probability of the class x 255
};

/// Strict: exactly the 62 float32 properties in order, binary little-endian, no time, no path: what every viewer of
/// splats reads.
void write_gaussian_ply(const std::filesystem::path& path, const GaussianModel& model);
/// The same properties, then label, instance and confidence, for readers that look properties up by name. Normals,
/// which are zero, are left out. Harmonics that are zero everywhere are left out, so that a row has 45, 24, 9 or 0 values
/// f_rest_*.
void write_labelled_gaussian_ply(const std::filesystem::path& path, const GaussianModel& model,
                                 const GaussianLabels& labels);
/// Any property order, type and endianness; missing SH are zero; semantic_0.. are read when present.
/// Non-finite values and missing required properties are Error{kBadInput}.
GaussianModel read_gaussian_ply(const std::filesystem::path& path);
/// The same for the bytes of a file.
GaussianModel decode_gaussian_ply(const std::string& bytes, const std::filesystem::path& name_for_errors);
/// The same for the columns of a file that has been decoded.
GaussianModel gaussians_of_ply(const PlyFile& file, const std::filesystem::path& name_for_errors);

struct LabelledModel {
  GaussianModel model;
  GaussianLabels labels;  ///< without the name of the label set
};
/// The same for a file with labels. Error{kBadInput} also where it has none.
LabelledModel read_labelled_gaussian_ply(const std::filesystem::path& path);

}  // namespace aligngs
