// Building a binary glTF 2.0 file: accessors appended to one buffer, the JSON in front.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace aligngs {

/// One glTF asset under construction. Indices that the functions return are those of the glTF arrays.
class GlbContainer {
 public:
  GlbContainer();

  nlohmann::ordered_json& json() { return json_; }
  /// An accessor of 32-bit floats; `width` 1 to 4 values per element. `bounds` adds min and max (POSITION needs them).
  int add_floats(const std::vector<float>& values, int width, bool bounds = false);
  /// Normalised unsigned bytes, four per element (COLOR_0).
  int add_colors(const std::vector<uint8_t>& rgba);
  /// Unsigned shorts as four normalised values per element: linear colours need more than 8 bits.
  int add_colors16(const std::vector<uint16_t>& rgba);
  int add_indices(const std::vector<uint32_t>& indices);
  /// A picture in the file; `type` as "image/jpeg". Returns the texture.
  int add_texture(const std::vector<uint8_t>& file, const char* type);
  /// Appends to json()[array] and returns the index.
  int add(const char* array, nlohmann::ordered_json value);

  /// Names an extension in extensionsUsed, once.
  void use_extension(const std::string& name);

  /// Atomic. Error{kFailed} above 4 GiB, which the container cannot hold.
  void write(const std::filesystem::path& path);

 private:
  int add_accessor(const void* data, size_t bytes, size_t count, int component, const char* type, bool normalized,
                   int target);

  /// Begins a buffer view at a multiple of four bytes (glTF 2.0, section 3.6.2.4); returns its place in the buffer.
  size_t add_bytes(const void* data, size_t bytes);

  nlohmann::ordered_json json_;
  std::vector<std::string> buffer_;  ///< the pieces of the buffer: one text would be copied each time that it grows
  size_t bytes_ = 0;                 ///< of all pieces
};

}  // namespace aligngs
