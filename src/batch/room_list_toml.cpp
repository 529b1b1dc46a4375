#include <toml++/toml.h>

#include "batch/option_words.h"
#include "batch/room_list.h"
#include "core/error.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

const char* const kTomlForm =
    "write [[room]] with name = \"...\", source = \"...\" and, if wanted, options = [\"...\"]";

int line_of(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

class TomlList {
 public:
  explicit TomlList(const fs::path& list) : list_(list) {}

  std::vector<RoomEntry> read(const toml::table& root) const {
    std::vector<std::string> shared;
    std::vector<RoomEntry> rooms;
    for (const auto& [key, node] : root) {
      if (key.str() == "options")
        shared = words_of(node);
      else if (key.str() != "room")
        fail(node, "there is no such key: " + std::string(key.str()));
    }
    const toml::node* const node = root.get("room");
    const toml::array* const list = node ? node->as_array() : nullptr;
    if (node && !list) fail(*node, "room is no list of tables");
    if (!list || list->empty()) throw_bad_input(list_, "room", "the list has no rooms", kTomlForm);
    for (const toml::node& item : *list) {
      if (!item.is_table()) fail(item, "a room is no table");
      RoomEntry room = room_of(*item.as_table());
      room.options.insert(room.options.begin(), shared.begin(), shared.end());
      require_valid_room(room, rooms, list_, kTomlForm);
      rooms.push_back(std::move(room));
    }
    return rooms;
  }

 private:
  [[noreturn]] void fail(const toml::node& node, const std::string& message) const {
    throw_bad_input(list_, line_field(line_of(node)), message, kTomlForm);
  }

  RoomEntry room_of(const toml::table& table) const {
    RoomEntry room;
    room.line = line_of(table);
    for (const auto& [key, node] : table) {
      if (key.str() == "name")
        room.name = text_of(node, "name");
      else if (key.str() == "source")
        room.source = text_of(node, "source");
      else if (key.str() == "options")
        room.options = words_of(node);
      else
        fail(node, "a room has no key " + std::string(key.str()));
    }
    return room;
  }

  std::string text_of(const toml::node& node, const std::string& key) const {
    const auto* text = node.as_string();
    if (!text) fail(node, key + " is no text");
    return text->get();
  }

  std::vector<std::string> words_of(const toml::node& node) const {
    if (const auto* text = node.as_string()) {
      try {
        return split_words(text->get());
      } catch (const Error& error) {
        fail(node, error.details().message);
      }
    }
    const toml::array* const list = node.as_array();
    if (!list) fail(node, "options are neither a text nor a list of words");
    std::vector<std::string> words;
    for (const toml::node& item : *list) words.push_back(text_of(item, "a word of options"));
    return words;
  }

  const fs::path& list_;
};

}  // namespace

std::vector<RoomEntry> parse_room_toml(std::string_view text, const fs::path& name_for_errors) {
  toml::table root;
  try {
    root = toml::parse(text, name_for_errors.string());
  } catch (const toml::parse_error& error) {
    throw_bad_input(name_for_errors, line_field(static_cast<int>(error.source().begin.line)),
                    std::string(error.description()), kTomlForm);
  }
  return TomlList(name_for_errors).read(root);
}

}  // namespace aligngs
