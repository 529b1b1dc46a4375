// Small valid files of every format, to be damaged by the malformed-input test and to seed the
// fuzzers.
#pragma once

#include <webp/encode.h>

#include <string>
#include <vector>

#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/colmap.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "io/ply.h"
#include "io/safetensors.h"
#include "io/torch_archive.h"

namespace aligngs::valid_files {

inline std::string text_of(const std::vector<uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

inline Image<uint8_t> picture(int channels) {
  Image<uint8_t> image(9, 7, channels);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = uint8_t(i * i * 31 + i / 7);
  return image;
}

inline std::string webp() {
  const Image<uint8_t> image = picture(3);
  uint8_t* out = nullptr;
  const size_t size = WebPEncodeRGB(image.data.data(), image.width, image.height, 3 * image.width, 80, &out);
  const std::string bytes(reinterpret_cast<char*>(out), size);
  WebPFree(out);
  return bytes;
}

inline std::string heic() {
  return read_file(std::filesystem::path(ALIGNGS_SOURCE_DIR) / "tests/data/pictures/plain.heic");
}

inline std::string npy(const std::filesystem::path& folder) {
  const float values[6] = {1, 2, 3, 4, 5, 6};
  write_npy_float32(folder / "a.npy", {2, 3}, values);
  return read_file(folder / "a.npy");
}

inline std::string torch(const std::filesystem::path& folder) {
  const float values[6] = {1, 2, 3, 4, 5, 6};
  write_torch_tensor(folder / "a.pt", {2, 3}, values);
  return read_file(folder / "a.pt");
}

inline std::string safetensors(const std::filesystem::path& folder) {
  TensorFile file;
  file.tensors["weights"] = tensor_of({1, 2, 3, 4}, {2, 2});
  file.tensors["labels"] = {"U8", {3}, {1, 2, 3}};
  file.metadata["note"] = "x";
  write_safetensors(folder / "a.safetensors", file);
  return read_file(folder / "a.safetensors");
}

inline std::string binary_ply(const std::filesystem::path& folder) {
  PlyFile file;
  file.comments = {"small"};
  file.elements = {
      {"vertex", 2, {{"x", PlyType::kFloat32, false, {1, 2}, {}}, {"label", PlyType::kUint16, false, {1, 2}, {}}}},
      {"face", 2, {{"vertex_indices", PlyType::kInt32, true, {0, 1, 0, 1}, {0, 3, 4}}}}};
  write_ply(folder / "a.ply", file);
  return read_file(folder / "a.ply");
}

inline std::string ascii_ply() {
  return "ply\r\nformat ascii 1.0\r\ncomment x\r\nelement vertex 2\r\nproperty float x\r\nproperty "
         "uchar red\r\n"
         "element face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n1.5 255\r\n-2 "
         "0\r\n2 0 1\r\n";
}

struct ColmapFiles {
  std::string cameras, images, points;
};

inline ColmapFiles colmap(const std::filesystem::path& folder) {
  ColmapModel model;
  model.cameras.push_back({1, "PINHOLE", 64, 48, {50, 50, 32, 24}});
  ColmapImage image;
  image.id = 2;
  image.camera_id = 1;
  image.name = "a.jpg";
  image.points = {{1, 2}};
  image.point_ids = {3};
  model.images = {image};
  ColmapPoint point;
  point.id = 3;
  point.track = {{2, 0}};
  model.points = {point};
  write_colmap_binary(folder / "sparse", model);
  return {read_file(folder / "sparse/cameras.bin"), read_file(folder / "sparse/images.bin"),
          read_file(folder / "sparse/points3D.bin")};
}

inline ColmapFiles colmap_text() {
  return {"# cameras\n1 PINHOLE 64 48 50 50 32 24\n", "2 1 0 0 0 0 0 0 1 a.jpg\n1 2 3\n3 1 0 0 0 0 0 0 1 b.jpg\n\n",
          "3 0.1 0.2 0.3 255 0 7 0.65 2 0\n"};
}

inline std::string gray_png16(const std::filesystem::path& folder) {
  Image<uint16_t> depth(5, 4, 1);
  for (size_t i = 0; i < depth.data.size(); ++i) depth.data[i] = uint16_t(i * 3000);
  write_png16(folder / "depth.png", depth);
  return read_file(folder / "depth.png");
}

/// A JPEG with an EXIF segment that says "turn by 90 degrees".
inline std::string jpeg_with_exif() {
  const std::string jpeg = text_of(encode_jpeg(picture(3), 80));
  const std::string exif(
      "\xff\xe1\x00\x22"
      "Exif\0\0II\x2a\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
      36);
  return jpeg.substr(0, 2) + exif + jpeg.substr(2);
}

inline std::string toml() {
  return "seed = 7\n[loss]\nnormal = 5e-1 # x\non = true\nkinds = [\"a\", 'b']\nsteps = [1, "
         "2.5]\n[loss.depth]\n"
         "name = \"\"\"inverse\n\"\"\"\nsize.width = 0x40\n";
}

}  // namespace aligngs::valid_files
