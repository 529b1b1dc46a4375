#include "cli/edit_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
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
std::string objects_text(const std::vector<ListedObject>& objects, const LengthUnit& unit) {
  size_t name_width = 0, size_width = 0;
  for (const ListedObject& object : objects) {
    name_width = std::max(name_width, object.name.size());
    if (object.sides) size_width = std::max(size_width, sides_text(*object.sides, unit).size());
  }
  const char* const remark = unit.estimated ? ", in metres that a network estimates" : "";
  std::string text = size_width ? fmt::format("objects (length x width x height{}):\n", remark) : "objects:\n";
  for (const ListedObject& object : objects) {
    const std::string size = object.sides ? sides_text(*object.sides, unit) : "";
    text += "  " + object.name + std::string(name_width - object.name.size() + 2, ' ') + size;
    if (size_width) text += std::string(size_width - size.size() + 2, ' ');
    text += std::to_string(object.instance.gaussians) + " Gaussians\n";
  }
  return text;
}

Json objects_json(const std::vector<ListedObject>& objects, const LengthUnit& unit) {
  Json out = Json::array();
  for (const ListedObject& object : objects) {
    const Instance& o = object.instance;
    Json entry{{"object", object.name}, {"gaussians", o.gaussians}, {"centre", {o.centre.x, o.centre.y, o.centre.z}}};
    if (object.sides) {
      const Vec3d sides = *object.sides * unit.metres.value_or(1);
      entry[unit.metres ? "size_m" : "size"] = {sides.x, sides.y, sides.z};
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
  const LengthUnit unit = session.length_unit();
  std::string text = listed_edits(session.stack()) + objects_text(objects, unit);
  const RoomSelections& drawn = session.selections();
  if (!drawn.list.empty()) text += "selections by hand:\n";
  for (const NamedSelection& s : drawn.list) {
    text += "  " + s.name + ": " + std::to_string(s.count()) + " Gaussians" +
            (drawn.is_usable(s) ? "" : " of another training") + "\n";
  }
  print_result(context,
               Json{{"edits", edits},
                    {"objects", objects_json(objects, unit)},
                    {"lengths_are_estimated", unit.estimated},
                    {"selections", selections_json(drawn)}},
               text);
}

}  // namespace aligngs
