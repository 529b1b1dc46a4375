// Format: torch.save since PyTorch 1.6 (torch/serialization.py, torch/_utils.py): a ZIP archive
// with <name>/data.pkl and one <name>/data/<key> per storage.
#include "io/torch_archive.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "io/array_shape.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/torch_container.h"
#include "io/zip_writer.h"

namespace aligngs {
namespace {

TorchView only_tensor(const TorchContainer& file) {
  const PickleValue& root = file.root();
  if (is_torch_tensor(root)) return torch_view(root, file.name());
  std::vector<const PickleValue*> tensors;
  const bool dict = root.is(PickleKind::kDict);
  if (dict || root.is(PickleKind::kList) || root.is(PickleKind::kTuple)) {
    for (size_t i = dict ? 1 : 0; i < root.items.size(); i += dict ? 2 : 1) {
      if (is_torch_tensor(*root.items[i])) tensors.push_back(root.items[i]);
    }
  }
  if (tensors.size() != 1) {
    throw_bad_input(file.name(), "", "it holds " + std::to_string(tensors.size()) + " tensors, one is needed",
                    "save one tensor with torch.save(tensor.detach().cpu(), path)");
  }
  return torch_view(*tensors[0], file.name());
}

}  // namespace

FloatArray read_torch_tensor(const std::filesystem::path& path) {
  const TorchContainer file(file_source(path));
  return file.read(only_tensor(file));
}

ArrayHeader read_torch_tensor_header(const std::filesystem::path& path) {
  const TorchView view = only_tensor(TorchContainer(file_source(path)));
  return {view.shape, view.storage.type->dtype};
}

FloatArray decode_torch_tensor(const std::string& bytes, const std::filesystem::path& name_for_errors) {
  const TorchContainer file(memory_source(bytes, name_for_errors));
  return file.read(only_tensor(file));
}

void write_torch_tensor(const std::filesystem::path& path, const std::vector<int64_t>& shape, const float* data) {
  const uint64_t count = element_count(shape, sizeof(float), path, "shape");
  std::string pickle;
  const auto text = [&](std::string_view s) {
    pickle += 'X';
    append_little(pickle, static_cast<uint32_t>(s.size()));
    pickle += s;
  };
  const auto integer = [&](int64_t value) {
    pickle += "\x8a\x08";  // LONG1 of 8 bytes
    append_little(pickle, value);
  };
  pickle += "\x80\x02";
  pickle += "ctorch._utils\n_rebuild_tensor_v2\n((";
  text("storage");
  pickle += "ctorch\nFloatStorage\n";
  text("0");
  text("cpu");
  integer(static_cast<int64_t>(count));
  pickle += "tQ";
  integer(0);
  std::vector<int64_t> strides(shape.size(), 1);
  for (size_t i = shape.size(); i-- > 1;) strides[i - 1] = strides[i] * std::max<int64_t>(shape[i], 1);
  for (const std::vector<int64_t>* tuple : {&shape, &std::as_const(strides)}) {
    pickle += '(';
    for (const int64_t value : *tuple) integer(value);
    pickle += 't';
  }
  pickle +=
      "\x89"
      "ccollections\nOrderedDict\n)RtR.";

  std::string storage;
  storage.reserve(count * sizeof(float));
  for (uint64_t i = 0; i < count; ++i) append_little(storage, data[i]);
  write_file_atomically(path, make_stored_zip({{"archive/data.pkl", pickle},
                                               {"archive/byteorder", "little"},
                                               {"archive/data/0", storage},
                                               {"archive/version", "3\n"}}));
}

}  // namespace aligngs
