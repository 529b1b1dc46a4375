#include "io/pickle.h"

#include <algorithm>

#include "io/byte_reader.h"
#include "io/pickle_operations.h"
#include "io/pickle_stack.h"

namespace aligngs {

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
      : stack_(pickle.values_, name), reader_(bytes, name), allowed_(allowed) {}

  size_t bytes_read() const { return reader_.offset(); }

  const PickleValue* run() {
    while (true) {
      stack_.begin_operation(reader_.offset());
      const auto operation = reader_.little<uint8_t>("pickle");
      if (operation == kStop) return stack_.pop();
      if (!push_scalar(operation) && !push_text(operation) && !collect(operation) && !remember(operation)) {
        refer(operation);
      }
    }
  }

 private:
  using enum pickle::Operation;

  bool push_scalar(uint8_t operation) {
    switch (operation) {
      case kNone:
        stack_.push(PickleKind::kNone);
        return true;
      case kNewTrue:
      case kNewFalse:
        stack_.push(PickleKind::kBool).integer = operation == kNewTrue;
        return true;
      case kBinInt:
        stack_.push(PickleKind::kInt).integer = reader_.little<int32_t>("integer");
        return true;
      case kBinInt1:
        stack_.push(PickleKind::kInt).integer = reader_.little<uint8_t>("integer");
        return true;
      case kBinInt2:
        stack_.push(PickleKind::kInt).integer = reader_.little<uint16_t>("integer");
        return true;
      case kLong1:
        push_long(reader_.little<uint8_t>("integer"));
        return true;
      case kLong4:
        push_long(reader_.little<uint32_t>("integer"));
        return true;
      case kBinFloat:
        stack_.push(PickleKind::kFloat).real = load_number<double>(reader_.take(8, "float").data(), true);
        return true;
      default:
        return false;
    }
  }

  void push_long(uint32_t length) {
    const std::string_view bytes = reader_.take(length, "integer");
    if (length > 8) {
      stack_.push(PickleKind::kBigInt).text = bytes;
      return;
    }
    const bool negative = length > 0 && (uint8_t(bytes.back()) & 0x80);
    uint64_t value = negative ? ~uint64_t(0) : 0;
    for (size_t i = length; i-- > 0;) value = value << 8 | uint8_t(bytes[i]);
    stack_.push(PickleKind::kInt).integer = static_cast<int64_t>(value);
  }

  bool push_text(uint8_t operation) {
    switch (operation) {
      case kShortBinUnicode:
      case kShortBinString:
        stack_.push(PickleKind::kString).text = reader_.take(reader_.little<uint8_t>("string"), "string");
        return true;
      case kBinUnicode:
      case kBinString:
        stack_.push(PickleKind::kString).text = reader_.take(reader_.little<uint32_t>("string"), "string");
        return true;
      case kBinUnicode8:
        stack_.push(PickleKind::kString).text = reader_.take(reader_.little<uint64_t>("string"), "string");
        return true;
      case kShortBinBytes:
        stack_.push(PickleKind::kBytes).text = reader_.take(reader_.little<uint8_t>("bytes"), "bytes");
        return true;
      case kBinBytes:
        stack_.push(PickleKind::kBytes).text = reader_.take(reader_.little<uint32_t>("bytes"), "bytes");
        return true;
      case kBinBytes8:
        stack_.push(PickleKind::kBytes).text = reader_.take(reader_.little<uint64_t>("bytes"), "bytes");
        return true;
      default:
        return false;
    }
  }

  bool collect(uint8_t operation) {
    switch (operation) {
      case kMark:
        stack_.mark();
        return true;
      case kPop:
        stack_.pop();
        return true;
      case kEmptyTuple:
        stack_.push(PickleKind::kTuple);
        return true;
      case kEmptyList:
        stack_.push(PickleKind::kList);
        return true;
      case kEmptyDict:
        stack_.push(PickleKind::kDict);
        return true;
      case kTuple: {
        std::vector<const PickleValue*> items = stack_.pop_to_mark();
        stack_.push(PickleKind::kTuple).items = std::move(items);
        return true;
      }
      case kTuple1:
      case kTuple2:
      case kTuple3:
        stack_.push_tuple(size_t(operation - kTuple1) + 1);
        return true;
      case kAppend: {
        const PickleValue* item = stack_.pop();
        stack_.extend(PickleKind::kList, {item});
        return true;
      }
      case kAppends:
        stack_.extend(PickleKind::kList, stack_.pop_to_mark());
        return true;
      case kSetItem: {
        const PickleValue* value = stack_.pop();
        const PickleValue* key = stack_.pop();
        stack_.extend(PickleKind::kDict, {key, value});
        return true;
      }
      case kSetItems:
        stack_.extend(PickleKind::kDict, stack_.pop_to_mark());
        return true;
      default:
        return false;
    }
  }

  bool remember(uint8_t operation) {
    switch (operation) {
      case kProto:
        if (const int version = reader_.little<uint8_t>("protocol"); version > 5) {
          stack_.fail("unknown pickle protocol " + std::to_string(version));
        }
        return true;
      case kFrame:
        reader_.take(8, "frame");
        return true;
      case kBinPut:
        stack_.put(reader_.little<uint8_t>("memo"));
        return true;
      case kLongBinPut:
        stack_.put(reader_.little<uint32_t>("memo"));
        return true;
      case kMemoize:
        stack_.put();
        return true;
      case kBinGet:
        stack_.get(reader_.little<uint8_t>("memo"));
        return true;
      case kLongBinGet:
        stack_.get(reader_.little<uint32_t>("memo"));
        return true;
      default:
        return false;
    }
  }
  void refer(uint8_t operation) {
    switch (operation) {
      case kGlobal: {
        const std::string module = line();
        push_global(module, line());
        return;
      }
      case kStackGlobal: {
        const PickleValue* global = stack_.pop();
        const PickleValue* module = stack_.pop();
        if (!global->is(PickleKind::kString) || !module->is(PickleKind::kString))
          stack_.fail("a global without a name");
        push_global(module->text, global->text);
        return;
      }
      case kReduce: {
        const PickleValue* arguments = stack_.pop();
        const PickleValue* global = stack_.pop();
        if (!global->is(PickleKind::kGlobal) || !arguments->is(PickleKind::kTuple))
          stack_.fail("a call of what is no global");
        if (global->text == "collections OrderedDict" && arguments->items.empty()) {
          stack_.push(PickleKind::kDict);
        } else {
          stack_.push(PickleKind::kObject).items = {global, arguments};
        }
        return;
      }
      case kBuild: {
        const PickleValue* state = stack_.pop();
        PickleValue* target = stack_.top();
        if (target->is(PickleKind::kObject)) {
          target->items.push_back(state);
        } else if (!target->is(PickleKind::kDict)) {  // attributes of an OrderedDict, such as
                                                      // _metadata, say nothing
          stack_.fail("a state for what has none");
        }
        return;
      }
      case kBinPersId: {
        const PickleValue* id = stack_.pop();
        stack_.push(PickleKind::kPersistentId).items = {id};
        return;
      }
      default:
        stack_.fail("unsupported pickle operation " + std::to_string(operation));
    }
  }

  std::string line() {
    std::string text;
    constexpr size_t kMaxName = 1000;
    while (true) {
      const char c = reader_.little<char>("global");
      if (c == '\n') return text;
      text += c;
      if (text.size() > kMaxName) stack_.fail("the name of a global is too long");
    }
  }

  void push_global(const std::string& module, const std::string& global) {
    const std::string full = module + " " + global;
    if (std::find(allowed_.begin(), allowed_.end(), full) == allowed_.end()) {
      stack_.fail("it refers to '" + module.substr(0, 200) + "." + global.substr(0, 200) + "', which is not allowed");
    }
    stack_.push(PickleKind::kGlobal).text = full;
  }

  PickleStack stack_;
  ByteReader reader_;
  const std::vector<std::string>& allowed_;
};

Pickle::Pickle(std::string_view bytes, const std::vector<std::string>& allowed,
               const std::filesystem::path& name_for_errors) {
  PickleMachine machine(*this, bytes, allowed, name_for_errors);
  root_ = machine.run();
  bytes_read_ = machine.bytes_read();
}

}  // namespace aligngs
