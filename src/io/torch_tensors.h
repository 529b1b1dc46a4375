// Tensors as torch.save pickles them: views into typed storages.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/npy.h"
#include "io/pickle.h"

namespace aligngs {

struct TorchStorageType {
  const char* global;  ///< "torch FloatStorage"
  const char* dtype;   ///< "float32"
  unsigned bytes;      ///< of one element
  void (*convert)(const char* elements, uint64_t count, bool big_endian, float* out);
};

/// A storage that a pickle refers to; its elements lie elsewhere in the file.
struct TorchStorage {
  const TorchStorageType* type = nullptr;
  std::string key;
  uint64_t elements = 0;
  uint64_t view_offset = 0;  ///< elements; of a storage that is part of another (legacy files)
};

/// A view into a storage, as the pickle describes it; bounds are checked.
struct TorchView {
  TorchStorage storage;
  uint64_t offset = 0;  ///< elements
  std::vector<int64_t> shape, strides;
  uint64_t count = 0;  ///< elements of the view
};

/// The globals that a file of tensors may name. Nothing is called; NumPy's are there because
/// checkpoints keep learning rates and the like beside their tensors.
std::vector<std::string> torch_globals();

bool is_torch_tensor(const PickleValue& value);
/// Error{kBadInput} unless the value is a tensor whose view lies within its storage.
TorchView torch_view(const PickleValue& tensor, const std::filesystem::path& name);
/// The storage behind a persistent id. Error{kBadInput} for anything else.
TorchStorage torch_storage(const PickleValue& persistent_id, const std::filesystem::path& name);
/// The values of a view; `storage` has at least elements * type->bytes bytes.
FloatArray torch_values(const TorchView& view, const std::string& storage, bool big_endian);

}  // namespace aligngs
