#include "batch/batch_folder.h"

#include <nlohmann/json.hpp>

#include "core/edit_distance.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "io/file_system_error.h"
#include "io/json_integer.h"
#include "io/json_text.h"
#include "io/output_place.h"
#include "io/text_encoding.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;
constexpr uint64_t kLargestList = uint64_t(64) << 20;  // bytes; four times what a LIST may have
const char* const kWriteListAgain = "write it again: aligngs batch LIST -o ";

Json to_json(const Batch& batch) {
  Json rooms = Json::array();
  for (const RoomEntry& room : batch.rooms) {
    rooms.push_back({{"name", room.name}, {"source", room.source}, {"options", room.options}, {"line", room.line}});
  }
  return {{"schema", kSchema}, {"list", batch.list.string()}, {"rooms", rooms}};
}

}  // namespace

fs::path Batch::source_of(const RoomEntry& room) const {
  return room.synthetic() ? fs::path(room.source) : (base() / room.source).lexically_normal();
}

const RoomEntry& Batch::room(const std::string& name) const {
  const RoomEntry* near = nullptr;
  size_t distance = name.size() / 3 + 1;  // more than a third of the letters differ: not near
  for (const RoomEntry& room : rooms) {
    if (room.name == name) return room;
    if (const size_t d = edit_distance(name, room.name); d <= distance) {
      distance = d;
      near = &room;
    }
  }
  throw_usage("the batch has no room " + name,
              near ? "did you mean " + near->name + "?" : "`aligngs batch status DIR` lists the rooms");
}

BatchFolder::BatchFolder(const fs::path& folder) : folder_(fs::absolute(folder).lexically_normal()) {}

void BatchFolder::prepare(const Batch& batch) const {
  std::error_code error;
  if (fs::exists(folder_, error) && !fs::is_directory(folder_, error)) {
    throw Error({ErrorKind::kUsage, "the folder of the batch is a file", folder_, "-o", "name a new folder"});
  }
  if (!fs::exists(list(), error) && fs::exists(folder_, error) && !fs::is_empty(folder_, error)) {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      // Another worker may be creating the same batch. It fills these folders after its list is there.
      const bool part = name == "rooms" || name == "records" || name == "leases" || name == "logs";
      if (name.rfind("list.json", 0) == 0 || (part && (fs::is_empty(entry.path(), error) || fs::exists(list(), error))))
        continue;
      throw Error({ErrorKind::kUsage, "the folder is not empty and holds no batch, but " + as_utf8(name), folder_, "-o",
                   "name a new or empty folder"});
    }
  }
  require_folder_place(folder_);
  const std::string old = fs::exists(list(), error) ? read_file(list(), kLargestList) : "";
  if (!old.empty() && old.find("\"rooms\"") == std::string::npos)
    throw Error({ErrorKind::kUsage, "this list was not written by aligngs: it is never replaced", list(), "-o",
                 "name a new or empty folder"});
  for (const RoomEntry& room : batch.rooms) {
    if (!room.synthetic() && fs::is_directory(batch.source_of(room), error))
      require_apart(run(room.name), {batch.source_of(room)});
  }
  for (const char* part : {"rooms", "records", "leases", "logs"}) {
    fs::create_directories(folder_ / part, error);
    if (error)
      throw_resources(folder_ / part, "cannot be created: " + error.message(), remedy_for_write(error.value()));
  }
  const std::string text = json_document(to_json(batch));
  if (old != text) write_file_atomically(list(), text);
}

Batch BatchFolder::read() const {
  if (!fs::exists(list())) {
    throw Error({ErrorKind::kUsage, "there is no batch in this folder", folder_, "",
                 "begin one: aligngs batch LIST -o " + folder_.string()});
  }
  const Json json = parse_ordered_json(read_file(list(), kLargestList));
  const auto damaged = [&](const std::string& field) {
    throw_bad_input(list(), field, "the list of the batch is damaged", kWriteListAgain + folder_.string());
  };
  if (!json.is_object() || !json.contains("rooms") || !json["rooms"].is_array()) damaged("rooms");
  if (!json.contains("list") || !json["list"].is_string()) damaged("list");
  Batch batch;
  batch.list = json["list"].get<std::string>();
  for (const Json& item : json["rooms"]) {
    if (!item.is_object() || !item.contains("name") || !item["name"].is_string() || !item.contains("source") ||
        !item["source"].is_string() || !item.contains("options") || !item["options"].is_array()) {
      damaged("rooms");
    }
    RoomEntry room;
    room.name = item["name"].get<std::string>();
    room.source = item["source"].get<std::string>();
    for (const Json& word : item["options"]) {
      if (!word.is_string()) damaged("options of " + room.name);
      room.options.push_back(word.get<std::string>());
    }
    room.line = integer_member<int>(item, "line");
    require_valid_room(room, batch.rooms, list(), "write it again: aligngs batch LIST -o DIR");
    batch.rooms.push_back(std::move(room));
  }
  return batch;
}

}  // namespace aligngs
