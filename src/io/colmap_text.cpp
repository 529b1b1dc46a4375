// Format: https://colmap.github.io/format.html (cameras.txt, images.txt, points3D.txt)
#include "io/colmap_text.h"

#include <string>

#include "core/error.h"
#include "io/colmap_camera_models.h"
#include "io/text_encoding.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

/// The lines of a file with their numbers; a line is read word by word.
class LineReader {
 public:
  LineReader(std::string_view text, const std::filesystem::path& name) : rest_(text_of_file(text, name)), name_(name) {}

  /// The next line, whatever it holds; false at the end of the file.
  bool next() {
    if (rest_.empty()) return false;
    line_ = take_line(rest_);
    ++number_;
    return true;
  }
  /// The next line that is neither blank nor a comment.
  bool next_record() {
    while (next()) {
      const std::string_view text = trimmed(line_);
      if (!text.empty() && text[0] != '#') return true;
    }
    return false;
  }
  /// The line that next() would give.
  std::string_view peek() const {
    std::string_view rest = rest_;
    return take_line(rest);
  }
  bool at_end_of_line() const { return trimmed(line_).empty(); }
  std::string_view word(const char* field) {
    const std::string_view word = take_word(line_);
    if (word.empty()) fail(field, "missing");
    return word;
  }
  std::string_view rest_of_line() { return trimmed(line_); }
  template <class T>
  T number(const char* field) {
    const std::string_view text = word(field);
    T value{};
    if (!parse_number(text, value)) fail(field, "'" + std::string(text.substr(0, 40)) + "' is not such a number");
    return value;
  }
  std::string place(const char* field) const { return "line " + std::to_string(number_) + ", " + field; }
  [[noreturn]] void fail(const char* field, const std::string& message) const {
    throw_bad_input(name_, place(field), message,
                    "export the model again with colmap model_converter --output_type TXT");
  }

 private:
  std::string_view rest_, line_;
  const std::filesystem::path& name_;
  size_t number_ = 0;
};

/// Whether a line is the first one of an image: an id, seven numbers, a camera id and a name. Keypoints come in threes,
/// all of them numbers. The two kinds of lines hence differ as long as names are no numbers.
bool is_image_record(std::string_view line) {
  constexpr size_t kNumbers = 9;
  size_t words = 0;
  bool all_numbers = true;
  while (!trimmed(line).empty()) {
    double number = 0;
    const bool is_number = parse_number(take_word(line), number);
    if (words < kNumbers && !is_number) return false;
    all_numbers = all_numbers && is_number;
    ++words;
  }
  return words > kNumbers && (!all_numbers || words % 3 != 0);
}

/// -1 and 2^64 - 1 both mean that a keypoint has no point.
int64_t point_id_of(LineReader& line) {
  const std::string_view text = line.word("POINT3D_ID");
  int64_t id = 0;
  uint64_t large = 0;
  if (parse_number(text, id)) return id;
  if (!parse_number(text, large))
    line.fail("POINT3D_ID", "'" + std::string(text.substr(0, 40)) + "' is not such a number");
  return static_cast<int64_t>(large);
}

}  // namespace

std::vector<ColmapCamera> parse_colmap_cameras_text(std::string_view text, const std::filesystem::path& name) {
  LineReader line(text, name);
  std::vector<ColmapCamera> cameras;
  while (line.next_record()) {
    ColmapCamera camera;
    camera.id = line.number<uint32_t>("CAMERA_ID");
    camera.model = line.word("MODEL");
    const ColmapCameraModel* model = find_colmap_camera_model(camera.model);
    if (!model) {
      throw_bad_input(name, line.place("MODEL"), "unknown camera model '" + camera.model.substr(0, 40) + "'",
                      kUnknownCameraModelRemedy);
    }
    camera.width = line.number<uint64_t>("WIDTH");
    camera.height = line.number<uint64_t>("HEIGHT");
    for (size_t i = 0; i < model->parameters; ++i) camera.params.push_back(line.number<double>("PARAMS"));
    if (!line.at_end_of_line()) line.fail("PARAMS", "too many parameters for " + camera.model);
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

std::vector<ColmapImage> parse_colmap_images_text(std::string_view text, const std::filesystem::path& name) {
  LineReader line(text, name);
  std::vector<ColmapImage> images;
  while (line.next_record()) {
    ColmapImage image;
    image.id = line.number<uint32_t>("IMAGE_ID");
    image.rotation.w = line.number<double>("QW");
    image.rotation.x = line.number<double>("QX");
    image.rotation.y = line.number<double>("QY");
    image.rotation.z = line.number<double>("QZ");
    image.translation.x = line.number<double>("TX");
    image.translation.y = line.number<double>("TY");
    image.translation.z = line.number<double>("TZ");
    image.camera_id = line.number<uint32_t>("CAMERA_ID");
    image.name = line.rest_of_line();  // may hold spaces
    // The second line lists the keypoints; it is empty for an image without any. Some programs leave it out.
    // Some programs write comments between the two.
    while (trimmed(line.peek()).starts_with('#') && line.next()) {
    }
    if (!is_image_record(trimmed(line.peek())) && line.next()) {
      while (!line.at_end_of_line()) {
        const double x = line.number<double>("X"), y = line.number<double>("Y");
        image.points.push_back({x, y});
        image.point_ids.push_back(point_id_of(line));
      }
    }
    images.push_back(std::move(image));
  }
  return images;
}

std::vector<ColmapPoint> parse_colmap_points_text(std::string_view text, const std::filesystem::path& name) {
  LineReader line(text, name);
  std::vector<ColmapPoint> points;
  while (line.next_record()) {
    ColmapPoint point;
    point.id = line.number<uint64_t>("POINT3D_ID");
    point.position.x = line.number<double>("X");
    point.position.y = line.number<double>("Y");
    point.position.z = line.number<double>("Z");
    for (uint8_t& channel : point.color) channel = line.number<uint8_t>("RGB");
    point.error = line.number<double>("ERROR");
    while (!line.at_end_of_line()) {
      const uint32_t image = line.number<uint32_t>("IMAGE_ID");
      point.track.emplace_back(image, line.number<uint32_t>("POINT2D_IDX"));
    }
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace aligngs
