#include "serve/splat_table.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/ply.h"

namespace aligngs {
namespace {

constexpr size_t kRestPerChannel = 15;  // coefficients of degree 1 to 3

std::vector<float> numbers(const std::vector<double>& values) {
  std::vector<float> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(),
                 [](double v) { return std::isfinite(v) ? static_cast<float>(v) : 0.0f; });
  return out;
}

template <class Integer>
std::vector<Integer> integers(const PlyProperty* property) {
  if (property == nullptr) return {};
  std::vector<Integer> out(property->values.size());
  std::transform(property->values.begin(), property->values.end(), out.begin(),
                 [](double v) { return static_cast<Integer>(v); });
  return out;
}

/// Columns of f_rest_0..44, or of a file with fewer degrees; the degree is that of the last column that is not 0.
void add_harmonics(const PlyElement& vertices, SplatTable& table) {
  std::vector<const PlyProperty*> rest;
  for (size_t k = 0; k < 3 * kRestPerChannel; ++k) {
    const PlyProperty* column = vertices.find("f_rest_" + std::to_string(k));
    if (column == nullptr) break;
    rest.push_back(column);
  }
  const size_t per_channel = rest.size() / 3;
  const auto empty = [](const PlyProperty* column) {
    return std::all_of(column->values.begin(), column->values.end(), [](double v) { return v == 0; });
  };
  for (int degree = 3; degree >= 1; --degree) {
    const size_t last = static_cast<size_t>((degree + 1) * (degree + 1)) - 1,
                 first = static_cast<size_t>(degree * degree) - 1;
    if (last > per_channel) continue;
    bool used = false;
    for (size_t k = 0; k < 3 && !used; ++k) {
      for (size_t j = first; j < last && !used; ++j) used = !empty(rest[k * per_channel + j]);
    }
    if (!used) continue;
    table.sh_degree = degree;
    for (size_t k = 0; k < 3; ++k) {
      for (size_t j = 0; j < last; ++j) table.harmonics.push_back(numbers(rest[k * per_channel + j]->values));
    }
    return;
  }
}

}  // namespace

SplatTable read_splat_table(const std::string& ply, const std::filesystem::path& name_for_errors) {
  const PlyFile file = decode_ply(ply, name_for_errors);
  const PlyElement* vertices = file.find("vertex");
  const auto column = [&](const std::string& name) {
    const PlyProperty* property = vertices != nullptr ? vertices->find(name) : nullptr;
    if (property == nullptr || property->is_list)
      throw_bad_input(name_for_errors, name, "the PLY file has no splats", "give the scene.ply of a run");
    return numbers(property->values);
  };
  SplatTable table;
  const char* axes[3] = {"x", "y", "z"};
  for (size_t k = 0; k < 3; ++k) {
    table.position[k] = column(axes[k]);
    table.color[k] = column("f_dc_" + std::to_string(k));
    table.log_scale[k] = column("scale_" + std::to_string(k));
  }
  for (size_t k = 0; k < 4; ++k) table.rotation[k] = column("rot_" + std::to_string(k));
  table.opacity = column("opacity");
  add_harmonics(*vertices, table);
  table.label = integers<uint16_t>(vertices->find("label"));
  table.instance = integers<uint16_t>(vertices->find("instance"));
  table.confidence = integers<uint8_t>(vertices->find("confidence"));
  return table;
}

}  // namespace aligngs
