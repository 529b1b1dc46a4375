#include "train/live_snapshot.h"

#include <cmath>
#include <string>

#include "gaussians/gaussian_ply.h"
#include "gaussians/soft_labels.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

constexpr size_t kFloats = 14;  ///< x y z, f_dc 3, opacity, scale 3, rot 4
constexpr const char* kNames[kFloats] = {"x",       "y",       "z",       "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
                                         "scale_0", "scale_1", "scale_2", "rot_0",  "rot_1",  "rot_2",  "rot_3"};

/// False when a value is not finite.
bool fill_row(const GaussianModel& model, size_t i, float* row) {
  for (size_t k = 0; k < 3; ++k) {
    row[k] = model.positions[3 * i + k];
    row[3 + k] = model.sh[size_t(3) * kShCoefficients * i + k];
    row[7 + k] = model.log_scales[3 * i + k];
  }
  row[6] = model.opacity_logits[i];
  for (size_t k = 0; k < 4; ++k) row[10 + k] = model.rotations[4 * i + k];
  bool finite = true;
  for (size_t k = 0; k < kFloats; ++k) finite &= std::isfinite(row[k]);
  return finite;
}

}  // namespace

void write_live_snapshot(const RunFolder& folder, const GaussianModel& model, const LabelSet& labels,
                         ThreadPool& pool) {
  const bool labelled = model.semantic_channels > 0;
  GaussianLabels assigned;
  if (labelled) assigned = best_labels(soft_labels(model, pool), labels);
  std::string body;
  body.reserve(model.size() * 61);
  size_t count = 0;
  float row[kFloats];
  for (size_t i = 0; i < model.size(); ++i) {
    if (!fill_row(model, i, row)) continue;
    ++count;
    body.append(reinterpret_cast<const char*>(row), sizeof(row));
    if (!labelled) continue;
    const uint16_t numbers[2] = {assigned.label[i], 0};
    body.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
    body += static_cast<char>(assigned.confidence[i]);
  }
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment SplatRenderMode: default\nelement vertex " +
                       std::to_string(count) + "\n";
  for (const char* name : kNames) header += std::string("property float ") + name + "\n";
  if (labelled) header += "property ushort label\nproperty ushort instance\nproperty uchar confidence\n";
  write_file_atomically(folder.path() / "live" / "scene.ply", header + "end_header\n" + body);
}

void remove_live_snapshot(const RunFolder& folder) {
  std::error_code error;
  std::filesystem::remove_all(folder.path() / "live", error);
}

}  // namespace aligngs
