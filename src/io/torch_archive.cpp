// Format: torch.save since PyTorch 1.6 (torch/serialization.py, torch/_utils.py): a ZIP archive
// with <name>/data.pkl and one <name>/data/<key> per storage.
#include "io/torch_archive.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/half.h"
#include "io/array_shape.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/pickle.h"
#include "io/zip_archive.h"

namespace aligngs {
namespace {

constexpr uint64_t kMaxPickleBytes = uint64_t(64)
                                     << 20;  // the pickle of the largest networks has a few MB
// A view may repeat elements (stride 0), so its size is not bounded by the file's: 16 MB as floats
// are allowed.
constexpr uint64_t kMaxRepeatedElements = uint64_t(1) << 22;
const char* const kRemedy = "save one tensor with torch.save(tensor.detach().cpu(), path)";
const char* const kTensor = "torch._utils _rebuild_tensor_v2";
const char* const kParameter = "torch._utils _rebuild_parameter";

struct StorageType {
  const char* global;
  const char* dtype;
  unsigned bytes;
  float (*convert)(const char* item, bool big_endian);
};

template <class T>
float convert_number(const char* item, bool big_endian) {
  return static_cast<float>(load_number<T>(item, big_endian));
}
float convert_half(const char* item, bool big_endian) {
  return half_to_float(load_number<uint16_t>(item, big_endian));
}
float convert_bfloat16(const char* item, bool big_endian) {
  return bfloat16_to_float(load_number<uint16_t>(item, big_endian));
}
float convert_bool(const char* item, bool) { return *item != 0 ? 1.0f : 0.0f; }

constexpr StorageType kStorageTypes[] = {
    {"torch FloatStorage", "float32", 4, convert_number<float>},
    {"torch HalfStorage", "float16", 2, convert_half},
    {"torch BFloat16Storage", "bfloat16", 2, convert_bfloat16},
    {"torch DoubleStorage", "float64", 8, convert_number<double>},
    {"torch LongStorage", "int64", 8, convert_number<int64_t>},
    {"torch IntStorage", "int32", 4, convert_number<int32_t>},
    {"torch ShortStorage", "int16", 2, convert_number<int16_t>},
    {"torch CharStorage", "int8", 1, convert_number<int8_t>},
    {"torch ByteStorage", "uint8", 1, convert_number<uint8_t>},
    {"torch BoolStorage", "bool", 1, convert_bool}};

std::vector<std::string> allowed_globals() {
  std::vector<std::string> globals = {kTensor, kParameter, "collections OrderedDict", "torch Size"};
  for (const StorageType& type : kStorageTypes) globals.emplace_back(type.global);
  return globals;
}

/// A view into a storage, as the pickle describes it; bounds are checked.
struct TensorView {
  const StorageType* type = nullptr;
  std::string key;  ///< of the storage
  uint64_t storage_elements = 0;
  uint64_t offset = 0;  ///< elements
  std::vector<int64_t> shape, strides;
  uint64_t count = 0;  ///< elements of the view
};

class TorchArchive {
 public:
  explicit TorchArchive(std::unique_ptr<ByteSource> source) : zip_(open(std::move(source))) {
    for (const ZipEntry& entry : zip_.entries()) {
      constexpr std::string_view kPickle = "/data.pkl";
      const std::string_view name = entry.name;
      if (name.size() > kPickle.size() && name.substr(name.size() - kPickle.size()) == kPickle &&
          name.find('/') == name.size() - kPickle.size()) {
        prefix_ = name.substr(0, name.size() - kPickle.size() + 1);
        pickle_.emplace(zip_.read(entry, kMaxPickleBytes), allowed_globals(), zip_.name());
        break;
      }
    }
    if (!pickle_) fail("", "the archive holds no data.pkl: it was not written by torch.save");
    if (const ZipEntry* order = zip_.find(prefix_ + "byteorder")) {
      constexpr uint64_t kLongestWord = 16;
      big_endian_ = zip_.read(*order, kLongestWord) == "big";
    }
  }

  TensorView only_tensor() const {
    const PickleValue& root = pickle_->root();
    if (is_tensor(root)) return view_of(root);
    std::vector<const PickleValue*> tensors;
    const bool dict = root.is(PickleKind::kDict);
    if (dict || root.is(PickleKind::kList) || root.is(PickleKind::kTuple)) {
      for (size_t i = dict ? 1 : 0; i < root.items.size(); i += dict ? 2 : 1) {
        if (is_tensor(*root.items[i])) tensors.push_back(root.items[i]);
      }
    }
    if (tensors.size() != 1)
      fail("", "it holds " + std::to_string(tensors.size()) + " tensors, one is needed");
    return view_of(*tensors[0]);
  }

  FloatArray read(const TensorView& view) const {
    const ZipEntry* entry = zip_.find(prefix_ + "data/" + view.key);
    if (!entry) fail("storage " + view.key, "missing");
    const uint64_t needed = view.storage_elements * view.type->bytes;
    if (entry->size != needed) {
      fail("storage " + view.key, "has " + std::to_string(entry->size) + " bytes, " +
                                      std::to_string(needed) + " are needed");
    }
    const std::string bytes = zip_.read(*entry);
    FloatArray array;
    array.shape = view.shape;
    array.data.reserve(view.count);
    for_each_strided(view.shape, view.strides, view.offset, [&](uint64_t i) {
      array.data.push_back(view.type->convert(bytes.data() + i * view.type->bytes, big_endian_));
    });
    return array;
  }

 private:
  static ZipArchive open(std::unique_ptr<ByteSource> source) {
    // Protocol 2 of the pickled magic number 0x1950a86a20f9469cfc6c, with which older files begin.
    constexpr std::string_view kLegacy("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19",
                                       14);
    if (source->size() >= kLegacy.size() && source->read(0, kLegacy.size()) == kLegacy) {
      throw_bad_input(source->name(), "", "written by a PyTorch older than 1.6",
                      "load and save it again with a newer one");
    }
    return ZipArchive(std::move(source));
  }

  [[noreturn]] void fail(const std::string& field, const std::string& message) const {
    throw_bad_input(zip_.name(), field, message, kRemedy);
  }

  static bool is_tensor(const PickleValue& value) {
    return value.is_object_of(kTensor) || value.is_object_of(kParameter);
  }

  int64_t integer(const PickleValue& value, const std::string& field) const {
    if (!value.is(PickleKind::kInt) || value.integer < 0)
      fail(field, "not a whole number of 0 or more");
    return value.integer;
  }
  std::vector<int64_t> integers(const PickleValue& value, const std::string& field) const {
    const PickleValue* tuple = &value;
    if (tuple->is_object_of("torch Size") && tuple->items[1]->items.size() == 1)
      tuple = tuple->items[1]->items[0];
    if (!tuple->is(PickleKind::kTuple)) fail(field, "not a tuple");
    std::vector<int64_t> out;
    for (const PickleValue* item : tuple->items) out.push_back(integer(*item, field));
    return out;
  }

  TensorView view_of(const PickleValue& object) const {
    const PickleValue* arguments = object.items[1];
    if (object.is_object_of(kParameter)) {  // (tensor, requires_grad, hooks)
      if (arguments->items.empty() || !arguments->items[0]->is_object_of(kTensor))
        fail("parameter", "holds no tensor");
      arguments = arguments->items[0]->items[1];
    }
    // (storage, offset, size, stride, requires_grad, hooks[, metadata])
    if (arguments->items.size() < 4) fail("tensor", "too few arguments");
    TensorView view;
    read_storage(*arguments->items[0], view);
    view.offset = uint64_t(integer(*arguments->items[1], "storage offset"));
    view.shape = integers(*arguments->items[2], "size");
    view.strides = integers(*arguments->items[3], "stride");
    if (view.shape.size() != view.strides.size())
      fail("stride", "size and stride have different lengths");
    view.count = element_count(view.shape, sizeof(double), zip_.name(), "size");
    require_within_storage(view);
    return view;
  }

  /// ('storage', type, key, location, number of elements)
  void read_storage(const PickleValue& value, TensorView& view) const {
    const PickleValue* id = value.is(PickleKind::kPersistentId) ? value.items[0] : nullptr;
    if (!id || !id->is(PickleKind::kTuple) || id->items.size() < 5 ||
        id->items[0]->text != "storage") {
      fail("storage", "not in the form that torch.save writes");
    }
    const PickleValue &type = *id->items[1], &key = *id->items[2];
    for (const StorageType& known : kStorageTypes) {
      if (type.is(PickleKind::kGlobal) && type.text == known.global) view.type = &known;
    }
    if (!view.type || !key.is(PickleKind::kString)) fail("storage", "unknown storage type");
    view.key = key.text;
    view.storage_elements = uint64_t(integer(*id->items[4], "storage size"));
    element_count({id->items[4]->integer}, view.type->bytes, zip_.name(), "storage size");
  }

  void require_within_storage(const TensorView& view) const {
    if (view.count == 0) return;
    uint64_t last = view.offset;  // the furthest element; all strides are >= 0
    bool within = last < view.storage_elements;
    for (size_t i = 0; i < view.shape.size() && within; ++i) {
      const uint64_t steps = uint64_t(view.shape[i] - 1), stride = uint64_t(view.strides[i]);
      within = stride == 0 || steps <= (view.storage_elements - 1 - last) / stride;
      if (within) last += steps * stride;
    }
    if (!within) {
      fail("size", shape_text(view.shape) + " with strides " + shape_text(view.strides) +
                       " reaches beyond the storage of " + std::to_string(view.storage_elements) +
                       " elements");
    }
    if (view.count > std::max(view.storage_elements, kMaxRepeatedElements)) {
      fail("size", shape_text(view.shape) + " repeats a storage of " +
                       std::to_string(view.storage_elements) +
                       " elements; call contiguous() before saving");
    }
  }

  ZipArchive zip_;
  std::string prefix_;
  bool big_endian_ = false;
  std::optional<Pickle> pickle_;
};

}  // namespace

FloatArray read_torch_tensor(const std::filesystem::path& path) {
  const TorchArchive archive(file_source(path));
  return archive.read(archive.only_tensor());
}

ArrayHeader read_torch_tensor_header(const std::filesystem::path& path) {
  const TensorView view = TorchArchive(file_source(path)).only_tensor();
  return {view.shape, view.type->dtype};
}

FloatArray decode_torch_tensor(const std::string& bytes,
                               const std::filesystem::path& name_for_errors) {
  const TorchArchive archive(memory_source(bytes, name_for_errors));
  return archive.read(archive.only_tensor());
}

void write_torch_tensor(const std::filesystem::path& path, const std::vector<int64_t>& shape,
                        const float* data) {
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
  for (size_t i = shape.size(); i-- > 1;)
    strides[i - 1] = strides[i] * std::max<int64_t>(shape[i], 1);
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
