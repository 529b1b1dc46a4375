#include "cli/edit_list.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/print_json.h"
#include "edit/listed_objects.h"
#include "edit/report_json.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

std::string listed_edits(const std::vector<EditOperation>& stack) {
  if (stack.empty()) return "no edits\n";
  std::string text = "edits, oldest first:\n";
  for (size_t i = 0; i < stack.size(); ++i) text += "  " + std::to_string(i + 1) + ". " + describe(stack[i]) + "\n";
  return text;
}

/// Names, sizes and counts in columns.
std::string objects_text(const std::vector<ListedObject>& objects, std::optional<double> metres) {
  size_t name_width = 0, size_width = 0;
  for (const ListedObject& object : objects) {
    name_width = std::max(name_width, object.name.size());
    if (object.sides) size_width = std::max(size_width, sides_text(*object.sides, metres).size());
  }
  std::string text = size_width ? "objects (length x width x height):\n" : "objects:\n";
  for (const ListedObject& object : objects) {
    const std::string size = object.sides ? sides_text(*object.sides, metres) : "";
    text += "  " + object.name + std::string(name_width - object.name.size() + 2, ' ') + size;
    if (size_width) text += std::string(size_width - size.size() + 2, ' ');
    text += std::to_string(object.instance.gaussians) + " Gaussians\n";
  }
  return text;
}

Json objects_json(const std::vector<ListedObject>& objects, std::optional<double> metres) {
  Json out = Json::array();
  for (const ListedObject& object : objects) {
    const Instance& o = object.instance;
    Json entry{{"object", object.name}, {"gaussians", o.gaussians}, {"centre", {o.centre.x, o.centre.y, o.centre.z}}};
    if (object.sides) {
      const Vec3d sides = *object.sides * metres.value_or(1);
      entry[metres ? "size_m" : "size"] = {sides.x, sides.y, sides.z};
    }
    out.push_back(std::move(entry));
  }
  return out;
}

}  // namespace

void list_run(const CommandContext& context, EditSession& session) {
  Json edits = Json::array();
  for (const EditOperation& edit : session.stack()) edits.push_back(describe(edit));
  const std::vector<ListedObject> objects = listed_objects(session.room());
  const std::optional<double> metres = session.metres_of_unit();
  std::string text = listed_edits(session.stack()) + objects_text(objects, metres);
  const RoomSelections& drawn = session.selections();
  if (!drawn.list.empty()) text += "selections by hand:\n";
  for (const NamedSelection& s : drawn.list) {
    text += "  " + s.name + ": " + std::to_string(s.count()) + " Gaussians" +
            (drawn.is_usable(s) ? "" : " of another training") + "\n";
  }
  print_result(
      context,
      Json{{"edits", edits}, {"objects", objects_json(objects, metres)}, {"selections", selections_json(drawn)}}, text);
}

}  // namespace aligngs
