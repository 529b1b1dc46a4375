#include "room/room_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_integer.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kLargest = 64 << 20;  // bytes: a room of a thousand things has one

Json point(const Vec2d& p) { return {p.x, p.y}; }
Json point(const Vec3d& p) { return {p.x, p.y, p.z}; }

/// normal . x + offset = 0 as four numbers.
Json plane(const Vec3d& normal, double offset) { return {normal.x, normal.y, normal.z, offset}; }

Json rectangle(const MeasuredWall& wall, double left, double right, double bottom, double top) {
  return {point(wall.at(left, bottom)), point(wall.at(right, bottom)), point(wall.at(right, top)),
          point(wall.at(left, top))};
}

Json wall_json(const MeasuredRoom& room, size_t index) {
  const MeasuredWall& w = room.walls[index];
  Json out = {{"id", wall_name(index)},
              {"from", point(w.from)},
              {"to", point(w.to)},
              {"length", w.length()},
              {"height", w.height}};
  out["plane"] = plane(w.normal, -(w.normal.x * w.from.x + w.normal.y * w.from.y));
  out["outline"] = {point(w.at(0, 0)), point(w.at(w.length(), 0)), point(w.at(w.length(), room.height_at(w.to))),
                    point(w.at(0, room.height_at(w.from)))};
  out["holes"] = Json::array();
  for (const MeasuredOpening& o : room.openings) {
    const bool hole = o.kind == OpeningKind::kDoor || o.kind == OpeningKind::kWindow;
    if (hole && o.wall == static_cast<int>(index))
      out["holes"].push_back(rectangle(w, o.left, o.right, o.bottom, o.top));
  }
  out["thickness"] = nullptr;
  out["assumed"] = w.assumed;
  out["seen"] = w.seen;
  out["confidence"] = w.confidence;
  return out;
}

Json opening_json(const MeasuredRoom& room, size_t index) {
  const MeasuredOpening& o = room.openings[index];
  return {{"id", opening_name(room, index)},
          {"kind", name_of(o.kind)},
          {"class", o.class_name},
          {"wall", wall_name(static_cast<size_t>(o.wall))},
          {"left", o.left},
          {"right", o.right},
          {"sill", o.bottom},
          {"top", o.top},
          {"width", o.right - o.left},
          {"height", o.top - o.bottom},
          {"outline", rectangle(room.walls[static_cast<size_t>(o.wall)], o.left, o.right, o.bottom, o.top)},
          {"seen", o.seen},
          {"confidence", o.confidence}};
}

Json box_json(const MeasuredBox& b) {
  Json out = {{"id", box_name(b)},
              {"class", b.class_name},
              {"instance", b.instance},
              {"centre", point(Vec3d{b.centre.x, b.centre.y, (b.bottom + b.top) / 2})},
              {"size", point(Vec3d{b.width, b.depth, b.top - b.bottom})},
              {"turn", b.turn},
              {"support", b.support},
              {"seen", b.seen},
              {"confidence", b.confidence}};
  if (b.shown) {
    const ShownBox& s = *b.shown;
    out["shown"] = {{"centre", point(Vec3d{s.centre.x, s.centre.y, (s.bottom + s.top) / 2})},
                    {"size", point(Vec3d{s.width, s.depth, s.top - s.bottom})},
                    {"turn", s.turn}};
  }
  return out;
}

Json matrix(const Similarity& s) {
  Json rows = Json::array();
  const Vec3d& t = s.translation;
  for (int r = 0; r < 3; ++r)
    rows.push_back({s.scale * s.rotation(r, 0), s.scale * s.rotation(r, 1), s.scale * s.rotation(r, 2),
                    t.x * (r == 0) + t.y * (r == 1) + t.z * (r == 2)});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

/// A hundredth of a millimetre, or as fine in scene units: more digits would claim more. Under a scale that was given
/// afterwards ten digits stay, so that taking it back finds the measures again.
double rounded(double x, bool given_scale) {
  constexpr double kMeasureSteps = 1e5;  // per metre or scene unit
  return given_scale ? std::stod(fmt::format("{:.10g}", x)) : std::round(x * kMeasureSteps) / kMeasureSteps;
}

/// Rounds what was measured; the frame and the scale keep all digits.
void round_measures(bool given_scale, Json& json) {
  if (json.is_number_float()) json = rounded(json.get<double>(), given_scale);
  if (json.is_array()) {
    for (Json& item : json) round_measures(given_scale, item);
  }
  if (!json.is_object()) return;
  for (auto& [key, value] : json.items()) {
    if (key != "frame" && key != "scale") round_measures(given_scale, value);
  }
}

Json document_of(const MeasuredRoom& room) {
  Json out = {{"schema", kRoomSchema}, {"written_by", "aligngs"}, {"units", room.metric ? "metres" : "scene units"}};
  out["found_by"] = name_of(room.found_by);
  out["scale"] = {{"source", name_of(room.scale_source)}, {"units_per_scene_unit", room.to_room.scale}};
  out["frame"] = {{"up", {0, 0, 1}}, {"world_to_room", matrix(room.to_room)}};
  Json lengths = Json::array(), outline = Json::array(), top = Json::array();
  for (const MeasuredWall& w : room.walls) {
    lengths.push_back(w.length());
    outline.push_back(point(w.at(0, 0)));
    top.push_back(point(w.at(0, room.height_at(w.from))));
  }
  out["measures"] = {{"ceiling_height", room.height},
                     {"floor_area", room.area()},
                     {"perimeter", room.perimeter()},
                     {"wall_lengths", lengths}};
  out["floor"] = {
      {"plane", {0, 0, 1, 0}}, {"outline", outline}, {"assumed", room.floor_assumed}, {"seen", room.floor_seen}};
  Json planes = Json::array();
  for (const CeilingPlane& p : room.ceiling) planes.push_back(plane(p.normal, p.offset));
  out["ceiling"] = {{"height", room.height}, {"lowest", room.lowest},           {"planes", planes},
                    {"outline", top},        {"assumed", room.ceiling_assumed}, {"seen", room.ceiling_seen}};
  for (const char* list : {"walls", "openings", "objects"}) out[list] = Json::array();
  for (size_t i = 0; i < room.walls.size(); ++i) out["walls"].push_back(wall_json(room, i));
  for (size_t i = 0; i < room.openings.size(); ++i) out["openings"].push_back(opening_json(room, i));
  for (const MeasuredBox& box : room.boxes) out["objects"].push_back(box_json(box));
  out["warnings"] = room.warnings;
  round_measures(room.scale_source == ScaleSource::kGiven, out);
  return out;
}

/// A reader that names the field of what is wrong.
class Reader {
 public:
  explicit Reader(std::filesystem::path file) : file_(std::move(file)) {}
  [[noreturn]] void fail(const std::string& field, const std::string& message) const {
    throw_bad_input(file_, field, message, "write it again with: aligngs room RUN");
  }
  const Json& member(const Json& of, const char* name) const {
    if (!of.is_object() || !of.contains(name)) fail(name, "the field is missing");
    return of[name];
  }
  double number(const Json& of, const char* name) const { return number_of(member(of, name), name); }
  double number_of(const Json& value, const char* name) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail(name, "not a finite number");
    return value.get<double>();
  }
  int integer(const Json& of, const char* name) const {
    const std::optional<int> value = integer_in<int>(member(of, name));
    if (!value) fail(name, "not an integer");
    return *value;
  }
  std::string text(const Json& of, const char* name) const {
    if (!member(of, name).is_string()) fail(name, "not a text");
    return of[name].get<std::string>();
  }
  bool flag(const Json& of, const char* name) const {
    if (!member(of, name).is_boolean()) fail(name, "neither true nor false");
    return of[name].get<bool>();
  }
  const Json& list(const Json& of, const char* name, size_t size = 0) const {
    const Json& value = member(of, name);
    if (!value.is_array() || (size > 0 && value.size() != size)) fail(name, "not a list of the expected length");
    return value;
  }

 private:
  std::filesystem::path file_;
};

template <class Enum>
Enum named(const Reader& reader, const std::string& name, int count, const char* field) {
  for (int i = 0; i < count; ++i) {
    if (name == name_of(static_cast<Enum>(i))) return static_cast<Enum>(i);
  }
  reader.fail(field, "\"" + name.substr(0, 40) + "\" is unknown");
}

Similarity read_matrix(const Reader& reader, const Json& rows) {
  Similarity out;
  Mat3d linear;
  for (int r = 0; r < 3; ++r) {
    const Json& row = rows[static_cast<size_t>(r)];
    if (!row.is_array() || row.size() != 4) reader.fail("world_to_room", "not four rows of four numbers");
    for (int c = 0; c < 3; ++c) linear(r, c) = reader.number_of(row[static_cast<size_t>(c)], "world_to_room");
    out.translation[r] = reader.number_of(row[3], "world_to_room");
  }
  out.scale = norm(linear.row(0));
  if (!(out.scale > 0)) reader.fail("world_to_room", "the matrix has no scale");
  for (int k = 0; k < 9; ++k) out.rotation.m[k] = linear.m[k] / out.scale;
  return out;
}

MeasuredWall read_wall(const Reader& reader, const Json& json) {
  MeasuredWall w;
  const Json &from = reader.list(json, "from", 2), &to = reader.list(json, "to", 2),
             &plane = reader.list(json, "plane", 4);
  w.from = {reader.number_of(from[0], "from"), reader.number_of(from[1], "from")};
  w.to = {reader.number_of(to[0], "to"), reader.number_of(to[1], "to")};
  for (int k = 0; k < 3; ++k) w.normal[k] = reader.number_of(plane[static_cast<size_t>(k)], "plane");
  w.height = reader.number(json, "height");
  w.assumed = reader.flag(json, "assumed");
  w.seen = reader.number(json, "seen");
  w.confidence = reader.number(json, "confidence");
  return w;
}

MeasuredOpening read_opening(const Reader& reader, const Json& json, size_t walls) {
  MeasuredOpening o;
  o.kind = named<OpeningKind>(reader, reader.text(json, "kind"), 4, "kind");
  o.class_name = reader.text(json, "class");
  const std::string wall = reader.text(json, "wall");
  o.wall = -1;
  for (size_t i = 0; i < walls; ++i) {
    if (wall == wall_name(i)) o.wall = static_cast<int>(i);
  }
  if (o.wall < 0) reader.fail("wall", "there is no wall of that name");
  o.left = reader.number(json, "left");
  o.right = reader.number(json, "right");
  o.bottom = reader.number(json, "sill");
  o.top = reader.number(json, "top");
  o.seen = reader.number(json, "seen");
  o.confidence = reader.number(json, "confidence");
  return o;
}

/// Place, size and turn of a box.
ShownBox read_plain_box(const Reader& reader, const Json& json) {
  ShownBox b;
  const Json &centre = reader.list(json, "centre", 3), &size = reader.list(json, "size", 3);
  double c[3], s[3];
  for (size_t k = 0; k < 3; ++k) c[k] = reader.number_of(centre[k], "centre"), s[k] = reader.number_of(size[k], "size");
  b.centre = {c[0], c[1]};
  b.width = s[0];
  b.depth = s[1];
  b.bottom = c[2] - s[2] / 2;
  b.top = c[2] + s[2] / 2;
  b.turn = reader.number(json, "turn");
  return b;
}

MeasuredBox read_box(const Reader& reader, const Json& json) {
  MeasuredBox b;
  b.class_name = reader.text(json, "class");
  b.instance = reader.integer(json, "instance");
  const ShownBox whole = read_plain_box(reader, json);
  b.centre = whole.centre;
  b.width = whole.width;
  b.depth = whole.depth;
  b.bottom = whole.bottom;
  b.top = whole.top;
  b.turn = whole.turn;
  if (json.contains("shown")) b.shown = read_plain_box(reader, reader.member(json, "shown"));
  b.support = reader.text(json, "support");
  b.seen = reader.number(json, "seen");
  b.confidence = reader.number(json, "confidence");
  return b;
}

}  // namespace

std::string room_json(const MeasuredRoom& room) { return json_document(document_of(room)); }

void write_room(const std::filesystem::path& file, const MeasuredRoom& room) {
  write_file_atomically(file, room_json(room));
}

double write_scale(const std::filesystem::path& file, const MeasuredRoom& before, const MeasuredRoom& after) {
  constexpr double kRounding = 1e-9;
  const double factor = after.to_room.scale / before.to_room.scale;
  if (std::fabs(factor - 1) > kRounding || after.scale_source != before.scale_source || after.metric != before.metric)
    write_room(file, after);
  return factor;
}

MeasuredRoom read_room(const std::filesystem::path& file) {
  const Reader reader(file);
  const Json json = parse_ordered_json(read_file(file, kLargest));
  if (json.is_discarded() || !json.is_object()) reader.fail("", "not a JSON object");
  if (reader.number(json, "schema") > kRoomSchema) reader.fail("schema", "written by a later version of this program");
  MeasuredRoom room;
  room.metric = reader.text(json, "units") == "metres";
  room.scale_source = named<ScaleSource>(reader, reader.text(reader.member(json, "scale"), "source"), 5, "source");
  // Files of earlier versions have no such field, and labels alone found their rooms.
  if (json.contains("found_by"))
    room.found_by = named<RoomEvidence>(reader, reader.text(json, "found_by"), 2, "found_by");
  room.to_room = read_matrix(reader, reader.list(reader.member(json, "frame"), "world_to_room", 4));
  const Json &floor = reader.member(json, "floor"), &ceiling = reader.member(json, "ceiling");
  room.floor_assumed = reader.flag(floor, "assumed");
  room.floor_seen = reader.number(floor, "seen");
  room.ceiling_assumed = reader.flag(ceiling, "assumed");
  room.ceiling_seen = reader.number(ceiling, "seen");
  room.height = reader.number(ceiling, "height");
  room.lowest = reader.number(ceiling, "lowest");
  for (const Json& p : reader.list(ceiling, "planes")) {
    if (!p.is_array() || p.size() != 4) reader.fail("planes", "not four numbers");
    double v[4];
    for (size_t k = 0; k < 4; ++k) v[k] = reader.number_of(p[k], "planes");
    room.ceiling.push_back({{v[0], v[1], v[2]}, v[3]});
  }
  for (const Json& w : reader.list(json, "walls")) room.walls.push_back(read_wall(reader, w));
  if (room.walls.size() < 3) reader.fail("walls", "fewer than three walls close no room");
  for (size_t i = 0; i < room.walls.size(); ++i) {
    const Vec2d &a = room.walls[i].to, &b = room.walls[(i + 1) % room.walls.size()].from;
    if (a.x != b.x || a.y != b.y) reader.fail("walls", "the walls are not closed");
  }
  for (const Json& o : reader.list(json, "openings"))
    room.openings.push_back(read_opening(reader, o, room.walls.size()));
  for (const Json& b : reader.list(json, "objects")) room.boxes.push_back(read_box(reader, b));
  for (const Json& w : reader.list(json, "warnings")) {
    if (!w.is_string()) reader.fail("warnings", "not a text");
    room.warnings.push_back(w.get<std::string>());
  }
  return room;
}

}  // namespace aligngs
