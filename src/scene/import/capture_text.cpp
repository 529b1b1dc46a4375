#include "scene/import/capture_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/npy.h"
#include "io/picture_format.h"
#include "io/text_encoding.h"
#include "io/text_tokens.h"
#include "scene/photo_lookup.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Exponents as Fortran writes them: 1.5D-03 is 1.5e-03.
std::string with_plain_exponents(std::string text) {
  const auto is_digit = [&](size_t i) { return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])); };
  for (size_t i = 1; i + 1 < text.size(); ++i) {
    const bool sign = text[i + 1] == '+' || text[i + 1] == '-';
    if ((text[i] == 'D' || text[i] == 'd') && (is_digit(i - 1) || text[i - 1] == '.') && is_digit(i + 1 + sign))
      text[i] = 'e';
  }
  return text;
}

}  // namespace

std::vector<double> read_numbers(const fs::path& file) {
  constexpr uint64_t kLimit = uint64_t(1) << 28;  // bytes; a trajectory of a million poses is smaller
  if (has_extension(file, {".npy"})) {
    const FloatArray array = read_npy(file);
    constexpr float kLargestOfArray = 1e4f;  // above, 32 bits keep less than a millimetre of metres
    for (const float value : array.data) {
      if (std::fabs(value) > kLargestOfArray && std::isfinite(value))
        throw_bad_input(file, "values", "numbers of an array keep seven digits here, too few for such coordinates",
                        "write the matrix as text");
    }
    return {array.data.begin(), array.data.end()};
  }
  const std::string text = with_plain_exponents(std::string(text_of_file(read_file(file, kLimit), file)));
  std::vector<double> numbers;
  size_t line = 1;
  for (const char* p = text.c_str(); *p;) {
    if (*p == '\n') ++line;
    if (std::isspace(static_cast<unsigned char>(*p)) || std::strchr(",;[]()", *p)) {  // numpy writes brackets
      ++p;
      continue;
    }
    if (*p == '#') {
      while (*p && *p != '\n') ++p;
      continue;
    }
    char* end = nullptr;
    const double value = std::strtod(p, &end);
    if (end == p)
      throw_bad_input(file, "line " + std::to_string(line), "expected a number",
                      "check that this is the right kind of file");
    numbers.push_back(value);
    p = end;
  }
  return numbers;
}

bool all_finite(const double* values, size_t count) {
  return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
}

std::vector<std::string> read_name_list(const fs::path& file) {
  const std::string text = read_file(file);
  std::vector<std::string> names;
  std::string_view rest = text_of_file(text, file);
  while (!rest.empty()) {
    std::string_view line = trimmed(take_line(rest));
    if (line.empty() || line[0] == '#') continue;
    while (!line.empty()) {
      const size_t comma = line.find(',');
      std::string_view name = trimmed(line.substr(0, comma));
      const bool quoted = name.size() >= 2 && name.front() == name.back() && (name[0] == '"' || name[0] == '\'');
      if (quoted) name = name.substr(1, name.size() - 2);
      if (!name.empty()) names.emplace_back(name);
      line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
    }
  }
  if (names.empty())
    throw_bad_input(file, "names", "this list names no frame", "write one name a line, or leave the list out");
  return names;
}

Rigidd rigid_from_matrix(std::span<const double> m, const fs::path& file, const std::string& field) {
  constexpr double kTolerance = 1e-2;  // six printed digits and accumulated tracking leave less than this
  double scale = 1;
  const Rigidd pose = rigid_from_scaled_matrix(m, file, field, scale);
  if (!(std::fabs(scale - 1) < kTolerance)) {
    throw_bad_input(file, field, "the upper left 3x3 block is no rotation: it scales by " + std::to_string(scale),
                    "poses must be rigid 4x4 matrices in row-major order");
  }
  return pose;
}

namespace {

/// A matrix that was written column by column has a rotation as well: only its last row shows it.
void require_last_row(std::span<const double> m, const fs::path& file, const std::string& field) {
  constexpr double kTolerance = 1e-4;  // of numbers that are exact but for their printing
  if (m.size() != 16) return;
  const auto far = [&](size_t i, double value) { return std::fabs(m[i] - value) > kTolerance; };
  if (!far(12, 0) && !far(13, 0) && !far(14, 0) && !far(15, 1)) return;
  const bool transposed = !far(3, 0) && !far(7, 0) && !far(11, 0) && !far(15, 1);
  throw_bad_input(file, field,
                  transposed ? "the matrix is column-major: its last row has the translation"
                             : "the last row of the matrix is not 0 0 0 1",
                  "poses must be rigid 4x4 matrices in row-major order");
}

}  // namespace

Rigidd rigid_from_scaled_matrix(std::span<const double> m, const fs::path& file, const std::string& field,
                                double& scale) {
  constexpr double kTolerance = 1e-2;  // as above, of a rotation's entries
  if (!all_finite(m.data(), m.size())) throw_bad_input(file, field, "the pose is not finite", "leave this frame out");
  require_last_row(m, file, field);
  Rigidd pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.rotation(r, c) = m[4 * r + c];
    pose.translation[r] = m[4 * r + 3];
  }
  const double volume = determinant(pose.rotation);
  scale = std::cbrt(volume);
  const char* const remedy = "poses must be rigid 4x4 matrices in row-major order";
  if (volume < 0) throw_bad_input(file, field, "the upper left 3x3 block mirrors the world", remedy);
  if (!(scale > 0)) throw_bad_input(file, field, "the upper left 3x3 block is no rotation", remedy);
  for (double& entry : pose.rotation.m) entry /= scale;
  const Mat3d product = pose.rotation * transpose(pose.rotation);
  double deviation = 0;
  for (int i = 0; i < 9; ++i) deviation = std::max(deviation, std::fabs(product.m[i] - (i % 4 == 0 ? 1 : 0)));
  if (!(deviation < kTolerance)) throw_bad_input(file, field, "the upper left 3x3 block is no rotation", remedy);
  pose.rotation = rotation_matrix(quaternion_of(pose.rotation));
  return pose;
}

Rigidd opencv_world_to_camera_from_opengl(const Rigidd& camera_to_world) {
  Rigidd flipped = camera_to_world;
  for (int r = 0; r < 3; ++r) {
    flipped.rotation(r, 1) = -flipped.rotation(r, 1);
    flipped.rotation(r, 2) = -flipped.rotation(r, 2);
  }
  return flipped.inverse();
}

bool natural_less(const std::string& a, const std::string& b) {
  size_t i = 0, j = 0;
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      size_t a_end = i, b_end = j;
      while (a_end < a.size() && digit(a[a_end])) ++a_end;
      while (b_end < b.size() && digit(b[b_end])) ++b_end;
      std::string x = a.substr(i, a_end - i), y = b.substr(j, b_end - j);
      x.erase(0, std::min(x.find_first_not_of('0'), x.size() - 1));
      y.erase(0, std::min(y.find_first_not_of('0'), y.size() - 1));
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
      i = a_end;
      j = b_end;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;  // "01" and "1": any fixed order
}

std::vector<fs::path> list_files(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (!is_hidden(entry.path()) && has_extension(entry.path(), extensions)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

fs::path numbers_file(const fs::path& stem) {
  const fs::path text = stem.string() + ".txt", array = stem.string() + ".npy";
  return !fs::exists(text) && fs::exists(array) ? array : text;
}

fs::path first_existing(const std::vector<fs::path>& candidates) {
  for (const fs::path& path : candidates) {
    if (fs::exists(path)) return path;
  }
  return {};
}

}  // namespace aligngs
