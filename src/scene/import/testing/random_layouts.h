// A random capture written in each folder layout that the importers read, for tests of all of them.
#pragma once

#include <unistd.h>

#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "core/sanitizers.h"
#include "io/colmap.h"
#include "io/npy.h"
#include "scene/import/capture.h"
#include "scene/import/testing/random_capture.h"

namespace aligngs {

namespace fs = std::filesystem;

/// A folder in memory where the system has one: the importers wait for the disk with every file, thousands of times
/// here.
inline fs::path scratch_folder(const std::string& name) {
  const fs::path memory = "/dev/shm";
  return (fs::is_directory(memory) ? memory : fs::temp_directory_path()) / fmt::format("aligngs_{}_{}", name, getpid());
}

/// How many captures a test draws: a twelfth under the sanitizers, which are slower by as much.
inline uint64_t random_captures(uint64_t many) { return kAddressSanitizer ? many / 12 : many; }

/// A folder in one layout, and what is to come out of it beside the capture's own truth.
struct Written {
  RandomCapture capture;
  std::map<std::string, size_t> frame_of;  ///< file name of the photo to the frame's index
  bool depth = false;
  CaptureOptions options;
};

inline void write_text(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

inline std::string matrix3(const RandomLens& lens, double offset) {
  return fmt::format("{:.17g} 0 {:.17g}\n0 {:.17g} {:.17g}\n0 0 1\n", lens.fx, lens.cx + offset, lens.fy,
                     lens.cy + offset);
}

inline void photo_of(Written& written, size_t index, const fs::path& file) {
  written.capture.write_photo(written.capture.frames[index], file);
  written.frame_of[file.filename().string()] = index;
}

inline constexpr double kMillimetre = 0.001;

/// Numbers as Fortran writes them: 1.5 as 1.5D+00.
inline std::string with_fortran_exponents(const std::string& numbers) {
  std::istringstream words(numbers);
  std::string out;
  for (std::string word; words >> word;) {
    const size_t exponent = word.find('e');
    if (exponent != std::string::npos)
      word[exponent] = 'D';
    else if (word.find_first_of("aif") == std::string::npos)  // no nan
      word += "D+00";
    out += word + " ";
  }
  return out;
}

/// A pose as text, with other exponents, or as an array, which is for coordinates of a room.
inline void write_pose(RandomCapture& capture, const RandomFrame& frame, const fs::path& stem) {
  const std::string matrix = capture.matrix(frame, false);
  const bool room = norm(frame.world_to_camera.inverse().translation) < 1e3;
  const int kind = capture.random.below(room ? 4 : 3);
  if (kind == 3) {
    std::istringstream words(matrix);
    std::vector<float> numbers;
    for (std::string word; words >> word;) numbers.push_back(std::strtof(word.c_str(), nullptr));
    fs::create_directories(stem.parent_path());
    write_npy_float32(stem.string() + ".npy", {4, 4}, numbers.data());
  } else {
    write_text(stem.string() + ".txt", kind == 2 ? with_fortran_exponents(matrix) : matrix);
  }
}

inline Written rgbd(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, true, {}};
  RandomCapture& capture = out.capture;
  write_text(folder / "intrinsics.txt", matrix3(capture.lens, 0));
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const RandomFrame& frame = capture.frames[i];
    photo_of(out, i, folder / "images" / (frame.name + capture.extension));
    capture.write_depth(frame, folder / "depth" / (frame.name + ".png"), kMillimetre);
    write_pose(capture, frame, folder / "poses" / frame.name);
  }
  return out;
}

inline Written scannet(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, true, {}};
  RandomCapture& capture = out.capture;
  // Files count from the centre of the first pixel. The depth camera is the colour camera at another size.
  const auto matrix4 = [&](double times) {
    const RandomLens& l = capture.lens;
    return fmt::format("{:.17g} 0 {:.17g} 0\n0 {:.17g} {:.17g} 0\n0 0 1 0\n0 0 0 1\n", l.fx * times, l.cx * times - 0.5,
                       l.fy * times, l.cy * times - 0.5);
  };
  const int times = 1 + capture.random.below(2);
  write_text(folder / "intrinsic" / "intrinsic_color.txt", matrix4(1));
  write_text(folder / "intrinsic" / "intrinsic_depth.txt", matrix4(times));
  const std::string identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  for (const char* which : {"color", "depth"})
    write_text(folder / "intrinsic" / fmt::format("extrinsic_{}.txt", which), identity);
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const std::string name = std::to_string(10 * i);
    photo_of(out, i, folder / "color" / (name + ".jpg"));
    capture.write_depth(capture.frames[i], folder / "depth" / (name + ".png"), kMillimetre, times);
    write_pose(capture, capture.frames[i], folder / "pose" / name);
  }
  return out;
}

inline Written seven_scenes(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, true, {}};
  RandomCapture& capture = out.capture;
  out.options.intrinsics = folder / "colour_intrinsics.txt";
  out.options.assume_registered = true;
  write_text(out.options.intrinsics, matrix3(capture.lens, 0));
  const bool sequence = capture.random.chance(0.5);
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const std::string stem = (sequence ? "seq-01/" : "") + fmt::format("frame-{:06}", i);
    photo_of(out, i, folder / (stem + ".color.png"));
    capture.write_depth(capture.frames[i], folder / (stem + ".depth.png"), kMillimetre);
    write_text(folder / (stem + ".pose.txt"), capture.matrix(capture.frames[i], false, "\t"));
  }
  return out;
}

inline Written tum(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, true, {}};
  RandomCapture& capture = out.capture;
  out.options.intrinsics = folder / "intrinsics.txt";
  write_text(out.options.intrinsics, matrix3(capture.lens, -0.5));  // from the centre of the first pixel
  std::string colours = "# color images\n", depths = "# depth maps\n", poses = "# timestamp tx ty tz qx qy qz qw\n";
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const RandomFrame& frame = capture.frames[i];
    const double time = 1305031102.175304 + 0.1 * double(i);
    const auto jittered = [&] { return time + capture.random.uniform(-0.015, 0.015); };
    const std::string photo = fmt::format("rgb/{:.6f}.png", time), depth = fmt::format("depth/{:.6f}.png", time);
    photo_of(out, i, folder / photo);
    capture.write_depth(frame, folder / depth, 1.0 / 5000);
    colours += fmt::format("{:.6f} {}\n", time, photo);
    depths += fmt::format("{:.6f} {}\n", jittered(), depth);
    const Vec3d t = frame.world_to_camera.inverse().translation;
    const Quaterniond& q = frame.turn;  // world-to-camera; the file has camera-to-world
    if (frame.fault == Fault::kNanPose) continue;
    poses += fmt::format("{:.4f} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", jittered(), t.x, t.y, t.z,
                         -q.x, -q.y, -q.z, q.w);
  }
  write_text(folder / "rgb.txt", colours);
  write_text(folder / "depth.txt", depths);
  write_text(folder / "groundtruth.txt", poses);
  return out;
}

inline Written neural_rgbd(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, true, {}};
  RandomCapture& capture = out.capture;
  capture.centre();
  write_text(folder / "focal.txt", fmt::format("{:.17g}\n", capture.lens.fx));
  std::string poses;
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    photo_of(out, i, folder / "images" / fmt::format("img{}.png", i));
    capture.write_depth(capture.frames[i], folder / "depth" / fmt::format("depth{}.png", i), kMillimetre);
    poses += capture.matrix(capture.frames[i], true) + "\n";
  }
  write_text(folder / "poses.txt", poses);
  return out;
}

inline Written replica(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, true, {}};
  RandomCapture& capture = out.capture;
  const RandomLens& l = capture.lens;
  write_text(
      folder / "cam_params.json",
      fmt::format(
          R"({{"camera": {{"w": {}, "h": {}, "fx": {:.17g}, "fy": {:.17g}, "cx": {:.17g}, "cy": {:.17g}, "scale": 6553.5}}}})",
          l.width, l.height, l.fx, l.fy, l.cx - 0.5, l.cy - 0.5));
  std::string poses;
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    photo_of(out, i, folder / "results" / fmt::format("frame{:06}.jpg", i));
    capture.write_depth(capture.frames[i], folder / "results" / fmt::format("depth{:06}.png", i), 1 / 6553.5);
    poses += capture.matrix(capture.frames[i], false, " ", " ") + "\n";
  }
  write_text(folder / "traj.txt", poses);
  return out;
}

/// nerfstudio's: a lens for the file or for each frame, depth in a unit of its own, matrices with a scale, photos
/// halved since.
inline Written transforms(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, true), {}, false, {}};
  RandomCapture& capture = out.capture;
  RandomLens& l = capture.lens;
  out.depth = l.model == "PINHOLE" && capture.random.chance(0.5);
  const bool per_frame = capture.random.chance(0.5);
  const double scale = capture.random.chance(0.5) ? 1 : capture.random.uniform(0.5, 2),
               unit = capture.random.chance(0.5) ? 0.001 : 0.0002;
  const double size = capture.random.chance(0.3) ? 2 : 1;  // of the pictures that the cameras were found in
  const bool matrix_of_lens = capture.random.chance(0.3), by_hand = capture.random.chance(0.3);
  std::string lens = fmt::format(
      fmt::runtime(matrix_of_lens ? R"("camera_intrinsics": [[{:.17g}, 0, {:.17g}], [0, {:.17g}, {:.17g}], [0, 0, 1]])"
                                  : R"("fl_x": {:.17g}, "cx": {:.17g}, "fl_y": {:.17g}, "cy": {:.17g})"),
      l.fx * size, l.cx * size, l.fy * size, l.cy * size);
  lens += fmt::format(R"(, "w": {}, "h": {}, "k1": {:.17g}, "k2": {:.17g}, "p1": {:.17g}, "p2": {:.17g})",
                      l.width * size, l.height * size, l.k1, l.k2, l.p1, l.p2);
  if (l.model == "OPENCV_FISHEYE")
    lens += R"(, "k3": 0, "k4": 0, "camera_model": "OPENCV_FISHEYE")";
  else if (capture.random.chance(0.5))
    lens += R"(, "camera_model": "OPENCV")";
  std::string frames;
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const RandomFrame& frame = capture.frames[i];
    photo_of(out, i, folder / "images" / (frame.name + capture.extension));
    const std::string matrix = capture.matrix(frame, true, ", ", "], [", scale);
    frames += fmt::format(R"({}{{"file_path": "{}images/{}{}", "transform_matrix": [[{}]])", i ? ",\n" : "",
                          capture.random.chance(0.3) ? "./" : "", frame.name, capture.extension, matrix);
    if (per_frame) frames += ", " + lens;
    if (out.depth) {
      capture.write_depth(frame, folder / "depth" / (frame.name + ".png"), unit * scale);
      frames += fmt::format(R"(, "depth_file_path": "depth/{}.png")", frame.name);
    }
    frames += "}";
  }
  std::string all = "{" + (per_frame ? "" : lens + ", ");
  if (unit != 0.001) all += fmt::format(R"("depth_unit_scale_factor": {}, )", unit);
  const char* const end = by_hand ? ", // the last\n],}\n" : "\n]}\n";
  write_text(folder / "transforms.json", all + "\"frames\": [\n" + frames + end);
  return out;
}

/// Blender's: an angle of view, names without extension.
inline Written blender(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, false, {}};
  RandomCapture& capture = out.capture;
  capture.centre();
  std::string frames;
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const RandomFrame& frame = capture.frames[i];
    photo_of(out, i, folder / "train" / fmt::format("r_{}.png", i));
    frames += fmt::format(R"({}{{"file_path": "./train/r_{}", "transform_matrix": [[{}]]}})", i ? ",\n" : "", i,
                          capture.matrix(frame, true, ", ", "], ["));
  }
  const double angle = 2 * std::atan(0.5 * capture.lens.width / capture.lens.fx);
  write_text(folder / "transforms_train.json",
             fmt::format("{{\"camera_angle_x\": {:.17g}, \"frames\": [{}]}}", angle, frames));
  return out;
}

/// A telephone's depth: of no confidence in the left columns, which hold a wrong one.
inline void phone_depth(const RandomCapture& capture, const RandomFrame& frame, const fs::path& depth,
                        const fs::path& confidence) {
  capture.write_depth(frame, depth, kMillimetre);
  Image<uint16_t> map = read_gray_png(depth);
  Image<uint8_t> sure(map.width, map.height, 1, 255);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width / 10; ++x) {
      map.at(x, y) = 9000;
      sure.at(x, y) = 0;
    }
  }
  write_png16(depth, map);
  fs::create_directories(confidence.parent_path());
  write_png(confidence, sure);
}

/// Polycam's raw data, with or without the corrected folders.
inline Written polycam(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, true, {}};
  RandomCapture& capture = out.capture;
  const RandomLens& l = capture.lens;
  const bool corrected = capture.random.chance(0.7);
  const fs::path keyframes = folder / "keyframes";
  const std::string prefix = corrected ? "corrected_" : "";
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const RandomFrame& frame = capture.frames[i];
    const std::string name = std::to_string(5812345678 + 100000 * i);
    photo_of(out, i, keyframes / (prefix + "images") / (name + ".jpg"));
    if (corrected) write_text(keyframes / "cameras" / (name + ".json"), "{}");  // is not to be read
    std::istringstream numbers(capture.matrix(frame, true, " ", " "));
    std::string json = fmt::format(
        R"({{"fx": {:.17g}, "fy": {:.17g}, "cx": {:.17g}, "cy": {:.17g}, "width": {}, "height": {}, "blur_score": 80)",
        l.fx, l.fy, l.cx, l.cy, l.width, l.height);
    for (int k = 0; k < 12; ++k) {
      std::string value;
      numbers >> value;
      json += fmt::format(R"(, "t_{}{}": {})", k / 4, k % 4, value);
    }
    write_text(keyframes / (prefix + "cameras") / (name + ".json"), json + "}");
    phone_depth(capture, frame, keyframes / "depth" / (name + ".png"), keyframes / "confidence" / (name + ".png"));
  }
  return out;
}

/// 3D Scanner App's, with frames that have no photo.
inline Written scanner_app(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, false), {}, true, {}};
  RandomCapture& capture = out.capture;
  const RandomLens& l = capture.lens;
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const RandomFrame& frame = capture.frames[i];
    for (int k = 0; k < 2; ++k) {
      const std::string number = fmt::format("{:05}", 2 * i + size_t(k));
      std::istringstream numbers(capture.matrix(frame, true, " ", " "));
      std::string pose, value;
      while (numbers >> value) pose += (pose.empty() ? "" : ", ") + value;
      write_text(
          folder / ("frame_" + number + ".json"),
          fmt::format(
              R"({{"frame_index": {}, "motionQuality": 1, "intrinsics": [{:.17g}, 0, {:.17g}, 0, {:.17g}, {:.17g}, 0, 0, 1], "cameraPoseARFrame": [{}]}})",
              2 * i + size_t(k), l.fx, l.cx, l.fy, l.cy, pose));
      if (k == 1) continue;  // no photo of this one
      photo_of(out, i, folder / ("frame_" + number + ".jpg"));
      phone_depth(capture, frame, folder / ("depth_" + number + ".png"), folder / ("conf_" + number + ".png"));
    }
  }
  return out;
}

/// Binary or text, at four places, photos in subfolders or halved since.
inline Written colmap(uint64_t seed, const fs::path& folder) {
  Written out{RandomCapture(seed, true), {}, false, {}};
  RandomCapture& capture = out.capture;
  const RandomLens& l = capture.lens;
  const int size = capture.random.chance(0.3) ? 2 : 1;
  const char* places[] = {"sparse", "sparse/0", "colmap/sparse/0", "sparse/3"};
  const fs::path place = folder / places[capture.random.below(4)];
  const bool text = capture.random.chance(0.5), below = capture.random.chance(0.5);
  constexpr double kSentinel = 123456.789;  // becomes nan in the file
  ColmapModel model;
  model.cameras = {{7, l.model, uint64_t(l.width * size), uint64_t(l.height * size), l.parameters(size)}};
  std::string lines;
  for (size_t i = 0; i < capture.frames.size(); ++i) {
    const RandomFrame& frame = capture.frames[i];
    ColmapImage image;
    image.id = uint32_t(i + 1);
    image.camera_id = 7;
    image.name = (below ? (i % 2 ? "left/" : "right/") : "") + frame.name + capture.extension;
    image.rotation = frame.turn;
    image.translation = frame.world_to_camera.translation;
    if (frame.fault == Fault::kNanPose) image.translation.x = text ? std::nan("") : kSentinel;
    photo_of(out, i, folder / "images" / image.name);
    lines += fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} 7 {}\n\n", image.id,
                         image.rotation.w, image.rotation.x, image.rotation.y, image.rotation.z, image.translation.x,
                         image.translation.y, image.translation.z, image.name);
    model.images.push_back(image);
  }
  const Vec3d middle = capture.frames[0].world_to_camera.inverse() * Vec3d{0, 0, 2};
  for (uint64_t i = 0; i < 20; ++i) {
    model.points.push_back(
        {i + 1,
         middle + Vec3d{capture.random.normal(), capture.random.normal(), capture.random.normal()} * 0.3,
         {1, 2, 3},
         0.5,
         {}});
  }
  if (!text) {
    write_colmap_binary(place, model);  // which writes no pose that is not finite
    std::string bytes = read_file(place / "images.bin");
    const double nan = std::nan("");
    const std::string wanted(reinterpret_cast<const char*>(&kSentinel), sizeof kSentinel),
        lost(reinterpret_cast<const char*>(&nan), sizeof nan);
    for (size_t at = 0; (at = bytes.find(wanted, at)) != std::string::npos;) bytes.replace(at, lost.size(), lost);
    write_file_atomically(place / "images.bin", bytes);
    return out;
  }
  std::string camera = fmt::format("# Camera list\n7 {} {} {}", l.model, l.width * size, l.height * size), points;
  for (const double p : l.parameters(size)) camera += fmt::format(" {:.17g}", p);
  for (const ColmapPoint& p : model.points)
    points += fmt::format("{} {:.17g} {:.17g} {:.17g} 1 2 3 0.5\n", p.id, p.position.x, p.position.y, p.position.z);
  write_text(place / "cameras.txt", camera + "\n");
  write_text(place / "images.txt", lines);
  write_text(place / "points3D.txt", points);
  return out;
}

struct Layout {
  const char* name;
  std::function<Written(uint64_t, const fs::path&)> write;
};
inline void PrintTo(const Layout& layout, std::ostream* out) { *out << layout.name; }

/// All of them.
inline std::vector<Layout> random_layouts() {
  return {{"rgbd", rgbd},
          {"scannet", scannet},
          {"seven_scenes", seven_scenes},
          {"tum", tum},
          {"neural_rgbd", neural_rgbd},
          {"replica", replica},
          {"transforms", transforms},
          {"blender", blender},
          {"colmap", colmap},
          {"polycam", polycam},
          {"scanner_app", scanner_app}};
}

}  // namespace aligngs
