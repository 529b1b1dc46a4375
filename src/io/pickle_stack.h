// Values of a pickle while it is read: the stack, its marks and the memo.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/pickle.h"

namespace aligngs {

class PickleStack {
 public:
  /// New values go to `values`. Errors name the file `name`.
  PickleStack(std::deque<PickleValue>& values, const std::filesystem::path& name) : values_(values), name_(name) {}

  /// The byte of the operation that errors name.
  void begin_operation(size_t at) { at_ = at; }
  /// Error{kBadInput} at the current operation.
  [[noreturn]] void fail(const std::string& message) const;

  PickleValue& push(PickleKind kind);
  void push_tuple(size_t length);  ///< of the topmost values
  /// pop() and top() fail where nothing lies above the last mark.
  PickleValue* pop();
  PickleValue* top() const;
  void mark() { marks_.push_back(stack_.size()); }
  std::vector<const PickleValue*> pop_to_mark();
  /// Adds items to the topmost value, which must be a container of this kind.
  void extend(PickleKind kind, const std::vector<const PickleValue*>& items);

  /// Memory of the topmost value under a number; the next free one without it.
  void put(uint32_t index) { memo_[index] = top(); }
  void put() { put(static_cast<uint32_t>(memo_.size())); }
  /// Pushes what put() has remembered.
  void get(uint32_t index);

 private:
  size_t floor() const { return marks_.empty() ? 0 : marks_.back(); }

  std::deque<PickleValue>& values_;
  const std::filesystem::path& name_;
  std::vector<PickleValue*> stack_;
  std::vector<size_t> marks_;
  std::unordered_map<uint32_t, PickleValue*> memo_;
  size_t at_ = 0;
};

}  // namespace aligngs
