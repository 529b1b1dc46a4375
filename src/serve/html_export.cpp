#include "serve/html_export.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/error.h"
#include "edit/export/export_mesh.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"
#include "io/atomic_file.h"
#include "io/base64.h"
#include "io/gzip.h"
#include "io/json_text.h"
#include "serve/edited_scene.h"
#include "serve/packed_mesh.h"
#include "serve/page_notes.h"
#include "serve/splat_columns.h"
#include "serve/start_pose.h"
#include "serve/web_page.h"

namespace aligngs {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr uint64_t kPageLimit = uint64_t(64) << 20;    // bytes of one file of the page
constexpr uint64_t kMostRunJson = uint64_t(16) << 20;  // bytes of cameras.json or room.json
constexpr size_t kSampleShare = 16;                    // one part of this many of each column is compressed
constexpr double kMeshBytes = 7.7;                     // of a triangle in the file, measured on simplified rooms
constexpr double kWholeMeshBytes = 5.7;                // the same where no triangle is left out: neighbours are close
constexpr size_t kBase64In = 3, kBase64Out = 4;        // bytes

OrderedJson classes_of(const LabelSet& labels) {
  OrderedJson classes = OrderedJson::array();
  for (int i = 0; i < labels.size(); ++i) {
    const LabelClass& c = labels.classes[static_cast<size_t>(i)];
    classes.push_back({{"id", i}, {"name", c.name}, {"synonyms", c.synonyms}, {"color", c.color}});
  }
  return classes;
}

/// A JSON file of the run; null when it is absent or cannot be read.
OrderedJson run_json(const std::filesystem::path& path) {
  try {
    return path.empty() ? OrderedJson() : parse_ordered_json(read_file(path, kMostRunJson));
  } catch (const Error&) {
    return nullptr;
  }
}

std::string page_file(const char* path) {
  const auto content = embedded_page_file(path);
  return gzip_expanded({reinterpret_cast<const char*>(content.data()), content.size()}, path, kPageLimit);
}

void replace_once(std::string& text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  if (at == std::string::npos)
    throw Error({ErrorKind::kFailed, "the page has no " + from, {}, {}, "build web/dist anew"});
  text.replace(at, from.size(), to);
}

/// Neither may be in a script element of HTML.
std::string escaped_script(std::string script) {
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"</script", "<\\/script"}, {"<!--", "<\\!--"}}) {
    for (size_t at = script.find(from); at != std::string::npos; at = script.find(from, at + to.size()))
      script.replace(at, from.size(), to);
  }
  return script;
}

size_t harmonics_of(const GaussianModel& model) {
  return size_t(3) * static_cast<size_t>(sh_coefficient_count(model.sh_degree) - 1);
}

SplatColumns columns_of(const EditableRoom& room, const std::vector<uint32_t>& rows) {
  SplatColumns columns(room.gaussians.model, rows);
  columns.add_positions();
  columns.add_colors(harmonics_of(room.gaussians.model));
  columns.add_shapes();
  columns.add_labels(room.gaussians.labels);
  return columns;
}

/// The gzip stream of what edits did to the splats of the file.
std::string packed_edits(const HtmlParts& parts) {
  const GaussianModel& model = parts.before->gaussians.model;
  return edited_scene(*parts.before, parts.room, {visible_rows(model), harmonics_of(model)});
}

TriangleMesh joined_mesh(const ExportMesh& parts) {
  TriangleMesh all;
  for (const ObjectMesh& object : parts.objects) {
    const uint32_t base = static_cast<uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), object.mesh.vertices.begin(), object.mesh.vertices.end());
    all.colors.insert(all.colors.end(), object.mesh.colors.begin(), object.mesh.colors.end());
    all.labels.resize(all.vertices.size(), object.label < 0 ? kNoLabel : static_cast<uint16_t>(object.label));
    for (const auto& t : object.mesh.triangles) all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  return all;
}

std::string data_element(const char* id, const std::string& gzip) {
  return std::string("<script type=\"text/plain\" id=\"") + id + "\">" + base64_text(gzip) + "</script>\n";
}

std::string mesh_element(const char* id, const EditableRoom& room, const HtmlParts& parts, ThreadPool& pool,
                         HtmlReport* report) {
  if (!parts.mesh || room.mesh.empty()) return {};
  const ExportMesh mesh = export_mesh(room, parts.mesh_options, pool);
  if (report != nullptr) {
    report->triangles = mesh.triangles;
    report->triangles_before = mesh.triangles_before;
  }
  return data_element(id, gzip_compressed(packed_mesh(joined_mesh(mesh))));
}

/// The page with its styles inside, and places for the data and its script.
std::string page_around(const std::string& data) {
  std::string html = page_file("/index.html");
  replace_once(html, "<link rel=\"icon\" href=\"/favicon.svg\">",
               "<link rel=\"icon\" href=\"data:image/svg+xml;base64," + base64_text(page_file("/favicon.svg")) + "\">");
  replace_once(html, "<link rel=\"stylesheet\" href=\"/app.css\">", "<style>\n" + page_file("/app.css") + "</style>");
  replace_once(html, "<script type=\"module\" src=\"/app.js\"></script>\n", "");
  replace_once(html, " src=\"/api/start.jpg\"", " hidden");  // a server draws it
  replace_once(html, "<script src=\"/start.js\"></script>",
               "<script>" + escaped_script(page_file("/start.js")) + "</script>");
  replace_once(html, "</body>",
               data + "<script type=\"module\">\n" + escaped_script(page_file("/app.js")) + "</script>\n</body>");
  // Third-party licences travel with the code.
  std::string licences = page_file("/third_party_licenses.txt");
  for (size_t at = licences.find("--"); at != std::string::npos; at = licences.find("--", at))
    licences.replace(at, 2, "- -");
  return html + "\n<!--\n" + licences + "\n-->\n";
}

constexpr uint64_t as_base64(uint64_t bytes) { return (bytes + kBase64In - 1) / kBase64In * kBase64Out; }

/// Bytes of the splats of a room in a file, from a part of each column.
uint64_t estimated_splats(const EditableRoom& room) {
  const std::vector<uint32_t> rows = visible_rows(room.gaussians.model);
  const SplatColumns columns = columns_of(room, rows);
  const std::string_view data = columns.data();
  const size_t part = rows.size() / kSampleShare;
  std::string sample;
  size_t at = 0;
  for (const auto& column : columns.description()) {
    const std::string type = column["type"];
    const size_t number = type == "f32" ? 4 : type == "i16" || type == "u16" ? 2 : 1;
    sample += data.substr(at + rows.size() / 2 * number, part * number);
    at += rows.size() * number;
  }
  return part == 0 ? as_base64(data.size()) : as_base64(gzip_compressed(sample).size() * kSampleShare);
}

uint64_t estimated_mesh(const EditableRoom& room, const HtmlParts& parts) {
  if (!parts.mesh) return 0;
  const size_t all = room.mesh.triangles.size(), limit = parts.mesh_options.triangles;
  const double kept = static_cast<double>(limit > 0 ? std::min(limit, all) : all);
  const double whole =
      all > 0 ? std::max(0.0, 2 * kept / static_cast<double>(all) - 1) : 1;  // 0: half of them, or fewer
  return static_cast<uint64_t>((kMeshBytes + whole * (kWholeMeshBytes - kMeshBytes)) * kept);
}

}  // namespace

std::string packed_scene(const HtmlParts& parts, const HtmlSceneInfo& info) {
  const EditableRoom &room = parts.room, &stored = parts.before ? *parts.before : room;
  const std::vector<uint32_t> rows = visible_rows(stored.gaussians.model);
  const SplatColumns columns = columns_of(stored, rows);
  const bool meshes = parts.mesh && !room.mesh.empty();
  const OrderedJson measured = info.room_text.empty() ? run_json(info.room) : parse_ordered_json(info.room_text),
                    cameras = run_json(info.cameras);
  OrderedJson state = {{"name", info.name},
                       {"status", "exported"},
                       {"version", std::to_string(std::hash<std::string_view>()(columns.data()))},
                       {"splats", "scene.ply"},
                       {"mesh", meshes ? OrderedJson("mesh.ply") : OrderedJson()},
                       {"units", info.metric ? "metres" : "arbitrary"},
                       {"units_estimated", info.estimated},
                       {"classes", room.gaussians.has_labels() ? classes_of(room.labels) : OrderedJson()}};
  state["up"] = room.up ? OrderedJson{room.up->x, room.up->y, room.up->z} : OrderedJson();
  state["cameras"] = cameras.is_array() ? cameras : OrderedJson();
  const nlohmann::json up = room.up ? nlohmann::json{room.up->x, room.up->y, room.up->z} : nlohmann::json();
  state["start"] = start_pose_json(start_pose(parse_json(cameras.dump()), up));
  state["edited"] = parts.before != nullptr;
  state["edits"] = parts.before != nullptr ? OrderedJson("1") : OrderedJson();
  state["room"] = measured.is_object() ? OrderedJson("room.json") : OrderedJson();
  if (!info.notes.empty() && std::filesystem::exists(info.notes))
    state["notes"] = page_notes_json(read_page_notes(read_file(info.notes, kMostRunJson), info.notes));
  const OrderedJson head = {{"state", state},
                            {"room", measured.is_object() ? measured : OrderedJson()},
                            {"count", rows.size()},
                            {"columns", columns.description()}};
  return head.dump(-1, ' ', true, OrderedJson::error_handler_t::replace) + "\n" + columns.data();
}

HtmlSize estimate_html(const HtmlParts& parts, const HtmlSceneInfo& info) {
  HtmlSize size;
  size.page = page_around("").size();
  for (const std::filesystem::path& file : {info.cameras, info.room})
    size.page += as_base64(run_json(file).dump().size() / 4);
  size.splats = estimated_splats(parts.room);
  size.mesh = estimated_mesh(parts.room, parts);
  if (parts.before != nullptr) {
    const uint64_t both = estimated_splats(*parts.before) + as_base64(packed_edits(parts).size());
    size.before = both > size.splats ? both - size.splats : 0;
    size.before_mesh = estimated_mesh(*parts.before, parts);
  }
  return size;
}

HtmlReport write_html(const std::filesystem::path& path, const HtmlParts& parts, const HtmlSceneInfo& info,
                      ThreadPool& pool) {
  HtmlReport report;
  report.gaussians = visible_rows(parts.room.gaussians.model).size();
  std::string data = data_element("aligngs-scene", gzip_compressed(packed_scene(parts, info)));
  data += mesh_element("aligngs-mesh", parts.room, parts, pool, &report);
  if (parts.before != nullptr) {
    data += data_element("aligngs-edits", packed_edits(parts));
    data += mesh_element("aligngs-mesh-before", *parts.before, parts, pool, nullptr);
  }
  const std::string html = page_around(data);
  report.bytes = html.size();
  write_file_atomically(path, html);
  return report;
}

}  // namespace aligngs
