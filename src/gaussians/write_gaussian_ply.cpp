#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

constexpr int kTail = 8;  ///< numbers after the harmonics: opacity, scale 3, rot 4

/// The harmonics of a file, and the labels that follow them. Readers of labels need no normals.
struct RowLayout {
  int rest = 0;  ///< coefficients per colour channel beyond the constant one
  const GaussianLabels* labels = nullptr;

  int normals() const { return labels ? 0 : 3; }
  int head() const { return 3 + normals() + 3; }  ///< numbers before the harmonics: x y z, n x y z, f_dc 3
  size_t floats() const { return static_cast<size_t>(head() + 3 * rest + kTail); }
};

std::vector<std::string> float_properties(const RowLayout& layout) {
  std::vector<std::string> names = {"x", "y", "z"};
  if (layout.normals() > 0) names.insert(names.end(), {"nx", "ny", "nz"});
  names.insert(names.end(), {"f_dc_0", "f_dc_1", "f_dc_2"});
  for (int i = 0; i < 3 * layout.rest; ++i) names.push_back("f_rest_" + std::to_string(i));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    names.emplace_back(name);
  }
  return names;
}

std::string header_of(size_t count, const RowLayout& layout) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment SplatRenderMode: default\n";
  if (layout.labels) out += "comment aligngs label_set " + layout.labels->label_set + "\n";
  out += "element vertex " + std::to_string(count) + "\n";
  for (const std::string& name : float_properties(layout)) out += "property float " + name + "\n";
  if (layout.labels) out += "property ushort label\nproperty ushort instance\nproperty uchar confidence\n";
  return out + "end_header\n";
}

/// The numbers of one Gaussian in file order; normals are zero, as the format's other writers leave them.
void fill_row(const GaussianModel& model, size_t i, const RowLayout& layout, float* row) {
  const int rest = layout.rest, head = layout.head(), normals = layout.normals();
  const float* position = &model.positions[3 * i];
  const float* sh = &model.sh[size_t(3) * kShCoefficients * i];
  float* tail = row + head + 3 * rest;
  for (int k = 0; k < 3; ++k) {
    row[k] = position[k];
    if (normals > 0) row[3 + k] = 0;
    row[3 + normals + k] = sh[k];
    for (int j = 0; j < rest; ++j) row[head + rest * k + j] = sh[3 * (1 + j) + k];  // channel-major in the file
    tail[1 + k] = model.log_scales[3 * i + k];
  }
  tail[0] = model.opacity_logits[i];
  const float* r = &model.rotations[4 * i];
  const Quaternionf q = normalized(Quaternionf{r[0], r[1], r[2], r[3]});
  tail[4] = q.w;
  tail[5] = q.x;
  tail[6] = q.y;
  tail[7] = q.z;
}

/// The degree whose harmonics are not all zero.
int used_degree(const GaussianModel& model) {
  size_t last = 0;  // coefficient
  for (size_t i = 0; i < model.sh.size(); ++i) {
    const size_t coefficient = i % (size_t(3) * kShCoefficients) / 3;
    if (coefficient > last && model.sh[i] != 0) last = coefficient;
  }
  int degree = 0;
  while (static_cast<size_t>(sh_coefficient_count(degree)) <= last) ++degree;
  return degree;
}

void write_rows(const std::filesystem::path& path, const GaussianModel& model, const RowLayout& layout) {
  const size_t count = model.size();
  const GaussianLabels* labels = layout.labels;
  if (labels &&
      (labels->label.size() != count || labels->instance.size() != count || labels->confidence.size() != count)) {
    throw Error({ErrorKind::kFailed, "one label, instance and confidence per Gaussian expected", path, "labels", {}});
  }
  if (labels && labels->label_set.find_first_of("\r\n") != std::string::npos) {
    throw Error({ErrorKind::kFailed, "the name of the label set must be one line", path, "label_set", {}});
  }
  AtomicFile file(path);
  std::string buffer = header_of(count, layout);
  constexpr size_t kFlush = size_t(1) << 20;  // bytes handed over at a time
  std::vector<float> row(layout.floats());
  for (size_t i = 0; i < count; ++i) {
    fill_row(model, i, layout, row.data());
    for (float value : row) {
      if (std::isfinite(value)) continue;
      throw Error(
          {ErrorKind::kFailed, "Gaussian " + std::to_string(i) + " has a value that is not finite", path, {}, {}});
    }
    buffer.append(reinterpret_cast<const char*>(row.data()), row.size() * sizeof(float));
    if (labels) {
      const uint16_t numbers[2] = {labels->label[i], labels->instance[i]};
      buffer.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
      buffer += static_cast<char>(labels->confidence[i]);
    }
    if (buffer.size() < kFlush) continue;
    file.write(buffer);
    buffer.clear();
  }
  file.write(buffer);
  file.commit();
}

}  // namespace

void write_gaussian_ply(const std::filesystem::path& path, const GaussianModel& model) {
  write_rows(path, model, {kShCoefficients - 1, nullptr});
}

void write_labelled_gaussian_ply(const std::filesystem::path& path, const GaussianModel& model,
                                 const GaussianLabels& labels) {
  write_rows(path, model, {sh_coefficient_count(used_degree(model)) - 1, &labels});
}

}  // namespace aligngs
