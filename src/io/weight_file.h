// Files of named tensors (network weights), whatever their format; tensors are read one at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

struct WeightInfo {
  std::string dtype;  ///< in the words of the file: "F16", "float16", ...
  std::vector<int64_t> shape;
};

class WeightFile {
 public:
  virtual ~WeightFile() = default;

  /// safetensors, or torch.save in either layout, distinguished by their first bytes. A training
  /// checkpoint lists its state dict alone (the dict itself, or its entry `state_dict`, else
  /// `model`); optimiser state is never read. Error{kBadInput} when the file is none of these, is
  /// damaged, or holds no named tensor.
  static std::shared_ptr<const WeightFile> open(const std::filesystem::path& path);
  /// `bytes` must outlive the result.
  static std::shared_ptr<const WeightFile> from_memory(std::string_view bytes,
                                                       const std::filesystem::path& name_for_errors);

  const std::map<std::string, WeightInfo>& tensors() const { return tensors_; }
  const std::filesystem::path& name() const { return name_; }
  /// The values in C order, converted to float. `tensor` is one of tensors().
  virtual std::vector<float> read(const std::string& tensor) const = 0;

 protected:
  explicit WeightFile(std::filesystem::path name) : name_(std::move(name)) {}
  std::map<std::string, WeightInfo> tensors_;

 private:
  std::filesystem::path name_;
};

}  // namespace aligngs
