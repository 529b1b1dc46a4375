#include "edit/edit_change_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/gzip.h"
#include "io/json_integer.h"
#include "io/json_text.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int kChangeSchema = 1;
constexpr int kGzipLevel = 1;  // 0.1 s for the largest edits of a room; higher levels save a tenth of the bytes
constexpr uint64_t kLargest = uint64_t(8) << 30;  // bytes
constexpr size_t kColorNumbers = size_t(3) * kShCoefficients;
constexpr const char* kEnding = ".edit";
constexpr size_t kDigestDigits = 16;

template <class T>
void put(std::string& out, const std::vector<T>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

template <class T>
std::vector<T> take(ByteReader& reader, uint64_t count, const char* field) {
  reader.count_of(count, sizeof(T), field);
  const std::string_view bytes = reader.take(count * sizeof(T), field);
  std::vector<T> out(count);
  if (count > 0) std::memcpy(static_cast<void*>(out.data()), bytes.data(), bytes.size());
  return out;
}

/// Lengths of the lists, in the order of the file.
struct Counts {
  uint64_t removed = 0, colored = 0, relabelled = 0, added = 0, triangles = 0, vertices = 0, added_vertices = 0,
           added_triangles = 0;
  bool normals = false, colors = false, labels = false;  ///< attributes of the added mesh
};

Json json_of(const Counts& c) {
  return {{"removed", c.removed},
          {"colored", c.colored},
          {"relabelled", c.relabelled},
          {"added", c.added},
          {"triangles", c.triangles},
          {"vertices", c.vertices},
          {"added_vertices", c.added_vertices},
          {"added_triangles", c.added_triangles},
          {"normals", c.normals},
          {"colors", c.colors},
          {"labels", c.labels}};
}

Counts counts_of(const Json& j) {
  Counts c;
  c.removed = integer_of<uint64_t>(j.at("removed"));
  c.colored = integer_of<uint64_t>(j.at("colored"));
  c.relabelled = integer_of<uint64_t>(j.at("relabelled"));
  c.added = integer_of<uint64_t>(j.at("added"));
  c.triangles = integer_of<uint64_t>(j.at("triangles"));
  c.vertices = integer_of<uint64_t>(j.at("vertices"));
  c.added_vertices = integer_of<uint64_t>(j.at("added_vertices"));
  c.added_triangles = integer_of<uint64_t>(j.at("added_triangles"));
  c.normals = j.at("normals").get<bool>();
  c.colors = j.at("colors").get<bool>();
  c.labels = j.at("labels").get<bool>();
  return c;
}

std::vector<uint16_t> classes_of(const Json& list) {
  std::vector<uint16_t> classes;
  for (const Json& value : list) classes.push_back(integer_of<uint16_t>(value));
  return classes;
}

void read_head(const Json& head, EditChange& change) {
  change.number = integer_of<uint32_t>(head.at("number"));
  change.base = std::stoull(head.at("base").get<std::string>(), nullptr, 16);
  change.classes = classes_of(head.at("classes"));
  change.asked = classes_of(head.at("asked"));
  change.asked_everything = head.at("asked_everything").get<bool>();
  for (int a = 0; a < 3; ++a) {
    change.low[a] = head.at("low").at(static_cast<size_t>(a)).get<float>();
    change.high[a] = head.at("high").at(static_cast<size_t>(a)).get<float>();
  }
  if (head.contains("inserted")) {
    change.inserted = integer_of<uint64_t>(head.at("inserted"));
    change.inserted_triangles = integer_of<uint64_t>(head.at("inserted_triangles"));
  }
  if (!head.contains("color")) return;
  const Json& color = head.at("color");
  ColorChange c;
  c.kind = color.at("operation").get<std::string>() == edit_kind_name(EditKind::kHighlight) ? EditKind::kHighlight
                                                                                            : EditKind::kRecolor;
  c.color = parse_color(color.at("color").get<std::string>());
  c.mean = color.at("mean").get<float>();
  change.colors = std::move(c);
}

Json head_of(const EditChange& change, const Counts& counts) {
  Json head = {{"schema", kChangeSchema},
               {"number", change.number},
               {"base", fmt::format("{:016x}", change.base)},
               {"classes", change.classes},
               {"asked", change.asked},
               {"asked_everything", change.asked_everything},
               {"low", {change.low.x, change.low.y, change.low.z}},
               {"high", {change.high.x, change.high.y, change.high.z}},
               {"counts", json_of(counts)}};
  if (change.inserted > 0) {
    head["inserted"] = change.inserted;
    head["inserted_triangles"] = change.inserted_triangles;
  }
  if (change.colors) {
    head["color"] = {{"operation", edit_kind_name(change.colors->kind)},
                     {"color", color_text(change.colors->color)},
                     {"mean", change.colors->mean}};
  }
  return head;
}

void read_lists(ByteReader& reader, const Counts& n, EditChange& change) {
  change.removed = take<RowId>(reader, n.removed, "removed");
  if (change.colors) change.colors->rows = take<RowId>(reader, n.colored, "colored");
  change.relabelled = take<RowId>(reader, n.relabelled, "relabelled");
  change.label = take<uint16_t>(reader, n.relabelled, "relabelled");
  change.instance = take<uint16_t>(reader, n.relabelled, "relabelled");
  AddedGaussians& added = change.added;
  reader.count_of(n.added, kColorNumbers * sizeof(float), "added");
  added.model.positions = take<float>(reader, 3 * n.added, "added");
  added.model.log_scales = take<float>(reader, 3 * n.added, "added");
  added.model.rotations = take<float>(reader, 4 * n.added, "added");
  added.model.opacity_logits = take<float>(reader, n.added, "added");
  added.model.sh = take<float>(reader, kColorNumbers * n.added, "added");
  added.label = take<uint16_t>(reader, n.added, "added");
  added.instance = take<uint16_t>(reader, n.added, "added");
  added.confidence = take<uint8_t>(reader, n.added, "added");
  added.source = take<uint32_t>(reader, n.added, "added");
  change.removed_triangles = take<RowId>(reader, n.triangles, "triangles");
  change.recolored_vertices = take<RowId>(reader, n.vertices, "vertices");
  change.vertex_colors = take<std::array<uint8_t, 3>>(reader, n.vertices, "vertices");
  TriangleMesh& mesh = change.added_mesh;
  mesh.vertices = take<Vec3f>(reader, n.added_vertices, "added_vertices");
  if (n.normals) mesh.normals = take<Vec3f>(reader, n.added_vertices, "added_vertices");
  if (n.colors) mesh.colors = take<std::array<uint8_t, 3>>(reader, n.added_vertices, "added_vertices");
  if (n.labels) mesh.labels = take<uint16_t>(reader, n.added_vertices, "added_vertices");
  mesh.triangles = take<std::array<uint32_t, 3>>(reader, n.added_triangles, "added_triangles");
  for (const auto& t : mesh.triangles) {
    for (const uint32_t v : t) {
      if (v >= n.added_vertices) reader.fail("added_triangles", "a triangle has a vertex that is not there");
    }
  }
}

}  // namespace

std::string encode_change(const EditChange& change) {
  const TriangleMesh& mesh = change.added_mesh;
  Counts n;
  n.removed = change.removed.size();
  n.colored = change.colors ? change.colors->rows.size() : 0;
  n.relabelled = change.relabelled.size();
  n.added = change.added.size();
  n.triangles = change.removed_triangles.size();
  n.vertices = change.recolored_vertices.size();
  n.added_vertices = mesh.vertices.size();
  n.added_triangles = mesh.triangles.size();
  n.normals = !mesh.normals.empty();
  n.colors = !mesh.colors.empty();
  n.labels = !mesh.labels.empty();
  std::string out = json_line(head_of(change, n)) + "\n";
  put(out, change.removed);
  if (change.colors) put(out, change.colors->rows);
  put(out, change.relabelled);
  put(out, change.label);
  put(out, change.instance);
  put(out, change.added.model.positions);
  put(out, change.added.model.log_scales);
  put(out, change.added.model.rotations);
  put(out, change.added.model.opacity_logits);
  put(out, change.added.model.sh);
  put(out, change.added.label);
  put(out, change.added.instance);
  put(out, change.added.confidence);
  put(out, change.added.source);
  put(out, change.removed_triangles);
  put(out, change.recolored_vertices);
  put(out, change.vertex_colors);
  put(out, mesh.vertices);
  put(out, mesh.normals);
  put(out, mesh.colors);
  put(out, mesh.labels);
  put(out, mesh.triangles);
  return gzip_compressed(out, kGzipLevel);
}

EditChange decode_change(const std::string& bytes, const fs::path& name_for_errors) {
  const auto refuse = [&](const char* field, const char* message) {
    throw_bad_input(name_for_errors, field, message, "undo this edit and make it again");
  };
  const std::string text = gzip_expanded(bytes, name_for_errors, kLargest);
  const size_t line = text.find('\n');
  if (line == std::string::npos) refuse("", "this is no change of an edit");
  const Json head = parse_ordered_json(text.substr(0, line));
  EditChange change;
  Counts counts;
  try {
    if (!head.is_object() || head.at("schema") != kChangeSchema) refuse("schema", "schema 1 is expected");
    read_head(head, change);
    counts = counts_of(head.at("counts"));
  } catch (const std::logic_error&) {  // numbers that are none
    refuse("head", "a value is damaged");
  } catch (const nlohmann::json::exception&) {
    refuse("head", "a value is missing or of another type");
  }
  ByteReader reader(std::string_view(text).substr(line + 1), name_for_errors);
  read_lists(reader, counts, change);
  if (reader.remaining() != 0) reader.fail("end", "there are bytes beyond the end");
  return change;
}

std::string write_change(const fs::path& folder, const EditChange& change) {
  const std::string bytes = encode_change(change);
  uint64_t digest = 0xcbf29ce484222325u;  // FNV-1a
  for (const char c : bytes) digest = (digest ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  const std::string name = fmt::format("{:04}-{:016x}{}", change.number, digest, kEnding);
  write_file_atomically(folder / name, bytes);
  return name;
}

EditChange read_change(const fs::path& file) { return decode_change(read_file(file, kLargest), file); }

bool is_change_name(const std::string& name) {
  const size_t dash = name.find('-');
  const std::string ending = kEnding;
  if (dash == std::string::npos || dash < 4 || name.size() != dash + 1 + kDigestDigits + ending.size() ||
      !name.ends_with(ending))
    return false;
  const auto digits = [&](size_t from, size_t to, const char* of) {
    return name.substr(from, to - from).find_first_not_of(of) == std::string::npos;
  };
  return digits(0, dash, "0123456789") && digits(dash + 1, dash + 1 + kDigestDigits, "0123456789abcdef");
}

}  // namespace aligngs
