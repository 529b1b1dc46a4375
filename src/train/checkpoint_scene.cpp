#include "train/checkpoint_scene.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"
#include "train/checkpoint_tensors.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSceneFile = "scene_ply";           // metadata: bytes and CRC-32 of the file
constexpr const char* kLengths = "rotations.lengths";     // per Gaussian
constexpr const char* kLastBits = "rotations.last_bits";  // per number: steps from unit times length to the value
constexpr int kMostSteps = 127;                           // three occur

std::string identity_of(const std::string& bytes) {
  const auto crc = static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  return fmt::format("{} {:08x}", bytes.size(), crc);
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

float length_of(const float* rotation) {
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += static_cast<double>(rotation[k]) * static_cast<double>(rotation[k]);
  return static_cast<float>(std::sqrt(sum));
}

/// A number of a rotation from that of its unit rotation. The product is exact: every machine has the same bits.
int32_t first_guess(float unit, float length) {
  return std::bit_cast<int32_t>(static_cast<float>(static_cast<double>(unit) * static_cast<double>(length)));
}

/// Nothing where a number lies further from its guess than a byte can tell.
std::optional<std::vector<int8_t>> last_bits(const std::vector<float>& rotations, const std::vector<float>& units,
                                             const std::vector<float>& lengths) {
  std::vector<int8_t> steps(rotations.size());
  for (size_t i = 0; i < rotations.size(); ++i) {
    const int64_t step =
        static_cast<int64_t>(std::bit_cast<int32_t>(rotations[i])) - first_guess(units[i], lengths[i / 4]);
    if (step < -kMostSteps || step > kMostSteps) return std::nullopt;
    steps[i] = static_cast<int8_t>(step);
  }
  return steps;
}

}  // namespace

bool refer_to_scene(const fs::path& scene_ply, const GaussianModel& model, TensorFile& file) {
  if (!fs::exists(scene_ply)) return false;
  const std::string bytes = read_file(scene_ply);
  GaussianModel written;
  try {
    written = decode_gaussian_ply(bytes, scene_ply);
  } catch (const Error&) {
    return false;  // of something else
  }
  if (written.size() != model.size() || !same_bits(written.positions, model.positions) ||
      !same_bits(written.log_scales, model.log_scales) || !same_bits(written.opacity_logits, model.opacity_logits) ||
      !same_bits(written.sh, model.sh)) {
    return false;
  }
  std::vector<float> lengths(model.size());
  for (size_t i = 0; i < lengths.size(); ++i) lengths[i] = length_of(&model.rotations[4 * i]);
  const std::optional<std::vector<int8_t>> steps = last_bits(model.rotations, written.rotations, lengths);
  if (!steps) return false;
  file.tensors[kLengths] = tensor_of(lengths);
  file.tensors[kLastBits] = raw_tensor("I8", steps->data(), steps->size());
  file.metadata[kSceneFile] = identity_of(bytes);
  return true;
}

bool refers_to_scene(const TensorFile& file) { return file.metadata.count(kSceneFile) > 0; }

GaussianModel model_of_scene(const fs::path& scene_ply, const TensorFile& file, const fs::path& checkpoint) {
  constexpr const char* kRemedy = "put back the scene.ply of this run, or train again with --overwrite";
  if (!fs::exists(scene_ply)) {
    throw_bad_input(scene_ply, kSceneField, "the checkpoint of this finished run needs its scene.ply, which is gone",
                    kRemedy);
  }
  const std::string bytes = read_file(scene_ply);
  if (identity_of(bytes) != file.metadata.at(kSceneFile)) {
    throw_bad_input(scene_ply, kSceneField, "scene.ply is not the one that the checkpoint of this run was written with",
                    kRemedy);
  }
  GaussianModel model = decode_gaussian_ply(bytes, scene_ply);
  const std::vector<float> lengths = raw_values<float>(file, kLengths, "F32", checkpoint);
  const std::vector<int8_t> steps = raw_values<int8_t>(file, kLastBits, "I8", checkpoint);
  if (lengths.size() != model.size() || steps.size() != model.rotations.size())
    throw_bad_input(checkpoint, kLengths, "the tensor has another size than the Gaussians of scene.ply need");
  for (size_t i = 0; i < steps.size(); ++i)
    model.rotations[i] = std::bit_cast<float>(first_guess(model.rotations[i], lengths[i / 4]) + steps[i]);
  return model;
}

}  // namespace aligngs
