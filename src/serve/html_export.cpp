#include "serve/html_export.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"
#include "io/atomic_file.h"
#include "io/base64.h"
#include "io/gzip.h"
#include "io/json_text.h"
#include "serve/splat_columns.h"
#include "serve/web_page.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kPageLimit = uint64_t(64) << 20;   // bytes of one file of the page
constexpr uint64_t kMaxCameras = uint64_t(16) << 20;  // bytes of cameras.json

Json classes_of(const LabelSet& labels) {
  Json classes = Json::array();
  for (int i = 0; i < labels.size(); ++i) {
    const LabelClass& c = labels.classes[static_cast<size_t>(i)];
    classes.push_back({{"id", i}, {"name", c.name}, {"synonyms", c.synonyms}, {"color", c.color}});
  }
  return classes;
}

Json cameras_of(const std::filesystem::path& path) {
  try {
    Json cameras = parse_ordered_json(read_file(path, kMaxCameras));
    return cameras.is_array() ? cameras : Json();
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

}  // namespace

std::string packed_scene(const EditableRoom& room, const HtmlSceneInfo& info) {
  const GaussianModel& model = room.gaussians.model;
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < model.size(); ++i) {
    if (opacity_of(model, i) >= kInvisibleOpacity) rows.push_back(i);
  }
  SplatColumns columns(model, rows);
  columns.add_positions();
  columns.add_colors(size_t(3) * static_cast<size_t>(sh_coefficient_count(model.sh_degree) - 1));
  columns.add_shapes();
  columns.add_labels(room.gaussians.labels);
  Json state = {{"name", info.name},
                {"status", "exported"},
                {"version", "1"},
                {"splats", "scene.ply"},
                {"units", info.metric ? "metres" : "arbitrary"},
                {"classes", room.gaussians.has_labels() ? classes_of(room.labels) : Json()}};
  state["up"] = room.up ? Json{room.up->x, room.up->y, room.up->z} : Json();
  state["cameras"] = cameras_of(info.cameras);
  const Json head = {{"state", state}, {"count", rows.size()}, {"columns", columns.description()}};
  return head.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n" + columns.data();
}

void write_html(const std::filesystem::path& path, const EditableRoom& room, const HtmlSceneInfo& info) {
  std::string html = page_file("/index.html");
  const std::string data = base64_text(gzip_compressed(packed_scene(room, info)));
  replace_once(html, "<link rel=\"icon\" href=\"/favicon.svg\">",
               "<link rel=\"icon\" href=\"data:image/svg+xml;base64," + base64_text(page_file("/favicon.svg")) + "\">");
  replace_once(html, "<link rel=\"stylesheet\" href=\"/app.css\">", "<style>\n" + page_file("/app.css") + "</style>");
  replace_once(html, "<script type=\"module\" src=\"/app.js\"></script>\n", "");
  replace_once(html, "</body>",
               "<script type=\"text/plain\" id=\"aligngs-scene\">" + data + "</script>\n<script type=\"module\">\n" +
                   escaped_script(page_file("/app.js")) + "</script>\n</body>");
  // Third-party licences travel with the code.
  std::string licences = page_file("/third_party_licenses.txt");
  for (size_t at = licences.find("--"); at != std::string::npos; at = licences.find("--", at))
    licences.replace(at, 2, "- -");
  write_file_atomically(path, html + "\n<!--\n" + licences + "\n-->\n");
}

}  // namespace aligngs
