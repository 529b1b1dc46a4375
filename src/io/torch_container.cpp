// Format: torch/serialization.py, _save and _legacy_save.
#include "io/torch_container.h"

#include <algorithm>

#include "core/error.h"
#include "io/byte_reader.h"
#include "io/damaged_file.h"

namespace aligngs {
namespace {

constexpr uint64_t kMaxPickleBytes = uint64_t(64) << 20;  // the largest networks have a few MB

}  // namespace

TorchContainer::TorchContainer(std::unique_ptr<ByteSource> source) : name_(source->name()) {
  constexpr uint64_t kMagicBytes = 16;
  const std::string first = source->read(0, std::min(source->size(), kMagicBytes));
  if (is_legacy(first)) {
    open_legacy(std::move(source));
  } else {
    open_zip(std::move(source));
  }
}

bool TorchContainer::is_legacy(std::string_view first_bytes) {
  // Protocol 2 of the pickled magic number 0x1950a86a20f9469cfc6c.
  constexpr std::string_view kMagic("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19", 14);
  return first_bytes.substr(0, kMagic.size()) == kMagic;
}

void TorchContainer::open_zip(std::unique_ptr<ByteSource> source) {
  zip_.emplace(std::move(source));
  for (const ZipEntry& entry : zip_->entries()) {
    constexpr std::string_view kPickle = "/data.pkl";
    const std::string_view entry_name = entry.name;
    if (entry_name.size() > kPickle.size() && entry_name.substr(entry_name.size() - kPickle.size()) == kPickle &&
        entry_name.find('/') == entry_name.size() - kPickle.size()) {
      prefix_ = entry_name.substr(0, entry_name.size() - kPickle.size() + 1);
      pickle_.emplace(zip_->read(entry, kMaxPickleBytes), torch_globals(), name_);
      break;
    }
  }
  if (!pickle_) {
    throw_bad_input(name_, "", "the archive holds no data.pkl: it was not written by torch.save",
                    "save tensors with torch.save(tensor.detach().cpu(), path)");
  }
  if (const ZipEntry* order = zip_->find(prefix_ + "byteorder")) {
    constexpr uint64_t kLongestWord = 16;
    big_endian_ = zip_->read(*order, kLongestWord) == "big";
  }
}

void TorchContainer::open_legacy(std::unique_ptr<ByteSource> source) {
  source_ = std::move(source);
  const std::string head = source_->read(0, std::min(source_->size(), kMaxPickleBytes));
  std::string_view rest = head;
  const std::vector<std::string> no_globals, globals = torch_globals();
  const auto next = [&](const std::vector<std::string>& allowed) {
    Pickle pickle(rest, allowed, name_);
    rest.remove_prefix(pickle.bytes_read());
    return pickle;
  };
  next(no_globals);  // the magic number
  constexpr int64_t kProtocol = 1001;
  const Pickle protocol = next(no_globals);
  if (!protocol.root().is(PickleKind::kInt) || protocol.root().integer != kProtocol)
    throw_bad_input(name_, "protocol", "unknown version of the format", kDamagedFileRemedy);
  const Pickle system = next(no_globals);
  if (const PickleValue* little = system.root().find("little_endian"))
    big_endian_ = little->is(PickleKind::kBool) && little->integer == 0;
  pickle_.emplace(next(globals));
  const Pickle keys = next(no_globals);
  if (!keys.root().is(PickleKind::kList))
    throw_bad_input(name_, "storages", "the list of storages is missing", kDamagedFileRemedy);

  std::unordered_map<std::string, uint64_t> element_bytes;
  for (const PickleValue& value : pickle_->values()) {
    if (!value.is(PickleKind::kPersistentId)) continue;
    const TorchStorage storage = torch_storage(value, name_);
    element_bytes[storage.key] = storage.type->bytes;
  }
  uint64_t offset = head.size() - rest.size();
  for (const PickleValue* key : keys.root().items) {
    const auto known = element_bytes.find(key->text);
    if (!key->is(PickleKind::kString) || known == element_bytes.end())
      throw_bad_input(name_, "storage " + key->text.substr(0, 100), "nothing refers to it", kDamagedFileRemedy);
    constexpr uint64_t kCountBytes = 8;
    const std::string text = source_->read(offset, kCountBytes);
    const uint64_t count = load_number<uint64_t>(text.data(), big_endian_);
    offset += kCountBytes;
    if (count > (source_->size() - offset) / known->second) {
      throw_bad_input(name_, "storage " + key->text.substr(0, 100),
                      "the file cannot hold " + std::to_string(count) + " elements", kDamagedFileRemedy);
    }
    storages_[key->text] = {offset, count * known->second};
    offset += count * known->second;
  }
}

std::string TorchContainer::storage_bytes(const TorchStorage& storage) const {
  const std::string field = "storage " + storage.key.substr(0, 100);
  const uint64_t needed = storage.elements * storage.type->bytes;
  const auto require_size = [&](uint64_t size) {
    if (size != needed) {
      throw_bad_input(name_, field, "has " + std::to_string(size) + " bytes, " + std::to_string(needed) + " are needed",
                      kDamagedFileRemedy);
    }
  };
  if (source_) {
    const auto found = storages_.find(storage.key);
    if (found == storages_.end()) throw_bad_input(name_, field, "missing", kDamagedFileRemedy);
    require_size(found->second.bytes);
    return source_->read(found->second.offset, found->second.bytes);
  }
  const ZipEntry* entry = zip_->find(prefix_ + "data/" + storage.key);
  if (!entry) throw_bad_input(name_, field, "missing", kDamagedFileRemedy);
  require_size(entry->size);
  return zip_->read(*entry);
}

FloatArray TorchContainer::read(const TorchView& view) const {
  return torch_values(view, storage_bytes(view.storage), big_endian_);
}

}  // namespace aligngs
