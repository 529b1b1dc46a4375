#include "io/pickle_stack.h"

#include "core/error.h"

namespace aligngs {
namespace {

constexpr size_t kMaxValues = 1'000'000;  // 80 MB of memory; a state dict of 10 000 tensors has about 150 000

}  // namespace

void PickleStack::fail(const std::string& message) const {
  throw_bad_input(name_, "pickle, byte " + std::to_string(at_), message,
                  "save plain tensors with torch.save of PyTorch 1.6 or later");
}

PickleValue& PickleStack::push(PickleKind kind) {
  if (values_.size() >= kMaxValues) fail("more than " + std::to_string(kMaxValues) + " values");
  values_.emplace_back();
  values_.back().kind = kind;
  stack_.push_back(&values_.back());
  return values_.back();
}

void PickleStack::push_tuple(size_t length) {
  std::vector<const PickleValue*> items(length);
  for (size_t i = length; i-- > 0;) items[i] = pop();
  push(PickleKind::kTuple).items = std::move(items);
}

PickleValue* PickleStack::pop() {
  PickleValue* value = top();
  stack_.pop_back();
  return value;
}

PickleValue* PickleStack::top() const {
  if (stack_.size() <= floor()) fail("an operation lacks its operand");
  return stack_.back();
}

std::vector<const PickleValue*> PickleStack::pop_to_mark() {
  if (marks_.empty()) fail("a mark is missing");
  std::vector<const PickleValue*> items(stack_.begin() + std::ptrdiff_t(marks_.back()), stack_.end());
  stack_.resize(marks_.back());
  marks_.pop_back();
  return items;
}

void PickleStack::extend(PickleKind kind, const std::vector<const PickleValue*>& items) {
  PickleValue* container = top();
  if (container->kind != kind) fail("items for what is no list or dict");
  if (kind == PickleKind::kDict && items.size() % 2 != 0) fail("a dict key without a value");
  container->items.insert(container->items.end(), items.begin(), items.end());
}

void PickleStack::get(uint32_t index) {
  const auto found = memo_.find(index);
  if (found == memo_.end()) fail("memo entry " + std::to_string(index) + " does not exist");
  // Each get costs two bytes of the file but eight of the stack; the limit on values bounds both.
  if (stack_.size() >= kMaxValues) fail("more than " + std::to_string(kMaxValues) + " values on the stack");
  stack_.push_back(found->second);
}

}  // namespace aligngs
