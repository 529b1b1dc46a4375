#include "nn/weights.h"

#include <cmath>

#include "core/error.h"
#include "core/stop_signal.h"
#include "io/array_shape.h"

namespace aligngs::nn {
namespace {

const char* const kRemedy = "these are not the weights of this network, or they are damaged";

}  // namespace

Weights::Weights() : table_(std::make_shared<Table>()) {}

Weights::Weights(std::shared_ptr<const WeightFile> file) : Weights() {
  add_all(file, [](const std::string& name) { return name; });
}

void Weights::add(const std::string& name, const std::shared_ptr<const WeightFile>& file,
                  const std::vector<std::string>& stored) {
  std::vector<Part> parts;
  for (const std::string& part : stored) parts.push_back({file, part});
  (*table_)[prefix_ + name] = std::move(parts);
}

void Weights::add_all(const std::shared_ptr<const WeightFile>& file,
                      const std::function<std::string(const std::string&)>& rename) {
  for (const auto& tensor : file->tensors()) {
    const std::string name = rename(tensor.first);
    if (!name.empty()) add(name, file, {tensor.first});
  }
}

Weights Weights::sub(const std::string& prefix) const {
  Weights below = *this;
  below.prefix_ += prefix;
  return below;
}

bool Weights::has(const std::string& name) const { return table_->count(prefix_ + name) > 0; }

const std::vector<Weights::Part>& Weights::parts(const std::string& name) const {
  const auto found = table_->find(prefix_ + name);
  if (found == table_->end()) {
    const std::filesystem::path file = table_->empty() ? "" : table_->begin()->second.front().file->name();
    throw Error({ErrorKind::kWeights, "the tensor is missing", file, prefix_ + name, kRemedy});
  }
  return found->second;
}

Shape Weights::shape(const std::string& name) const {
  const std::vector<Part>& stored = parts(name);
  const auto shape_of = [](const Part& part) {
    const auto found = part.file->tensors().find(part.stored);
    if (found == part.file->tensors().end()) {
      throw Error({ErrorKind::kWeights, "the tensor is missing", part.file->name(), part.stored, kRemedy});
    }
    return found->second.shape;
  };
  Shape shape = shape_of(stored.front());
  for (size_t i = 1; i < stored.size(); ++i) {
    const Shape next = shape_of(stored[i]);
    if (next.empty() || Shape(next.begin() + 1, next.end()) != Shape(shape.begin() + 1, shape.end())) {
      throw Error({ErrorKind::kWeights, "shape " + shape_text(next) + " does not continue " + shape_text(shape),
                   stored[i].file->name(), stored[i].stored, kRemedy});
    }
    shape[0] += next[0];
  }
  return shape;
}

int64_t Weights::dimension(const std::string& name, size_t axis) const {
  const Shape found = shape(name);
  if (axis >= found.size()) {
    throw Error({ErrorKind::kWeights,
                 "shape " + shape_text(found) + " has fewer than " + std::to_string(axis + 1) + " dimensions",
                 parts(name).front().file->name(), prefix_ + name, kRemedy});
  }
  return found[axis];
}

std::vector<float> Weights::load(const std::string& name, const Shape& expected) const {
  stop_if_requested();
  const Shape found = shape(name);
  const std::vector<Part>& stored = parts(name);
  const auto fail = [&](const std::string& message) {
    throw Error({ErrorKind::kWeights, message, stored.front().file->name(), prefix_ + name, kRemedy});
  };
  if (found != expected) fail("shape " + shape_text(expected) + " expected, " + shape_text(found) + " found");
  std::vector<float> values = stored.front().file->read(stored.front().stored);
  for (size_t i = 1; i < stored.size(); ++i) {
    const std::vector<float> more = stored[i].file->read(stored[i].stored);
    values.insert(values.end(), more.begin(), more.end());
  }
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) fail("value " + std::to_string(i) + " is not finite");
  }
  return values;
}

int Weights::count(const std::string& prefix) const {
  int n = 0;
  while (true) {
    const std::string start = prefix_ + prefix + std::to_string(n) + ".";
    const auto found = table_->lower_bound(start);
    if (found == table_->end() || found->first.compare(0, start.size(), start) != 0) return n;
    ++n;
  }
}

std::vector<std::string> Weights::names() const {
  std::vector<std::string> names;
  for (auto i = table_->lower_bound(prefix_); i != table_->end() && i->first.compare(0, prefix_.size(), prefix_) == 0;
       ++i) {
    names.push_back(i->first.substr(prefix_.size()));
  }
  return names;
}

}  // namespace aligngs::nn
