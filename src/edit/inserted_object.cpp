#include "edit/inserted_object.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "core/error.h"
#include "edit/edit_session.h"
#include "edit/fill/room_planes.h"
#include "edit/mesh_selection.h"
#include "edit/move_objects.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/gaussian_ply.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr size_t kMostInserted = 20'000'000;  // Gaussians: more than any room has, 5 GB
constexpr const char* kSourceExample = "give FILE.ply or RUN#OBJECT, for example other_run#armchair#1";

bool ends_in_ply(const std::string& text) {
  const std::string ending = fs::path(text).extension().string();
  return ending == ".ply" || ending == ".PLY";
}

/// The class that most Gaussians of a labelled file have; -1: none.
int commonest_label(const std::vector<uint16_t>& labels) {
  std::map<uint16_t, size_t> counts;
  for (const uint16_t label : labels) {
    if (label != kNoLabel) ++counts[label];
  }
  const auto best =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return best == counts.end() ? -1 : best->first;
}

/// The header of a PLY file, or what begins a file that is none.
std::string head_of(const fs::path& file) {
  constexpr size_t kLongestHead = 8192;  // bytes: a header of this program has 2300
  std::ifstream in(file, std::ios::binary);
  std::string head(kLongestHead, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(in.gcount()));
  return head.substr(0, head.find("end_header"));
}

/// The commonest class of a labelled file, where it says that its label set is one that this program knows.
std::string class_of_file(const std::string& head, const std::vector<uint16_t>& labels) {
  const int label = commonest_label(labels);
  const LabelSet& known = ade20k_labels();
  if (label < 0 || static_cast<size_t>(label) >= known.classes.size()) return {};
  const bool same = head.find("comment aligngs label_set " + known.name + "\n") != std::string::npos;
  return same ? known.classes[static_cast<size_t>(label)].name : std::string();
}

/// Labels and origins of no meaning yet, one per Gaussian.
void complete(EditableRoom& room) {
  const size_t n = room.gaussians.model.size();
  room.gaussians.model.semantic_channels = 0;
  room.gaussians.model.semantics.clear();
  room.gaussians.soft = {};
  room.gaussians.labels.label.resize(n, kNoLabel);
  room.gaussians.labels.instance.resize(n, 0);
  room.gaussians.labels.confidence.resize(n, 255);
  room.origins.assign(n, {});
}

InsertedObject read_file_object(const std::string& source, UpAxis up) {
  const fs::path file(source);
  if (!fs::is_regular_file(file))
    throw Error({ErrorKind::kUsage, "there is no such file of splats", file, "--replace", kSourceExample});
  InsertedObject out;
  out.up = direction_of(up);
  out.front = out.up.z != 0 ? Vec3d{0, -1, 0} : Vec3d{0, 0, 1};
  const std::string head = head_of(file);
  const auto has = [&](const char* name) { return head.find(std::string(" ") + name + "\n") != std::string::npos; };
  if (has("label") && has("instance") && has("confidence")) {
    LabelledModel labelled = read_labelled_gaussian_ply(file);
    out.room.gaussians.model = std::move(labelled.model);
    out.class_name = class_of_file(head, labelled.labels.label);
  } else {
    out.room.gaussians.model = read_gaussian_ply(file);
  }
  const size_t count = out.room.gaussians.model.size();
  if (count == 0 || count > kMostInserted) {
    throw_bad_input(file, "element vertex", count == 0 ? "the file has no Gaussians" : "more than 20 million Gaussians",
                    "give the splats of one object");
  }
  complete(out.room);
  return out;
}

InsertedObject read_run_object(const std::string& source, ThreadPool& pool) {
  const size_t hash = source.find('#');
  if (hash == std::string::npos || hash == 0 || hash + 1 == source.size())
    throw_usage("\"" + source.substr(0, 80) + "\" is no source of an object", kSourceExample);
  const std::string run = source.substr(0, hash), name = source.substr(hash + 1);
  EditSession session(run, {{}, pool.size()});
  const EditableRoom& room = session.room();
  const SelectionQuery query = read_selection(room, name);
  const GaussianSelection selection = select_gaussians(room.gaussians, query, {}, room.labels, {}, pool);
  InsertedObject out;
  out.metric = session.scene().metric;
  if (!room.up)
    throw_bad_input(run, "up", "this run does not tell which way is up", "give its scene `up` in scene.json");
  out.up = *room.up;
  out.front = wall_behind(room, selection.mask);
  out.room = piece_of(room, selection.mask,
                      select_vertices(room.mesh, room.gaussians.model, selection.mask, room.gaussians.extent, pool));
  const int label = commonest_label(out.room.gaussians.labels.label);
  if (label >= 0) out.class_name = room.labels.classes.at(static_cast<size_t>(label)).name;
  complete(out.room);
  return out;
}

}  // namespace

InsertedObject read_inserted_object(const std::string& source, UpAxis up, ThreadPool& pool) {
  return ends_in_ply(source) ? read_file_object(source, up) : read_run_object(source, pool);
}

std::shared_ptr<const InsertedObject> inserted_by(const EditChange& change, const EditableRoom& room) {
  if (change.inserted == 0 || change.inserted > change.added.size()) return nullptr;
  auto out = std::make_shared<InsertedObject>();
  const size_t first = change.added.size() - change.inserted;
  out->placed = true;
  out->up = room.up.value_or(Vec3d{0, 0, 1});
  LabelledGaussians all;
  all.model = change.added.model;
  all.labels.label = change.added.label;
  all.labels.instance = change.added.instance;
  all.labels.confidence = change.added.confidence;
  std::vector<uint8_t> keep(change.added.size(), 0);
  std::fill(keep.begin() + static_cast<std::ptrdiff_t>(first), keep.end(), uint8_t(1));
  out->room.gaussians = keep_rows(std::move(all), keep);
  const uint16_t label = out->room.gaussians.labels.label.front();
  if (label != kNoLabel && label < room.labels.classes.size()) out->class_name = room.labels.classes[label].name;
  const size_t triangles = change.added_mesh.triangles.size();
  std::vector<uint32_t> last;
  for (size_t t = triangles - std::min<size_t>(triangles, change.inserted_triangles); t < triangles; ++t)
    last.push_back(static_cast<uint32_t>(t));
  if (!last.empty()) out->room.mesh = submesh(change.added_mesh, last);
  complete(out->room);
  return out;
}

std::optional<Vec3d> wall_behind(const EditableRoom& room, const std::vector<uint8_t>& selected) {
  constexpr double kBehind = 0.15;   // / extent: 45 cm in a room
  constexpr double kNearest = 0.05;  // share of the object: strays nearer to the wall do not count
  const LabelledGaussians& g = room.gaussians;
  if (!g.has_labels()) return std::nullopt;
  std::optional<Vec3d> best;
  double nearest = kBehind * g.extent;
  for (const RoomPlane& plane :
       room_planes(g, carrying_classes(room.labels), selected, place_inside(g, room.cameras))) {
    if (plane.kind != PlaneKind::kWall) continue;
    std::vector<double> heights;
    for (size_t i = 0; i < selected.size(); ++i) {
      if (selected[i]) heights.push_back(plane.height(position_of(g.model, i)));
    }
    const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kNearest * static_cast<double>(heights.size()));
    std::nth_element(heights.begin(), low, heights.end());
    if (std::fabs(*low) >= nearest) continue;
    nearest = std::fabs(*low);
    best = plane.normal;
  }
  return best;
}

}  // namespace aligngs
