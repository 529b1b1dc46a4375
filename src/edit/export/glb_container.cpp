#include "edit/export/glb_container.h"

#include <algorithm>

#include "core/error.h"
#include "core/version.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

// glTF 2.0, section 3.6 and 4.4: component types, buffer view targets, chunk names.
constexpr int kFloat = 5126, kUnsignedByte = 5121, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr int kVertices = 34962, kIndices = 34963;
constexpr uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};

void pad(std::string& bytes, char with) {
  while (bytes.size() % 4) bytes += with;
}

}  // namespace

GlbContainer::GlbContainer() {
  json_["asset"] = {{"version", "2.0"}, {"generator", std::string("aligngs ") + version()}};
  json_["scene"] = 0;
  for (const char* array : {"scenes", "nodes", "meshes", "materials", "accessors", "bufferViews"}) {
    json_[array] = nlohmann::ordered_json::array();
  }
}

int GlbContainer::add(const char* array, nlohmann::ordered_json value) {
  json_[array].push_back(std::move(value));
  return static_cast<int>(json_[array].size()) - 1;
}

size_t GlbContainer::add_bytes(const void* data, size_t bytes) {
  const size_t place = bytes_;
  std::string piece;
  piece.reserve(bytes + 3);
  piece.assign(static_cast<const char*>(data), bytes);
  pad(piece, '\0');
  bytes_ += piece.size();
  buffer_.push_back(std::move(piece));
  return place;
}

int GlbContainer::add_accessor(const void* data, size_t bytes, size_t count, int component, const char* type,
                               bool normalized, int target) {
  const size_t place = add_bytes(data, bytes);
  const int view =
      add("bufferViews", {{"buffer", 0}, {"byteOffset", place}, {"byteLength", bytes}, {"target", target}});
  nlohmann::ordered_json accessor = {
      {"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
  if (normalized) accessor["normalized"] = true;
  return add("accessors", accessor);
}

int GlbContainer::add_floats(const std::vector<float>& values, int width, bool bounds) {
  const size_t w = static_cast<size_t>(width);
  const int id = add_accessor(values.data(), values.size() * sizeof(float), values.size() / w, kFloat, kTypes[width],
                              false, kVertices);
  if (bounds) {
    std::vector<float> low(values.begin(), values.begin() + width), high = low;
    for (size_t i = 0; i < values.size(); ++i) {
      low[i % w] = std::min(low[i % w], values[i]);
      high[i % w] = std::max(high[i % w], values[i]);
    }
    json_["accessors"][static_cast<size_t>(id)]["min"] = low;
    json_["accessors"][static_cast<size_t>(id)]["max"] = high;
  }
  return id;
}

int GlbContainer::add_colors(const std::vector<uint8_t>& rgba) {
  return add_accessor(rgba.data(), rgba.size(), rgba.size() / 4, kUnsignedByte, "VEC4", true, kVertices);
}

int GlbContainer::add_colors16(const std::vector<uint16_t>& rgba) {
  return add_accessor(rgba.data(), 2 * rgba.size(), rgba.size() / 4, kUnsignedShort, "VEC4", true, kVertices);
}

int GlbContainer::add_indices(const std::vector<uint32_t>& indices) {
  return add_accessor(indices.data(), 4 * indices.size(), indices.size(), kUnsignedInt, "SCALAR", false, kIndices);
}

int GlbContainer::add_texture(const std::vector<uint8_t>& file, const char* type) {
  constexpr int kLinear = 9729, kLinearMipmaps = 9987, kClampToEdge = 33071;
  const size_t place = add_bytes(file.data(), file.size());
  const int view = add("bufferViews", {{"buffer", 0}, {"byteOffset", place}, {"byteLength", file.size()}});
  const int image = add("images", {{"name", "texture"}, {"bufferView", view}, {"mimeType", type}});
  const int sampler =
      add("samplers",
          {{"magFilter", kLinear}, {"minFilter", kLinearMipmaps}, {"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}});
  return add("textures", {{"sampler", sampler}, {"source", image}});
}

void GlbContainer::use_extension(const std::string& name) {
  nlohmann::ordered_json& used = json_["extensionsUsed"];
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

void GlbContainer::write(const std::filesystem::path& path) {
  json_["buffers"] = nlohmann::ordered_json::array({{{"byteLength", bytes_}}});
  // Empty arrays are not allowed.
  for (const char* array : {"materials", "meshes", "accessors", "bufferViews", "nodes"}) {
    if (json_.contains(array) && json_[array].empty()) json_.erase(array);
  }
  if (bytes_ == 0) json_.erase("buffers");
  std::string text = json_line(json_);
  pad(text, ' ');
  const uint64_t total = 12 + 8 + text.size() + (bytes_ == 0 ? 0 : 8 + bytes_);
  if (total > UINT32_MAX) {
    throw Error({ErrorKind::kFailed, "a GLB file holds at most 4 GiB", path, {}, "export the PLY or SPZ instead"});
  }
  std::string head;
  append_little(head, kMagic);
  append_little(head, kVersion);
  append_little(head, static_cast<uint32_t>(total));
  append_little(head, static_cast<uint32_t>(text.size()));
  append_little(head, kJsonChunk);
  AtomicFile file(path);
  file.write(head);
  file.write(text);
  if (bytes_ > 0) {
    std::string chunk;
    append_little(chunk, static_cast<uint32_t>(bytes_));
    append_little(chunk, kBinaryChunk);
    file.write(chunk);
    for (const std::string& piece : buffer_) file.write(piece);
  }
  file.commit();
}

}  // namespace aligngs
