// Operations: CPython's Lib/pickletools.py documents each of them.
#include "io/pickle.h"

#include <algorithm>
#include <unordered_map>

#include "core/error.h"
#include "io/byte_reader.h"

namespace aligngs {

namespace {

constexpr size_t kMaxValues = 1'000'000;  // 80 MB of memory; a state dict of 10 000 tensors has about 150 000

enum Operation : uint8_t {
  kMark = '(',
  kStop = '.',
  kPop = '0',
  kNone = 'N',
  kBinInt = 'J',
  kBinInt1 = 'K',
  kBinInt2 = 'M',
  kBinFloat = 'G',
  kBinString = 'T',
  kShortBinString = 'U',
  kBinUnicode = 'X',
  kBinBytes = 'B',
  kShortBinBytes = 'C',
  kAppend = 'a',
  kAppends = 'e',
  kSetItem = 's',
  kSetItems = 'u',
  kBuild = 'b',
  kGlobal = 'c',
  kReduce = 'R',
  kBinPersId = 'Q',
  kBinGet = 'h',
  kLongBinGet = 'j',
  kBinPut = 'q',
  kLongBinPut = 'r',
  kTuple = 't',
  kEmptyTuple = ')',
  kEmptyList = ']',
  kEmptyDict = '}',
  kProto = 0x80,
  kTuple1 = 0x85,
  kTuple2 = 0x86,
  kTuple3 = 0x87,
  kNewTrue = 0x88,
  kNewFalse = 0x89,
  kLong1 = 0x8a,
  kLong4 = 0x8b,
  kShortBinUnicode = 0x8c,
  kBinUnicode8 = 0x8d,
  kBinBytes8 = 0x8e,
  kStackGlobal = 0x93,
  kMemoize = 0x94,
  kFrame = 0x95,
};

}  // namespace

const PickleValue* PickleValue::find(std::string_view key) const {
  if (kind != PickleKind::kDict) return nullptr;
  for (size_t i = items.size(); i >= 2; i -= 2) {
    if (items[i - 2]->kind == PickleKind::kString && items[i - 2]->text == key) return items[i - 1];
  }
  return nullptr;
}

class PickleMachine {
 public:
  PickleMachine(Pickle& pickle, std::string_view bytes, const std::vector<std::string>& allowed,
                const std::filesystem::path& name)
      : values_(pickle.values_), reader_(bytes, name), allowed_(allowed), name_(name) {}

  size_t bytes_read() const { return reader_.offset(); }

  const PickleValue* run() {
    while (true) {
      at_ = reader_.offset();
      const auto operation = reader_.little<uint8_t>("pickle");
      if (operation == kStop) return pop();
      if (!push_scalar(operation) && !push_text(operation) && !collect(operation) && !remember(operation)) {
        refer(operation);
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw_bad_input(name_, "pickle, byte " + std::to_string(at_), message,
                    "save plain tensors with torch.save of PyTorch 1.6 or later");
  }

  PickleValue& make(PickleKind kind) {
    if (values_.size() >= kMaxValues) fail("more than " + std::to_string(kMaxValues) + " values");
    values_.emplace_back();
    values_.back().kind = kind;
    return values_.back();
  }
  PickleValue& push(PickleKind kind) {
    PickleValue& value = make(kind);
    stack_.push_back(&value);
    return value;
  }

  PickleValue* pop() {
    if (stack_.size() <= floor()) fail("an operation lacks its operand");
    PickleValue* value = stack_.back();
    stack_.pop_back();
    return value;
  }
  PickleValue* top() const {
    if (stack_.size() <= floor()) fail("an operation lacks its operand");
    return stack_.back();
  }
  size_t floor() const { return marks_.empty() ? 0 : marks_.back(); }
  std::vector<const PickleValue*> pop_to_mark() {
    if (marks_.empty()) fail("a mark is missing");
    std::vector<const PickleValue*> items(stack_.begin() + std::ptrdiff_t(marks_.back()), stack_.end());
    stack_.resize(marks_.back());
    marks_.pop_back();
    return items;
  }

  bool push_scalar(uint8_t operation) {
    switch (operation) {
      case kNone:
        push(PickleKind::kNone);
        return true;
      case kNewTrue:
      case kNewFalse:
        push(PickleKind::kBool).integer = operation == kNewTrue;
        return true;
      case kBinInt:
        push(PickleKind::kInt).integer = reader_.little<int32_t>("integer");
        return true;
      case kBinInt1:
        push(PickleKind::kInt).integer = reader_.little<uint8_t>("integer");
        return true;
      case kBinInt2:
        push(PickleKind::kInt).integer = reader_.little<uint16_t>("integer");
        return true;
      case kLong1:
        push_long(reader_.little<uint8_t>("integer"));
        return true;
      case kLong4:
        push_long(reader_.little<uint32_t>("integer"));
        return true;
      case kBinFloat:
        push(PickleKind::kFloat).real = load_number<double>(reader_.take(8, "float").data(), true);
        return true;
      default:
        return false;
    }
  }

  void push_long(uint32_t length) {
    const std::string_view bytes = reader_.take(length, "integer");
    if (length > 8) {
      push(PickleKind::kBigInt).text = bytes;
      return;
    }
    const bool negative = length > 0 && (uint8_t(bytes.back()) & 0x80);
    uint64_t value = negative ? ~uint64_t(0) : 0;
    for (size_t i = length; i-- > 0;) value = value << 8 | uint8_t(bytes[i]);
    push(PickleKind::kInt).integer = static_cast<int64_t>(value);
  }

  bool push_text(uint8_t operation) {
    switch (operation) {
      case kShortBinUnicode:
      case kShortBinString:
        push(PickleKind::kString).text = reader_.take(reader_.little<uint8_t>("string"), "string");
        return true;
      case kBinUnicode:
      case kBinString:
        push(PickleKind::kString).text = reader_.take(reader_.little<uint32_t>("string"), "string");
        return true;
      case kBinUnicode8:
        push(PickleKind::kString).text = reader_.take(reader_.little<uint64_t>("string"), "string");
        return true;
      case kShortBinBytes:
        push(PickleKind::kBytes).text = reader_.take(reader_.little<uint8_t>("bytes"), "bytes");
        return true;
      case kBinBytes:
        push(PickleKind::kBytes).text = reader_.take(reader_.little<uint32_t>("bytes"), "bytes");
        return true;
      case kBinBytes8:
        push(PickleKind::kBytes).text = reader_.take(reader_.little<uint64_t>("bytes"), "bytes");
        return true;
      default:
        return false;
    }
  }

  void push_tuple(size_t length) {
    std::vector<const PickleValue*> items(length);
    for (size_t i = length; i-- > 0;) items[i] = pop();
    push(PickleKind::kTuple).items = std::move(items);
  }
  void extend(PickleKind kind, const std::vector<const PickleValue*>& items) {
    PickleValue* container = top();
    if (container->kind != kind) fail("items for what is no list or dict");
    if (kind == PickleKind::kDict && items.size() % 2 != 0) fail("a dict key without a value");
    container->items.insert(container->items.end(), items.begin(), items.end());
  }

  bool collect(uint8_t operation) {
    switch (operation) {
      case kMark:
        marks_.push_back(stack_.size());
        return true;
      case kPop:
        pop();
        return true;
      case kEmptyTuple:
        push(PickleKind::kTuple);
        return true;
      case kEmptyList:
        push(PickleKind::kList);
        return true;
      case kEmptyDict:
        push(PickleKind::kDict);
        return true;
      case kTuple: {
        std::vector<const PickleValue*> items = pop_to_mark();
        push(PickleKind::kTuple).items = std::move(items);
        return true;
      }
      case kTuple1:
      case kTuple2:
      case kTuple3:
        push_tuple(size_t(operation - kTuple1) + 1);
        return true;
      case kAppend: {
        const PickleValue* item = pop();
        extend(PickleKind::kList, {item});
        return true;
      }
      case kAppends:
        extend(PickleKind::kList, pop_to_mark());
        return true;
      case kSetItem: {
        const PickleValue* value = pop();
        const PickleValue* key = pop();
        extend(PickleKind::kDict, {key, value});
        return true;
      }
      case kSetItems:
        extend(PickleKind::kDict, pop_to_mark());
        return true;
      default:
        return false;
    }
  }

  bool remember(uint8_t operation) {
    switch (operation) {
      case kProto:
        if (const int version = reader_.little<uint8_t>("protocol"); version > 5) {
          fail("unknown pickle protocol " + std::to_string(version));
        }
        return true;
      case kFrame:
        reader_.take(8, "frame");
        return true;
      case kBinPut:
        memo_[reader_.little<uint8_t>("memo")] = top();
        return true;
      case kLongBinPut:
        memo_[reader_.little<uint32_t>("memo")] = top();
        return true;
      case kMemoize:
        memo_[static_cast<uint32_t>(memo_.size())] = top();
        return true;
      case kBinGet:
        get(reader_.little<uint8_t>("memo"));
        return true;
      case kLongBinGet:
        get(reader_.little<uint32_t>("memo"));
        return true;
      default:
        return false;
    }
  }
  void get(uint32_t index) {
    const auto found = memo_.find(index);
    if (found == memo_.end()) fail("memo entry " + std::to_string(index) + " does not exist");
    // Each get costs two bytes of the file but eight of the stack; the limit on values bounds both.
    if (stack_.size() >= kMaxValues) fail("more than " + std::to_string(kMaxValues) + " values on the stack");
    stack_.push_back(found->second);
  }

  void refer(uint8_t operation) {
    switch (operation) {
      case kGlobal: {
        const std::string module = line();
        push_global(module, line());
        return;
      }
      case kStackGlobal: {
        const PickleValue* global = pop();
        const PickleValue* module = pop();
        if (!global->is(PickleKind::kString) || !module->is(PickleKind::kString)) fail("a global without a name");
        push_global(module->text, global->text);
        return;
      }
      case kReduce: {
        const PickleValue* arguments = pop();
        const PickleValue* global = pop();
        if (!global->is(PickleKind::kGlobal) || !arguments->is(PickleKind::kTuple)) fail("a call of what is no global");
        if (global->text == "collections OrderedDict" && arguments->items.empty()) {
          push(PickleKind::kDict);
        } else {
          push(PickleKind::kObject).items = {global, arguments};
        }
        return;
      }
      case kBuild: {
        const PickleValue* state = pop();
        PickleValue* target = top();
        if (target->is(PickleKind::kObject)) {
          target->items.push_back(state);
        } else if (!target->is(PickleKind::kDict)) {  // attributes of an OrderedDict, such as
                                                      // _metadata, say nothing
          fail("a state for what has none");
        }
        return;
      }
      case kBinPersId: {
        const PickleValue* id = pop();
        push(PickleKind::kPersistentId).items = {id};
        return;
      }
      default:
        fail("unsupported pickle operation " + std::to_string(operation));
    }
  }

  std::string line() {
    std::string text;
    constexpr size_t kMaxName = 1000;
    while (true) {
      const char c = reader_.little<char>("global");
      if (c == '\n') return text;
      text += c;
      if (text.size() > kMaxName) fail("the name of a global is too long");
    }
  }

  void push_global(const std::string& module, const std::string& global) {
    const std::string full = module + " " + global;
    if (std::find(allowed_.begin(), allowed_.end(), full) == allowed_.end()) {
      fail("it refers to '" + module.substr(0, 200) + "." + global.substr(0, 200) + "', which is not allowed");
    }
    push(PickleKind::kGlobal).text = full;
  }

  std::deque<PickleValue>& values_;
  ByteReader reader_;
  const std::vector<std::string>& allowed_;
  const std::filesystem::path& name_;
  std::vector<PickleValue*> stack_;
  std::vector<size_t> marks_;
  std::unordered_map<uint32_t, PickleValue*> memo_;
  size_t at_ = 0;
};

Pickle::Pickle(std::string_view bytes, const std::vector<std::string>& allowed,
               const std::filesystem::path& name_for_errors) {
  PickleMachine machine(*this, bytes, allowed, name_for_errors);
  root_ = machine.run();
  bytes_read_ = machine.bytes_read();
}

}  // namespace aligngs
