// The part of a finished run's checkpoint that scene.ply has already: places, sizes, colours and opacities.
#pragma once

#include <filesystem>

#include "gaussians/gaussian_model.h"
#include "io/safetensors.h"

namespace aligngs {

/// Field of the errors by which a reader tells a scene.ply that does not fit from a damaged checkpoint.
inline constexpr const char* kSceneField = "bytes of the checkpoint's scene";

/// Names `scene_ply` in the metadata by its bytes and their CRC-32. Puts the lengths of rotations, which it has at length
/// one. False, and nothing is put, where the file is absent or would not give the model back bit for bit.
bool refer_to_scene(const std::filesystem::path& scene_ply, const GaussianModel& model, TensorFile& file);

/// refer_to_scene() has put something.
bool refers_to_scene(const TensorFile& file);

/// The model bit for bit, but its semantic rows and its degree of harmonics. Error{kBadInput} with kSceneField where
/// scene.ply is absent or has changed; Error{kBadInput} for tensors of the checkpoint that do not fit it.
GaussianModel model_of_scene(const std::filesystem::path& scene_ply, const TensorFile& file,
                             const std::filesystem::path& checkpoint);

}  // namespace aligngs
