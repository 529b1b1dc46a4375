// A capture whose every camera, pixel and depth is known, drawn from a seed. Tests write it in a folder layout and
// compare what an importer makes of it with what was meant. The lens formulas are written out here once more, so that a
// wrong one cannot agree with itself.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/random.h"
#include "core/rigid.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/testing/turned_jpeg.h"

namespace aligngs {

/// The fault that makes a frame unusable.
enum class Fault { kNone, kNoPhoto, kEmptyPhoto, kCutPhoto, kNanPose };

struct RandomLens {
  std::string model = "PINHOLE";          ///< or SIMPLE_RADIAL, OPENCV, OPENCV_FISHEYE, as COLMAP names them
  int width = 0, height = 0;              ///< pixels of the stored photo
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels, the first pixel's centre at 0.5
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0;

  /// Intersection of the ray (x, y, 1) with the picture, in units of the focal length.
  Vec2d bent(const Vec2d& p) const {
    const double r2 = p.x * p.x + p.y * p.y;
    if (model == "OPENCV_FISHEYE") {
      const double r = std::sqrt(r2), theta = std::atan(r);
      const double factor = r < 1e-9 ? 1 : theta * (1 + k1 * theta * theta + k2 * std::pow(theta, 4)) / r;
      return {p.x * factor, p.y * factor};
    }
    const double radial = 1 + k1 * r2 + k2 * r2 * r2;
    return {p.x * radial + 2 * p1 * p.x * p.y + p2 * (r2 + 2 * p.x * p.x),
            p.y * radial + p1 * (r2 + 2 * p.y * p.y) + 2 * p2 * p.x * p.y};
  }
  /// The ray of pixel position (u, v), by Newton's method.
  Vec2d ray(double u, double v) const {
    const Vec2d wanted{(u - cx) / fx, (v - cy) / fy};
    Vec2d p = wanted;
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 20; ++i) {
      const Vec2d f = bent(p), fx1 = bent({p.x + kStep, p.y}), fy1 = bent({p.x, p.y + kStep});
      const double a = (fx1.x - f.x) / kStep, b = (fy1.x - f.x) / kStep, c = (fx1.y - f.y) / kStep,
                   d = (fy1.y - f.y) / kStep;
      const double ex = wanted.x - f.x, ey = wanted.y - f.y, determinant = a * d - b * c;
      p = {p.x + (d * ex - b * ey) / determinant, p.y + (a * ey - c * ex) / determinant};
    }
    return p;
  }
  std::vector<double> parameters(double scale = 1) const {
    if (model == "SIMPLE_RADIAL") return {fx * scale, cx * scale, cy * scale, k1};
    std::vector<double> all = {fx * scale, fy * scale, cx * scale, cy * scale};
    if (model == "OPENCV") all.insert(all.end(), {k1, k2, p1, p2});
    if (model == "OPENCV_FISHEYE") all.insert(all.end(), {k1, k2, 0, 0});
    return all;
  }
};

struct RandomFrame {
  std::string name;  ///< of the photo, without folder and extension
  double code = 0;   ///< in [0, 1]: the blue of its photo and a part of its depth, so that frames cannot be exchanged
  Rigidd world_to_camera;
  Quaterniond turn;  ///< its rotation
  Fault fault = Fault::kNone;
  int orientation = 1;  ///< EXIF; the stored pixels stay the camera's
};

/// The colour that a frame sees along the ray (x, y, 1), sRGB in [0, 1].
inline Vec3d colour_along(const RandomFrame& frame, const Vec2d& p) {
  return {0.5 + 0.3 * std::sin(2.5 * p.x + 6 * frame.code), 0.5 + 0.3 * std::sin(2.5 * p.y), frame.code};
}
/// And its depth, world units.
inline double depth_along(const RandomFrame& frame, const Vec2d& p) { return 2 + 0.4 * p.x - 0.3 * p.y + frame.code; }

struct RandomCapture {
  Random random;
  RandomLens lens;
  std::vector<RandomFrame> frames;
  std::string extension;  ///< of the photos: ".jpg" or ".png"

  /// A pinhole; `with_distortion` draws one of the four models.
  RandomCapture(uint64_t seed, bool with_distortion) : random(seed) {
    lens.width = 40 + 4 * random.below(8);
    lens.height = 24 + 2 * random.below(7);  // less than the width: an upright photo has another shape
    lens.fx = lens.width * random.uniform(0.8, 1.2);
    lens.fy = lens.fx * random.uniform(0.97, 1.03);
    lens.cx = lens.width * random.uniform(0.45, 0.55);
    lens.cy = lens.height * random.uniform(0.45, 0.55);
    if (with_distortion) draw_distortion();
    extension = random.chance(0.5) ? ".jpg" : ".png";
    const Vec3d far = random.chance(0.2) ? Vec3d{4e5, 5.6e6, 120} : Vec3d{};  // map coordinates
    const int count = 5 + random.below(4);
    for (int i = 0; i < count; ++i) frames.push_back(draw_frame(i, far));
    for (int i = 4; i < count; ++i) {
      if (random.chance(0.5)) frames[size_t(i)].fault = static_cast<Fault>(1 + random.below(4));
    }
  }

  /// A principal point in the middle and one focal length, for layouts that store no more.
  void centre() {
    lens.fy = lens.fx;
    lens.cx = 0.5 * lens.width;
    lens.cy = 0.5 * lens.height;
  }

  ImageF picture(const RandomFrame& frame) const {
    ImageF out(lens.width, lens.height, 3);
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        const Vec3d colour = colour_along(frame, lens.ray(x + 0.5, y + 0.5));
        out.at(x, y, 0) = float(colour.x), out.at(x, y, 1) = float(colour.y), out.at(x, y, 2) = float(colour.z);
      }
    }
    return out;
  }
  /// The photo as its fault leaves it.
  void write_photo(const RandomFrame& frame, const std::filesystem::path& file) const {
    if (frame.fault == Fault::kNoPhoto) return;
    std::filesystem::create_directories(file.parent_path());
    const Image<uint8_t> pixels = to_bytes(picture(frame));
    const std::vector<uint8_t> encoded = file.extension() == ".png" ? encode_png(pixels) : encode_jpeg(pixels, 97);
    std::string bytes(encoded.begin(), encoded.end());
    if (file.extension() == ".jpg" && frame.orientation != 1) bytes = turned_jpeg(encoded, frame.orientation);
    if (frame.fault == Fault::kEmptyPhoto) bytes.clear();
    if (frame.fault == Fault::kCutPhoto) bytes.resize(bytes.size() / 2);
    write_file_atomically(file, bytes);
  }
  /// 16-bit depth with `unit` world units per stored value, of a camera like the photo's, `times` as large.
  void write_depth(const RandomFrame& frame, const std::filesystem::path& file, double unit, int times = 1) const {
    std::filesystem::create_directories(file.parent_path());
    Image<uint16_t> map(lens.width * times, lens.height * times, 1);
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        const double z = depth_along(frame, lens.ray((x + 0.5) / times, (y + 0.5) / times));
        map.at(x, y) = static_cast<uint16_t>(std::lround(z / unit));
      }
    }
    write_png16(file, map);
  }
  /// Sixteen numbers of camera-to-world, a row a line; `opengl` has y up and z backwards; linear part times `scale`.
  std::string matrix(const RandomFrame& frame, bool opengl, const char* between = " ", const char* lines = "\n",
                     double scale = 1) const {
    const Rigidd pose = frame.world_to_camera.inverse();
    std::string text;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        const double value = pose.rotation(r, c) * scale * (opengl && c > 0 ? -1 : 1);
        text += frame.fault == Fault::kNanPose ? std::string(opengl ? "NaN" : "nan") + between
                                               : fmt::format("{:.17g}{}", value, between);
      }
      const double t = r == 0 ? pose.translation.x : r == 1 ? pose.translation.y : pose.translation.z;
      text += frame.fault == Fault::kNanPose ? std::string(opengl ? "NaN" : "nan") + lines
                                             : fmt::format("{:.17g}{}", t, lines);
    }
    return text + fmt::format("0{0}0{0}0{0}1", between);
  }

 private:
  void draw_distortion() {
    switch (random.below(4)) {
      case 0:
        break;
      case 1:
        lens.model = "SIMPLE_RADIAL";
        lens.fy = lens.fx;
        lens.k1 = random.uniform(-0.15, 0.1);
        break;
      case 2:
        lens.model = "OPENCV";
        lens.k1 = random.uniform(-0.2, 0.1), lens.k2 = random.uniform(-0.05, 0.05);
        lens.p1 = random.uniform(-0.01, 0.01), lens.p2 = random.uniform(-0.01, 0.01);
        break;
      default:
        lens.model = "OPENCV_FISHEYE";
        lens.k1 = random.uniform(-0.1, 0.1), lens.k2 = random.uniform(-0.05, 0.05);
    }
  }
  RandomFrame draw_frame(int index, const Vec3d& far) {
    const char* kinds[] = {"a{}", "IMG_00{}", "photo {}", "x.y{}", "B\xc3\xa4r{}"};
    RandomFrame frame;
    frame.name = fmt::format(fmt::runtime(kinds[random.below(5)]), index);
    frame.code = (index + 1) / 12.0;
    const Quaterniond turn =
        normalized(Quaterniond{1, random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)});
    const Vec3d centre = far + Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    frame.world_to_camera = Rigidd{rotation_matrix(turn), centre}.inverse();
    frame.turn = {turn.w, -turn.x, -turn.y, -turn.z};
    if (random.chance(0.3)) frame.orientation = 1 + random.below(8);
    return frame;
  }
};

}  // namespace aligngs
