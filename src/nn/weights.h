// Named weights of a network, checked as they are read.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/weight_file.h"

namespace aligngs::nn {

using Shape = std::vector<int64_t>;

/// A view of the tensors whose names begin with a prefix. Several files, and files with other names
/// for the same tensors, become one by add(). Everything missing, of another shape or not finite is
/// Error{kWeights} naming file, tensor, expected and found shape.
class Weights {
 public:
  Weights();
  /// All tensors of a file under the names they have there.
  explicit Weights(std::shared_ptr<const WeightFile> file);
  static Weights open(const std::filesystem::path& path) { return Weights(WeightFile::open(path)); }

  /// Tensor `name` is the stored tensors one after the other along their first axis.
  void add(const std::string& name, const std::shared_ptr<const WeightFile>& file,
           const std::vector<std::string>& stored);
  /// Every tensor of a file, under the name that `rename` gives; left out where it gives "".
  void add_all(const std::shared_ptr<const WeightFile>& file,
               const std::function<std::string(const std::string&)>& rename);

  /// The same tensors seen from below: sub("blocks.0.") knows "norm1.weight".
  Weights sub(const std::string& prefix) const;

  bool has(const std::string& name) const;
  /// The shape as stored. Error{kWeights} when missing.
  Shape shape(const std::string& name) const;
  /// shape()[axis]; Error{kWeights} also when there is no such axis.
  int64_t dimension(const std::string& name, size_t axis) const;
  /// The values, float32. A stop point (core/stop_signal.h): loading a large network takes many seconds.
  std::vector<float> load(const std::string& name, const Shape& expected) const;
  /// How many of prefix0, prefix1, ... begin the name of a tensor: count("blocks.").
  int count(const std::string& prefix) const;
  /// Names under the prefix, without it.
  std::vector<std::string> names() const;

 private:
  struct Part {
    std::shared_ptr<const WeightFile> file;
    std::string stored;
  };
  using Table = std::map<std::string, std::vector<Part>>;
  const std::vector<Part>& parts(const std::string& name) const;

  std::shared_ptr<Table> table_;
  std::string prefix_;
};

}  // namespace aligngs::nn
