#include "train/checkpoint.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <memory>

#include "core/error.h"
#include "core/log.h"
#include "core/version.h"
#include "io/byte_source.h"
#include "io/safetensors.h"
#include "train/checkpoint_packing.h"
#include "train/checkpoint_planes.h"
#include "train/checkpoint_scene.h"
#include "train/checkpoint_tensors.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

// 1: an empty tensor hid damage in those before it from the checksum
constexpr const char* kSchema = "aligngs-checkpoint-2";
// 3: of a finished run, which may leave its geometry to scene.ply; 2 as well where an older program finished it
constexpr const char* kFinishedSchema = "aligngs-checkpoint-3";
constexpr const char* kPrefix = "step_";
constexpr const char* kSuffix = ".safetensors";
constexpr const char* kTrainable = "trainable";     // "0": without the arrays of the engine
constexpr const char* kOtherScene = "other scene";  // field by which the caller tells this case from damage
const std::string kEnginePrefix = "engine.";        // of the names of EngineState::arrays
constexpr size_t kPieceBytes = size_t(1) << 18;     // of a tensor that is only summed: it fits the second-level cache

std::vector<float> float_tensor(const TensorFile& file, const std::string& name, size_t count, const fs::path& path) {
  const auto it = file.tensors.find(name);
  if (it == file.tensors.end()) throw_bad_input(path, name, "the tensor is missing");
  std::vector<float> values = floats_of(it->second, path.string() + ": " + name);
  if (values.size() != count) throw_bad_input(path, name, "the tensor has another size than the Gaussians need");
  return values;
}

uint32_t add_to_checksum(uint32_t crc, const void* data, size_t bytes) {
  if (bytes == 0) return crc;  // zlib begins anew when given no address, which is what an empty vector has
  return static_cast<uint32_t>(crc32_z(crc, static_cast<const Bytef*>(data), bytes));
}

/// CRC-32 over names, types, content and metadata: damage that leaves the file well-formed is found too.
/// `add_content(crc, name)` is the sum with the content of that tensor added.
template <class Tensors, class AddContent>
std::string checksum(const Tensors& tensors, const std::map<std::string, std::string>& metadata,
                     const AddContent& add_content) {
  uint32_t crc = static_cast<uint32_t>(crc32_z(0, nullptr, 0));
  for (const auto& [name, tensor] : tensors) {
    crc = add_to_checksum(crc, name.data(), name.size());
    crc = add_to_checksum(crc, tensor.dtype.data(), tensor.dtype.size());
    crc = add_content(crc, name);
  }
  for (const auto& [name, text] : metadata) {
    if (name == "crc32") continue;
    crc = add_to_checksum(crc, name.data(), name.size());
    crc = add_to_checksum(crc, text.data(), text.size());
  }
  return fmt::format("{:08x}", crc);
}

std::string checksum(const TensorFile& file) {
  return checksum(file.tensors, file.metadata, [&](uint32_t crc, const std::string& name) {
    const std::vector<uint8_t>& bytes = file.tensors.at(name).bytes;
    return add_to_checksum(crc, bytes.data(), bytes.size());
  });
}

bool is_engine_array(const std::string& name) { return name.compare(0, kEnginePrefix.size(), kEnginePrefix) == 0; }

/// All metadata and the tensors that are asked for; the checksum is of the whole file.
TensorFile read_tensors(const fs::path& path, CheckpointParts parts, std::string& sum) {
  const std::unique_ptr<const ByteSource> source = file_source(path);
  const TensorDirectory directory = read_safetensors_directory(*source);
  TensorFile file;
  file.metadata = directory.metadata;
  std::vector<char> piece(kPieceBytes);
  sum = checksum(directory.tensors, directory.metadata, [&](uint32_t crc, const std::string& name) {
    const TensorPlace& place = directory.tensors.at(name);
    if (parts == CheckpointParts::kAll || !is_engine_array(name)) {
      const TensorBytes& tensor = file.tensors[name] = read_tensor(*source, place);
      return add_to_checksum(crc, tensor.bytes.data(), tensor.bytes.size());
    }
    for (uint64_t done = 0; done < place.bytes; done += piece.size()) {
      const size_t count = std::min<uint64_t>(piece.size(), place.bytes - done);
      source->read_into(place.offset + done, count, piece.data());
      crc = add_to_checksum(crc, piece.data(), count);
    }
    return crc;
  });
  return file;
}

template <class T>
T metadata_number(const TensorFile& file, const char* name, const fs::path& path) {
  const auto it = file.metadata.find(name);
  T value{};
  if (it != file.metadata.end()) {
    const std::string& text = it->second;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec == std::errc() && result.ptr == text.data() + text.size()) return value;
  }
  throw_bad_input(path, name, "the number is missing or malformed");
}

fs::path scene_beside(const fs::path& checkpoints) { return checkpoints.parent_path() / "scene.ply"; }

void put_geometry(const GaussianModel& model, TensorFile& file) {
  const int64_t n = static_cast<int64_t>(model.size());
  file.tensors["model.positions"] = tensor_of(model.positions, {n, 3});
  file.tensors["model.log_scales"] = tensor_of(model.log_scales, {n, 3});
  file.tensors["model.rotations"] = tensor_of(model.rotations, {n, 4});
  file.tensors["model.opacity_logits"] = tensor_of(model.opacity_logits, {n});
  file.tensors["model.sh"] = tensor_of(model.sh, {n, kShCoefficients, 3});
}

void put_rest_of_model(const GaussianModel& model, TensorFile& file) {
  const int64_t n = static_cast<int64_t>(model.size());
  file.tensors["model.semantics"] = tensor_of(model.semantics, {n, model.semantic_channels});
  file.metadata["gaussians"] = std::to_string(n);
  file.metadata["sh_degree"] = std::to_string(model.sh_degree);
  file.metadata["semantic_channels"] = std::to_string(model.semantic_channels);
}

GaussianModel take_geometry(const TensorFile& file, size_t n, const fs::path& path) {
  GaussianModel model;
  model.positions = float_tensor(file, "model.positions", 3 * n, path);
  model.log_scales = float_tensor(file, "model.log_scales", 3 * n, path);
  model.rotations = float_tensor(file, "model.rotations", 4 * n, path);
  model.opacity_logits = float_tensor(file, "model.opacity_logits", n, path);
  model.sh = float_tensor(file, "model.sh", size_t(3) * kShCoefficients * n, path);
  return model;
}

GaussianModel take_model(const TensorFile& file, const fs::path& path) {
  const size_t n = metadata_number<uint64_t>(file, "gaussians", path);
  GaussianModel model = refers_to_scene(file) ? model_of_scene(scene_beside(path.parent_path()), file, path)
                                              : take_geometry(file, n, path);
  if (model.size() != n) throw_bad_input(path, "gaussians", "scene.ply has another number of Gaussians");
  model.sh_degree = metadata_number<int>(file, "sh_degree", path);
  model.semantic_channels = metadata_number<int>(file, "semantic_channels", path);
  model.semantics = float_tensor(file, "model.semantics", static_cast<size_t>(model.semantic_channels) * n, path);
  return model;
}

constexpr size_t kMotionNumbers = 19;  // offset, both moments, updates

std::vector<double> numbers_of(const std::vector<CameraMotion>& motions) {
  std::vector<double> out;
  for (const CameraMotion& motion : motions) {
    for (const auto* part : {&motion.offset, &motion.m, &motion.v}) out.insert(out.end(), part->begin(), part->end());
    out.push_back(static_cast<double>(motion.updates));
  }
  return out;
}

/// Checkpoints of runs that moved no camera do not have them.
std::vector<CameraMotion> take_motions(const TensorFile& file, const fs::path& path) {
  constexpr const char* kName = "camera_motions";
  if (file.tensors.count(kName) == 0) return {};
  const std::vector<double> numbers = raw_values<double>(file, kName, "F64", path);
  if (numbers.size() % kMotionNumbers != 0)
    throw_bad_input(path, kName, "the tensor has another size than cameras need");
  std::vector<CameraMotion> motions(numbers.size() / kMotionNumbers);
  for (size_t i = 0; i < motions.size(); ++i) {
    const double* from = &numbers[i * kMotionNumbers];
    for (auto* part : {&motions[i].offset, &motions[i].m, &motions[i].v}) {
      std::copy_n(from, part->size(), part->begin());
      from += part->size();
    }
    motions[i].updates = static_cast<int64_t>(*from);
  }
  return motions;
}

/// (iteration, file), newest first.
std::vector<std::pair<int64_t, fs::path>> find_checkpoints(const fs::path& folder) {
  std::vector<std::pair<int64_t, fs::path>> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const std::string_view prefix = kPrefix, suffix = kSuffix;
    if (name.size() <= prefix.size() + suffix.size() || name.compare(0, prefix.size(), prefix) != 0) continue;
    if (name.compare(name.size() - suffix.size(), suffix.size(), suffix) != 0) continue;
    const char* begin = name.data() + prefix.size();
    const char* end = name.data() + name.size() - suffix.size();
    int64_t step = 0;
    const auto result = std::from_chars(begin, end, step);
    if (result.ec == std::errc() && result.ptr == end) found.emplace_back(step, entry.path());
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  return found;
}

}  // namespace

std::vector<fs::path> list_checkpoints(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (auto& f : find_checkpoints(folder)) paths.push_back(std::move(f.second));
  return paths;
}

void apply_motions(const std::vector<CameraMotion>& motions, Scene& scene) {
  if (motions.empty()) return;
  if (motions.size() != scene.train.size()) {
    throw_bad_input(scene.folder, "train", "the run moved the cameras of another number of training views",
                    "give the scene the run began with");
  }
  for (size_t i = 0; i < motions.size(); ++i) {
    Rigidd& pose = scene.views[static_cast<size_t>(scene.train[i])].camera.world_to_camera;
    pose = moved(pose, motions[i]);
  }
}

bool latest_checkpoint_is_trainable(const fs::path& folder) {
  for (const fs::path& path : list_checkpoints(folder)) {
    try {
      const std::unique_ptr<const ByteSource> source = file_source(path);
      const TensorDirectory directory = read_safetensors_directory(*source);
      const auto found = directory.metadata.find(kTrainable);
      return found == directory.metadata.end() || found->second != "0";
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kBadInput) throw;  // damaged: the reader warns and takes the one before
    }
  }
  return true;
}

void remove_checkpoints_beyond(const fs::path& folder, int64_t iteration) {
  for (const auto& [step, path] : find_checkpoints(folder)) {
    std::error_code ignored;  // the reader skips damaged files anyway
    if (step > iteration) fs::remove(path, ignored);
  }
}

void write_checkpoint(const fs::path& folder, const TrainingState& state, const std::string& fingerprint,
                      int64_t keep) {
  TensorFile file;
  put_rest_of_model(state.engine.model, file);
  if (state.trainable || !refer_to_scene(scene_beside(folder), state.engine.model, file))
    put_geometry(state.engine.model, file);
  if (state.trainable) {
    for (const auto& [name, values] : state.engine.arrays) file.tensors[kEnginePrefix + name] = tensor_of(values);
  } else {
    file.metadata[kTrainable] = "0";
  }
  const std::vector<int64_t> left(state.order.left.begin(), state.order.left.end());
  file.tensors["order.left"] = raw_tensor("I64", left.data(), left.size());
  file.tensors["order.random"] = raw_tensor("U64", state.order.random.data(), state.order.random.size());
  file.tensors["density.random"] = raw_tensor("U64", state.density_random.data(), state.density_random.size());
  file.tensors["depth_scales"] = tensor_of(state.depth_scales);
  if (!state.motions.empty()) {
    const std::vector<double> numbers = numbers_of(state.motions);
    file.tensors["camera_motions"] = raw_tensor("F64", numbers.data(), numbers.size());
  }
  put_planes(state.planes, file);
  file.metadata["schema"] = state.trainable ? kSchema : kFinishedSchema;
  file.metadata["version"] = version();
  file.metadata["fingerprint"] = fingerprint;
  file.metadata["iteration"] = std::to_string(state.iteration);
  file.metadata["non_finite_steps"] = std::to_string(state.non_finite_steps);
  file.metadata["max_gaussians"] = std::to_string(state.facts.max_gaussians);
  file.metadata["dense_start"] = state.facts.dense_start ? "1" : "0";
  file.metadata["normals_at_start"] = state.facts.normals_at_start ? "1" : "0";
  file.metadata["psnr_average"] = fmt::format("{}", state.psnr_average);
  file.metadata["seconds"] = fmt::format("{}", state.seconds);
  if (!state.trainable) pack_tensors(file);
  file.metadata["crc32"] = checksum(file);
  write_safetensors(folder / fmt::format("{}{:06d}{}", kPrefix, state.iteration, kSuffix), file);

  const std::vector<fs::path> all = list_checkpoints(folder);
  for (size_t i = static_cast<size_t>(std::max<int64_t>(1, keep)); i < all.size(); ++i) {
    std::error_code ignored;  // an old checkpoint that cannot be removed does no harm
    fs::remove(all[i], ignored);
  }
}

TrainingState read_checkpoint(const fs::path& path, const std::string& fingerprint, CheckpointParts parts) {
  std::string sum;
  TensorFile file = read_tensors(path, parts, sum);
  const auto meta = [&](const char* name) {
    const auto it = file.metadata.find(name);
    return it == file.metadata.end() ? std::string() : it->second;
  };
  if (meta("schema") != kSchema && meta("schema") != kFinishedSchema) {
    throw_bad_input(path, "schema",
                    fmt::format("not a checkpoint as this version writes them ({}, {})", kSchema, kFinishedSchema),
                    "train again with --overwrite");
  }
  if (meta("crc32") != sum) throw_bad_input(path, "crc32", "the checksum does not match: the file is damaged");
  if (meta("fingerprint") != fingerprint) {
    throw_bad_input(path, kOtherScene, "the checkpoint belongs to another scene, or the scene has changed since",
                    "give the scene the run began with, or start again with --overwrite");
  }
  unpack_tensors(file, path);
  TrainingState state;
  state.iteration = metadata_number<int64_t>(file, "iteration", path);
  state.trainable = meta(kTrainable) != "0";
  state.in_scene_file = refers_to_scene(file);
  state.non_finite_steps = metadata_number<int64_t>(file, "non_finite_steps", path);
  state.facts.max_gaussians = metadata_number<uint64_t>(file, "max_gaussians", path);
  state.facts.dense_start = meta("dense_start") == "1";
  state.facts.normals_at_start = meta("normals_at_start") == "1";
  state.psnr_average = metadata_number<double>(file, "psnr_average", path);
  state.seconds = metadata_number<double>(file, "seconds", path);
  state.engine.model = take_model(file, path);
  for (const auto& [name, tensor] : file.tensors) {
    if (is_engine_array(name))
      state.engine.arrays[name.substr(kEnginePrefix.size())] = floats_of(tensor, path.string() + ": " + name);
  }
  for (const int64_t view : raw_values<int64_t>(file, "order.left", "I64", path)) {
    state.order.left.push_back(static_cast<int>(view));
  }
  const auto take_random = [&](const char* name, std::array<uint64_t, 4>& out) {
    const std::vector<uint64_t> values = raw_values<uint64_t>(file, name, "U64", path);
    if (values.size() != out.size()) throw_bad_input(path, name, "a random state has four words");
    std::copy(values.begin(), values.end(), out.begin());
  };
  take_random("order.random", state.order.random);
  take_random("density.random", state.density_random);
  state.depth_scales = raw_values<float>(file, "depth_scales", "F32", path);
  state.motions = take_motions(file, path);
  state.planes = take_planes(file, path);
  return state;
}

std::optional<TrainingState> read_latest_checkpoint(const fs::path& folder, const std::string& fingerprint,
                                                    CheckpointParts parts) {
  for (const fs::path& path : list_checkpoints(folder)) {
    try {
      return read_checkpoint(path, fingerprint, parts);
    } catch (const Error& error) {
      const std::string& field = error.details().field;
      if (field == kOtherScene || field == kSceneField || error.kind() != ErrorKind::kBadInput) throw;
      log_warning("checkpoint {} cannot be used ({}); taking the one before", path.string(), error.details().message);
    }
  }
  return std::nullopt;
}

}  // namespace aligngs
