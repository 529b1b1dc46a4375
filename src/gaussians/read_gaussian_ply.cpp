#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/ply.h"
#include "io/ply_header.h"

namespace aligngs {
namespace {

/// A property of the file and its place: out[stride * i + offset].
struct WantedColumn {
  const PlyProperty* property = nullptr;
  std::vector<float>* out = nullptr;
  size_t stride = 1, offset = 0;
};

/// The vertex element of a file of Gaussians, with errors that name property and Gaussian.
class GaussianColumns {
 public:
  GaussianColumns(const PlyFile& file, const std::filesystem::path& path) : path_(path) {
    vertices_ = file.find("vertex");
    if (!vertices_) throw_bad_input(path, "header", "no element 'vertex'", "this is no file of Gaussians");
  }

  size_t count() const { return vertices_->count; }
  const PlyProperty* find(const std::string& name) const { return vertices_->find(name); }
  /// Number of consecutive properties prefix0, prefix1, ...
  int run_length(const std::string& prefix) const {
    int n = 0;
    while (find(prefix + std::to_string(n))) ++n;
    return n;
  }
  /// The property is to be copied.
  void want(const std::string& name, std::vector<float>& out, size_t stride, size_t offset) {
    const PlyProperty* property = find(name);
    if (!property || property->is_list) {
      throw_bad_input(path_, "vertex", "no property '" + name + "'",
                      name == "scale_2" ? "a file of 2-D Gaussians cannot be used here"
                                        : "this is no file of Gaussians, or one of another layout");
    }
    wanted_.push_back({property, &out, stride, offset});
  }
  /// Copies what is wanted from the values of a file that was decoded.
  void copy() const {
    for (const WantedColumn& w : wanted_) {
      for (size_t i = 0; i < count(); ++i) put(w, i, static_cast<float>(w.property->values[i]));
    }
  }
  /// Copies what is wanted from rows of scalar numbers, little-endian. A block of rows stays in the cache while its
  /// columns are taken out.
  void copy_rows(std::string_view rows) const {
    constexpr size_t kBlock = 256;  // rows
    size_t row_bytes = 0;
    std::vector<size_t> at(vertices_->properties.size());
    for (size_t p = 0; p < at.size(); ++p) {
      at[p] = row_bytes;
      row_bytes += ply_type_bytes(vertices_->properties[p].type);
    }
    for (size_t first = 0; first < count(); first += kBlock) {
      const size_t last = std::min(count(), first + kBlock);
      for (const WantedColumn& w : wanted_) {
        const char* column = rows.data() + at[static_cast<size_t>(w.property - vertices_->properties.data())];
        for (size_t i = first; i < last; ++i) put(w, i, number_at(column + i * row_bytes, w.property->type));
      }
    }
  }

 private:
  static float number_at(const char* bytes, PlyType type) {
    switch (type) {
      case PlyType::kFloat32:
        return load_number<float>(bytes, false);
      case PlyType::kFloat64:
        return static_cast<float>(load_number<double>(bytes, false));
      case PlyType::kInt8:
        return load_number<int8_t>(bytes, false);
      case PlyType::kUint8:
        return load_number<uint8_t>(bytes, false);
      case PlyType::kInt16:
        return load_number<int16_t>(bytes, false);
      case PlyType::kUint16:
        return load_number<uint16_t>(bytes, false);
      case PlyType::kInt32:
        return static_cast<float>(load_number<int32_t>(bytes, false));
      case PlyType::kUint32:
        return static_cast<float>(load_number<uint32_t>(bytes, false));
    }
    return 0;
  }
  void put(const WantedColumn& w, size_t i, float value) const {
    if (!std::isfinite(value)) {
      throw_bad_input(path_, w.property->name, "Gaussian " + std::to_string(i) + " has a value that is not finite",
                      "remove this Gaussian or write the file again");
    }
    (*w.out)[w.stride * i + w.offset] = value;
  }

  const std::filesystem::path& path_;
  const PlyElement* vertices_ = nullptr;
  std::vector<WantedColumn> wanted_;
};

/// f_rest_0.. of degree 0 to 3 (0, 9, 24 or 45 values), channel-major.
int want_rest(GaussianColumns& columns, const std::filesystem::path& path, std::vector<float>& sh) {
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
    columns.want("f_rest_" + std::to_string(k), sh, size_t(3) * kShCoefficients,
                 static_cast<size_t>(3 * coefficient + channel));
  }
  return degree;
}

void want_model(GaussianColumns& columns, const std::filesystem::path& path, GaussianModel& model) {
  model.semantic_channels = columns.run_length("semantic_");
  model.resize(columns.count());
  const char* axes[3] = {"x", "y", "z"};
  for (size_t k = 0; k < 3; ++k) {
    columns.want(axes[k], model.positions, 3, k);
    columns.want("scale_" + std::to_string(k), model.log_scales, 3, k);
    columns.want("f_dc_" + std::to_string(k), model.sh, size_t(3) * kShCoefficients, k);
  }
  for (size_t k = 0; k < 4; ++k) columns.want("rot_" + std::to_string(k), model.rotations, 4, k);
  columns.want("opacity", model.opacity_logits, 1, 0);
  for (int k = 0; k < model.semantic_channels; ++k) {
    columns.want("semantic_" + std::to_string(k), model.semantics, static_cast<size_t>(model.semantic_channels),
                 static_cast<size_t>(k));
  }
  model.sh_degree = want_rest(columns, path, model.sh);
}

/// Whether a file is rows of scalar numbers, little-endian, and nothing before them: what this program writes.
bool is_plain(const PlyHeader& header) {
  if (header.format != PlyFormat::kLittleEndian || header.file.elements.empty()) return false;
  const PlyElement& first = header.file.elements.front();
  if (first.name != "vertex" || first.properties.empty()) return false;
  return std::none_of(first.properties.begin(), first.properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

template <class Integer>
std::vector<Integer> integers(const std::vector<float>& values, const std::filesystem::path& path, const char* name) {
  std::vector<Integer> out(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0 && values[i] <= static_cast<float>(std::numeric_limits<Integer>::max()))) {
      throw_bad_input(path, name, "Gaussian " + std::to_string(i) + " has a value out of range",
                      "write the file again");
    }
    out[i] = static_cast<Integer>(values[i]);
  }
  return out;
}

struct LabelColumns {
  std::vector<float> label, instance, confidence;
};

/// Reads the model, and with `labels` these three columns.
GaussianModel read_columns(const std::string& bytes, const std::filesystem::path& path, LabelColumns* labels) {
  PlyHeader header = parse_ply_header(bytes, path);
  const bool plain = is_plain(header);
  const PlyFile file = plain ? std::move(header.file) : decode_ply(bytes, path);
  GaussianColumns columns(file, path);
  std::string_view rows;
  if (plain) {
    size_t row_bytes = 0;
    for (const PlyProperty& p : file.elements.front().properties) row_bytes += ply_type_bytes(p.type);
    ByteReader reader(std::string_view(bytes).substr(header.body), path);
    reader.count_of(columns.count(), row_bytes, "element vertex");
    rows = reader.take(columns.count() * row_bytes, "element vertex");
  }
  GaussianModel model;
  want_model(columns, path, model);
  if (labels) {
    for (auto [name, column] :
         {std::pair{"label", &labels->label}, {"instance", &labels->instance}, {"confidence", &labels->confidence}}) {
      column->resize(columns.count());
      columns.want(name, *column, 1, 0);
    }
  }
  if (plain)
    columns.copy_rows(rows);
  else
    columns.copy();
  return model;
}

}  // namespace

GaussianModel read_gaussian_ply(const std::filesystem::path& path) {
  return decode_gaussian_ply(read_file(path), path);
}

GaussianModel decode_gaussian_ply(const std::string& bytes, const std::filesystem::path& name) {
  return read_columns(bytes, name, nullptr);
}

GaussianModel gaussians_of_ply(const PlyFile& file, const std::filesystem::path& name) {
  GaussianColumns columns(file, name);
  GaussianModel model;
  want_model(columns, name, model);
  columns.copy();
  return model;
}

LabelledModel read_labelled_gaussian_ply(const std::filesystem::path& path) {
  LabelColumns columns;
  LabelledModel out;
  out.model = read_columns(read_file(path), path, &columns);
  out.labels.label = integers<uint16_t>(columns.label, path, "label");
  out.labels.instance = integers<uint16_t>(columns.instance, path, "instance");
  out.labels.confidence = integers<uint8_t>(columns.confidence, path, "confidence");
  return out;
}

}  // namespace aligngs
