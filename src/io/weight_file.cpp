#include "io/weight_file.h"

#include <algorithm>

#include "core/error.h"
#include "io/byte_source.h"
#include "io/foreign_content.h"
#include "io/safetensors.h"
#include "io/torch_container.h"

namespace aligngs {
namespace {

[[noreturn]] void throw_unknown(const std::filesystem::path& file, const std::string& tensor) {
  throw_bad_input(file, tensor, "the file holds no such tensor");
}

class SafetensorsWeights : public WeightFile {
 public:
  explicit SafetensorsWeights(std::unique_ptr<ByteSource> source)
      : WeightFile(source->name()), source_(std::move(source)), directory_(read_safetensors_directory(*source_)) {
    for (const auto& [key, place] : directory_.tensors) tensors_[key] = {place.dtype, place.shape};
  }

  std::vector<float> read(const std::string& tensor) const override {
    const auto found = directory_.tensors.find(tensor);
    if (found == directory_.tensors.end()) throw_unknown(name(), tensor);
    return read_floats(*source_, found->second, tensor);
  }

 private:
  std::unique_ptr<ByteSource> source_;
  TensorDirectory directory_;
};

class TorchWeights : public WeightFile {
 public:
  explicit TorchWeights(std::unique_ptr<ByteSource> source) : WeightFile(source->name()), file_(std::move(source)) {
    const PickleValue& dict = state_dict();
    for (size_t i = 0; i + 1 < dict.items.size(); i += 2) {
      const PickleValue &key = *dict.items[i], &value = *dict.items[i + 1];
      if (!key.is(PickleKind::kString) || !is_torch_tensor(value)) continue;
      const TorchView view = torch_view(value, name());
      tensors_[key.text] = {view.storage.type->dtype, view.shape};
      views_[key.text] = view;
    }
  }

  std::vector<float> read(const std::string& tensor) const override {
    const auto found = views_.find(tensor);
    if (found == views_.end()) throw_unknown(name(), tensor);
    return file_.read(found->second).data;
  }

 private:
  static bool holds_tensors(const PickleValue* dict) {
    if (!dict || !dict->is(PickleKind::kDict)) return false;
    for (size_t i = 1; i < dict->items.size(); i += 2) {
      if (is_torch_tensor(*dict->items[i])) return true;
    }
    return false;
  }

  const PickleValue& state_dict() const {
    const PickleValue* root = &file_.root();
    for (const PickleValue* dict : {root, root->find("state_dict"), root->find("model")}) {
      if (holds_tensors(dict)) return *dict;
    }
    throw_bad_input(name(), "", "it holds no named tensors",
                    "a state dict is needed: torch.save(network.state_dict(), path)");
  }

  TorchContainer file_;
  std::map<std::string, TorchView> views_;
};

std::shared_ptr<const WeightFile> from_source(std::unique_ptr<ByteSource> source) {
  constexpr uint64_t kMagicBytes = 32;
  const std::string first = source->read(0, std::min(source->size(), kMagicBytes));
  refuse_foreign_content(first, source->name());
  const bool zip = first.substr(0, 4) == "PK\x03\x04";
  if (zip || TorchContainer::is_legacy(first)) return std::make_shared<TorchWeights>(std::move(source));
  return std::make_shared<SafetensorsWeights>(std::move(source));
}

}  // namespace

std::shared_ptr<const WeightFile> WeightFile::open(const std::filesystem::path& path) {
  return from_source(file_source(path));
}

std::shared_ptr<const WeightFile> WeightFile::from_memory(std::string_view bytes,
                                                          const std::filesystem::path& name_for_errors) {
  return from_source(memory_source(bytes, name_for_errors));
}

}  // namespace aligngs
