// Format: torch/_utils.py (_rebuild_tensor_v2) and torch/serialization.py (persistent_id).
#include "io/torch_tensors.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "core/half.h"
#include "io/array_shape.h"
#include "io/byte_reader.h"

namespace aligngs {
namespace {

// A view may repeat elements (stride 0), so its size is not bounded by the file's: 16 MB as floats
// are allowed.
constexpr uint64_t kMaxRepeatedElements = uint64_t(1) << 22;
const char* const kTorchRemedy = "save tensors with torch.save(tensor.detach().cpu(), path)";
const char* const kTensor = "torch._utils _rebuild_tensor_v2";
const char* const kParameter = "torch._utils _rebuild_parameter";

template <class T>
void convert_numbers(const char* items, uint64_t count, bool big_endian, float* out) {
  for (uint64_t i = 0; i < count; ++i) out[i] = static_cast<float>(load_number<T>(items + i * sizeof(T), big_endian));
}
template <float (*kConvert)(uint16_t)>
void convert_halves(const char* items, uint64_t count, bool big_endian, float* out) {
  for (uint64_t i = 0; i < count; ++i) out[i] = kConvert(load_number<uint16_t>(items + 2 * i, big_endian));
}
void convert_bools(const char* items, uint64_t count, bool, float* out) {
  for (uint64_t i = 0; i < count; ++i) out[i] = items[i] != 0 ? 1.0f : 0.0f;
}

constexpr TorchStorageType kStorageTypes[] = {
    {"torch FloatStorage", "float32", 4, convert_numbers<float>},
    {"torch HalfStorage", "float16", 2, convert_halves<half_to_float>},
    {"torch BFloat16Storage", "bfloat16", 2, convert_halves<bfloat16_to_float>},
    {"torch DoubleStorage", "float64", 8, convert_numbers<double>},
    {"torch LongStorage", "int64", 8, convert_numbers<int64_t>},
    {"torch IntStorage", "int32", 4, convert_numbers<int32_t>},
    {"torch ShortStorage", "int16", 2, convert_numbers<int16_t>},
    {"torch CharStorage", "int8", 1, convert_numbers<int8_t>},
    {"torch ByteStorage", "uint8", 1, convert_numbers<uint8_t>},
    {"torch BoolStorage", "bool", 1, convert_bools}};

[[noreturn]] void fail(const std::filesystem::path& name, const std::string& field, const std::string& message) {
  throw_bad_input(name, field, message, kTorchRemedy);
}

int64_t integer(const PickleValue& value, const std::filesystem::path& name, const std::string& field) {
  if (!value.is(PickleKind::kInt) || value.integer < 0) fail(name, field, "not a whole number of 0 or more");
  return value.integer;
}

std::vector<int64_t> integers(const PickleValue& value, const std::filesystem::path& name, const std::string& field) {
  const PickleValue* tuple = &value;
  if (tuple->is_object_of("torch Size") && tuple->items[1]->items.size() == 1) tuple = tuple->items[1]->items[0];
  if (!tuple->is(PickleKind::kTuple)) fail(name, field, "not a tuple");
  std::vector<int64_t> out;
  for (const PickleValue* item : tuple->items) out.push_back(integer(*item, name, field));
  return out;
}

void require_within_storage(const TorchView& view, const std::filesystem::path& name) {
  if (view.count == 0) return;
  const uint64_t elements = view.storage.elements;
  uint64_t last = view.offset;  // the furthest element; all strides are >= 0
  bool within = last < elements;
  for (size_t i = 0; i < view.shape.size() && within; ++i) {
    const uint64_t steps = uint64_t(view.shape[i] - 1), stride = uint64_t(view.strides[i]);
    within = stride == 0 || steps <= (elements - 1 - last) / stride;
    if (within) last += steps * stride;
  }
  if (!within) {
    fail(name, "size",
         shape_text(view.shape) + " with strides " + shape_text(view.strides) + " reaches beyond the storage of " +
             std::to_string(elements) + " elements");
  }
  if (view.count > std::max(elements, kMaxRepeatedElements)) {
    fail(name, "size",
         shape_text(view.shape) + " repeats a storage of " + std::to_string(elements) +
             " elements; call contiguous() before saving");
  }
}

/// Whether the elements follow each other in the storage, in C order.
bool in_order(const TorchView& view) {
  uint64_t step = 1;
  for (size_t i = view.shape.size(); i-- > 0;) {
    if (view.shape[i] == 1) continue;
    if (uint64_t(view.strides[i]) != step) return false;
    step *= uint64_t(view.shape[i]);
  }
  return true;
}

}  // namespace

std::vector<std::string> torch_globals() {
  std::vector<std::string> globals = {kTensor,
                                      kParameter,
                                      "collections OrderedDict",
                                      "torch Size",
                                      "numpy dtype",
                                      "numpy ndarray",
                                      "numpy.core.multiarray scalar",
                                      "numpy.core.multiarray _reconstruct",
                                      "numpy._core.multiarray scalar",
                                      "numpy._core.multiarray _reconstruct",
                                      "_codecs encode"};
  for (const TorchStorageType& type : kStorageTypes) globals.emplace_back(type.global);
  return globals;
}

bool is_torch_tensor(const PickleValue& value) { return value.is_object_of(kTensor) || value.is_object_of(kParameter); }

TorchStorage torch_storage(const PickleValue& value, const std::filesystem::path& name) {
  // ('storage', type, key, location, number of elements[, None | (view key, offset, size)])
  const PickleValue* id = value.is(PickleKind::kPersistentId) ? value.items[0] : nullptr;
  if (!id || !id->is(PickleKind::kTuple) || id->items.size() < 5 || id->items[0]->text != "storage") {
    fail(name, "storage", "not in the form that torch.save writes");
  }
  const PickleValue &type = *id->items[1], &key = *id->items[2];
  TorchStorage storage;
  for (const TorchStorageType& known : kStorageTypes) {
    if (type.is(PickleKind::kGlobal) && type.text == known.global) storage.type = &known;
  }
  if (!storage.type || !key.is(PickleKind::kString)) fail(name, "storage", "unknown storage type");
  storage.key = key.text;
  storage.elements = uint64_t(integer(*id->items[4], name, "storage size"));
  element_count({id->items[4]->integer}, storage.type->bytes, name, "storage size");
  if (id->items.size() > 5 && !id->items[5]->is(PickleKind::kNone)) {
    const PickleValue& view = *id->items[5];
    if (!view.is(PickleKind::kTuple) || view.items.size() != 3)
      fail(name, "storage", "a view of a storage has three entries");
    storage.view_offset = uint64_t(integer(*view.items[1], name, "offset of a storage view"));
  }
  return storage;
}

TorchView torch_view(const PickleValue& tensor, const std::filesystem::path& name) {
  if (!is_torch_tensor(tensor)) fail(name, "tensor", "not a tensor");
  const PickleValue* arguments = tensor.items[1];
  if (tensor.is_object_of(kParameter)) {  // (tensor, requires_grad, hooks)
    if (arguments->items.empty() || !arguments->items[0]->is_object_of(kTensor))
      fail(name, "parameter", "holds no tensor");
    arguments = arguments->items[0]->items[1];
  }
  // (storage, offset, size, stride, requires_grad, hooks[, metadata])
  if (arguments->items.size() < 4) fail(name, "tensor", "too few arguments");
  TorchView view;
  view.storage = torch_storage(*arguments->items[0], name);
  view.offset = uint64_t(integer(*arguments->items[1], name, "storage offset"));
  if (view.storage.view_offset > view.storage.elements) fail(name, "offset of a storage view", "beyond the storage");
  view.offset += view.storage.view_offset;
  view.shape = integers(*arguments->items[2], name, "size");
  view.strides = integers(*arguments->items[3], name, "stride");
  if (view.shape.size() != view.strides.size()) fail(name, "stride", "size and stride have different lengths");
  view.count = element_count(view.shape, sizeof(double), name, "size");
  require_within_storage(view, name);
  return view;
}

FloatArray torch_values(const TorchView& view, const std::string& storage, bool big_endian) {
  const TorchStorageType& type = *view.storage.type;
  FloatArray array;
  array.shape = view.shape;
  array.data.resize(view.count);
  if (view.count == 0) return array;  // its offset may lie anywhere
  float* out = array.data.data();
  if (in_order(view)) {
    type.convert(storage.data() + view.offset * type.bytes, view.count, big_endian, out);
    return array;
  }
  for_each_strided(view.shape, view.strides, view.offset,
                   [&](uint64_t i) { type.convert(storage.data() + i * type.bytes, 1, big_endian, out++); });
  return array;
}

}  // namespace aligngs
