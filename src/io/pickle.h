// Python pickles (protocols 2 to 5) read as data: nothing is imported or called.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

enum class PickleKind {
  kNone,
  kBool,          ///< integer 0 or 1
  kInt,           ///< integer
  kBigInt,        ///< text: two's complement, little-endian, more than 8 bytes
  kFloat,         ///< real
  kString,        ///< text: UTF-8, unchanged
  kBytes,         ///< text
  kTuple,         ///< items
  kList,          ///< items
  kDict,          ///< items: key, value, key, value, ... in the order of insertion (OrderedDict too)
  kGlobal,        ///< text: "module name"
  kObject,        ///< items: the global, its argument tuple, then every state set on it; never called
  kPersistentId,  ///< items: the identifier
};

/// Values refer to each other by pointer and may form cycles: a walk over them must remember where
/// it has been.
struct PickleValue {
  PickleKind kind = PickleKind::kNone;
  int64_t integer = 0;
  double real = 0;
  std::string text;
  std::vector<const PickleValue*> items;

  bool is(PickleKind k) const { return kind == k; }
  /// The value of a string key of a dict; nullptr when absent or when this is no dict. The last of
  /// equal keys counts.
  const PickleValue* find(std::string_view key) const;
  /// Whether this is an object made by the given global.
  bool is_object_of(std::string_view global) const { return kind == PickleKind::kObject && items[0]->text == global; }
};

class Pickle {
 public:
  /// `allowed` lists the globals that may occur, as "module name". Anything else, unknown
  /// operations, and pickles of more than a million values are Error{kBadInput} naming what was
  /// met.
  Pickle(std::string_view bytes, const std::vector<std::string>& allowed, const std::filesystem::path& name_for_errors);
  Pickle(Pickle&&) = default;

  const PickleValue& root() const { return *root_; }
  /// Everything that was made, in the order of the file; the root can lie anywhere.
  const std::deque<PickleValue>& values() const { return values_; }
  /// Bytes up to and including the STOP that ended this pickle: another one may follow.
  size_t bytes_read() const { return bytes_read_; }

 private:
  friend class PickleMachine;
  std::deque<PickleValue> values_;  ///< owns everything; addresses are stable
  const PickleValue* root_ = nullptr;
  size_t bytes_read_ = 0;
};

}  // namespace aligngs
