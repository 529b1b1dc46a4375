#include "gaussians/gaussian_ply.h"

#include <cmath>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/ply.h"

namespace aligngs {
namespace {

constexpr int kRest = kShCoefficients - 1;  ///< coefficients per colour channel beyond the constant one
constexpr int kFloats = 62;                 ///< x y z, n x y z, f_dc 3, f_rest 45, opacity, scale 3, rot 4

std::vector<std::string> standard_properties() {
  std::vector<std::string> names = {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"};
  for (int i = 0; i < 3 * kRest; ++i) names.push_back("f_rest_" + std::to_string(i));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    names.emplace_back(name);
  }
  return names;
}

std::string header_of(size_t count, const GaussianLabels* labels) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment SplatRenderMode: default\n";
  if (labels) out += "comment aligngs label_set " + labels->label_set + "\n";
  out += "element vertex " + std::to_string(count) + "\n";
  for (const std::string& name : standard_properties()) out += "property float " + name + "\n";
  if (labels) out += "property ushort label\nproperty ushort instance\nproperty uchar confidence\n";
  return out + "end_header\n";
}

/// The 62 numbers of one Gaussian in file order; normals are zero, as the format's other writers leave them.
void fill_row(const GaussianModel& model, size_t i, float* row) {
  const float* position = &model.positions[3 * i];
  const float* sh = &model.sh[size_t(3) * kShCoefficients * i];
  for (int k = 0; k < 3; ++k) {
    row[k] = position[k];
    row[3 + k] = 0;
    row[6 + k] = sh[k];
    for (int j = 0; j < kRest; ++j) row[9 + kRest * k + j] = sh[3 * (1 + j) + k];  // channel-major in the file
    row[55 + k] = model.log_scales[3 * i + k];
  }
  row[54] = model.opacity_logits[i];
  const float* r = &model.rotations[4 * i];
  const Quaternionf q = normalized(Quaternionf{r[0], r[1], r[2], r[3]});
  row[58] = q.w;
  row[59] = q.x;
  row[60] = q.y;
  row[61] = q.z;
}

void write_rows(const std::filesystem::path& path, const GaussianModel& model, const GaussianLabels* labels) {
  const size_t count = model.size();
  if (labels &&
      (labels->label.size() != count || labels->instance.size() != count || labels->confidence.size() != count)) {
    throw Error({ErrorKind::kFailed, "one label, instance and confidence per Gaussian expected", path, "labels", {}});
  }
  if (labels && labels->label_set.find_first_of("\r\n") != std::string::npos) {
    throw Error({ErrorKind::kFailed, "the name of the label set must be one line", path, "label_set", {}});
  }
  AtomicFile file(path);
  std::string buffer = header_of(count, labels);
  constexpr size_t kFlush = size_t(1) << 20;  // bytes handed over at a time
  float row[kFloats];
  for (size_t i = 0; i < count; ++i) {
    fill_row(model, i, row);
    for (float value : row) {
      if (std::isfinite(value)) continue;
      throw Error(
          {ErrorKind::kFailed, "Gaussian " + std::to_string(i) + " has a value that is not finite", path, {}, {}});
    }
    buffer.append(reinterpret_cast<const char*>(row), sizeof(row));
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

/// The vertex element of a file of Gaussians, with errors that name property and Gaussian.
class GaussianColumns {
 public:
  GaussianColumns(const PlyFile& file, const std::filesystem::path& path) : path_(path) {
    vertices_ = file.find("vertex");
    if (!vertices_) throw_bad_input(path, "header", "no element 'vertex'", "this is no file of Gaussians");
  }

  size_t count() const { return vertices_->count; }
  bool has(const std::string& name) const { return vertices_->find(name) != nullptr; }
  /// Number of consecutive properties prefix0, prefix1, ...
  int run_length(const std::string& prefix) const {
    int n = 0;
    while (has(prefix + std::to_string(n))) ++n;
    return n;
  }

  /// Copies a property to out[stride * i + offset].
  void copy(const std::string& name, std::vector<float>& out, size_t stride, size_t offset) const {
    const PlyProperty* property = vertices_->find(name);
    if (!property || property->is_list) {
      throw_bad_input(path_, "vertex", "no property '" + name + "'",
                      name == "scale_2" ? "a file of 2-D Gaussians cannot be used here"
                                        : "this is no file of Gaussians, or one of another layout");
    }
    for (size_t i = 0; i < count(); ++i) {
      const float value = static_cast<float>(property->values[i]);
      if (!std::isfinite(value)) {
        throw_bad_input(path_, name, "Gaussian " + std::to_string(i) + " has a value that is not finite",
                        "remove this Gaussian or write the file again");
      }
      out[stride * i + offset] = value;
    }
  }

 private:
  const std::filesystem::path& path_;
  const PlyElement* vertices_ = nullptr;
};

/// f_rest_0.. of degree 0 to 3 (0, 9, 24 or 45 values), channel-major.
int read_rest(const GaussianColumns& columns, const std::filesystem::path& path, std::vector<float>& sh) {
  const int values = columns.run_length("f_rest_");
  int degree = 0;
  while (degree <= kMaxShDegree && 3 * (sh_coefficient_count(degree) - 1) != values) ++degree;
  if (degree > kMaxShDegree) {
    throw_bad_input(path, "f_rest", std::to_string(values) + " properties f_rest_*; 0, 9, 24 or 45 expected",
                    "write the file with spherical harmonics of degree 0 to 3");
  }
  const int per_channel = sh_coefficient_count(degree) - 1;
  for (int k = 0; k < values; ++k) {
    const int channel = k / per_channel, coefficient = 1 + k % per_channel;
    columns.copy("f_rest_" + std::to_string(k), sh, size_t(3) * kShCoefficients, 3 * coefficient + channel);
  }
  return degree;
}

}  // namespace

void write_gaussian_ply(const std::filesystem::path& path, const GaussianModel& model) {
  write_rows(path, model, nullptr);
}

void write_labelled_gaussian_ply(const std::filesystem::path& path, const GaussianModel& model,
                                 const GaussianLabels& labels) {
  write_rows(path, model, &labels);
}

GaussianModel read_gaussian_ply(const std::filesystem::path& path) {
  const PlyFile file = read_ply(path);
  const GaussianColumns columns(file, path);
  GaussianModel model;
  model.semantic_channels = columns.run_length("semantic_");
  model.resize(columns.count());

  const char* axes[3] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    columns.copy(axes[k], model.positions, 3, k);
    columns.copy("scale_" + std::to_string(k), model.log_scales, 3, k);
    columns.copy("f_dc_" + std::to_string(k), model.sh, size_t(3) * kShCoefficients, k);
  }
  for (int k = 0; k < 4; ++k) columns.copy("rot_" + std::to_string(k), model.rotations, 4, k);
  columns.copy("opacity", model.opacity_logits, 1, 0);
  for (int k = 0; k < model.semantic_channels; ++k) {
    columns.copy("semantic_" + std::to_string(k), model.semantics, model.semantic_channels, k);
  }
  model.sh_degree = read_rest(columns, path, model.sh);
  return model;
}

}  // namespace aligngs
