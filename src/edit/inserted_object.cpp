#include "edit/inserted_object.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "edit/edit_session.h"
#include "edit/fill/room_planes.h"
#include "edit/mesh_selection.h"
#include "edit/move_objects.h"
#include "edit/object_bounds.h"
#include "edit/object_names.h"
#include "edit/splat_file.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSourceExample = "give FILE.ply or RUN#OBJECT, for example other_run#armchair#1";

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
  SplatFile splats = read_splat_file(file);
  require_object_bounds(splats.model, file);
  out.room.gaussians.model = std::move(splats.model);
  out.class_name = std::move(splats.class_name);
  complete(out.room);
  return out;
}

/// The object of the other run. Its errors speak of --replace: a reader would look for the fault in --select.
GaussianSelection selected_in(const EditableRoom& room, const fs::path& run, const std::string& name,
                              ThreadPool& pool) {
  try {
    return select_gaussians(room.gaussians, read_selection(room, name), {}, room.labels, {}, pool);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kUsage && error.kind() != ErrorKind::kBadInput) throw;
    const std::vector<Instance> objects = list_instances(room.gaussians.model, room.gaussians.labels);
    throw Error({error.kind(), "of the other run: " + error.details().message, run, "--replace",
                 objects.empty() ? "that run has no object with a name"
                                 : "name one of its objects: " + first_objects_text(objects, room.labels)});
  }
}

InsertedObject read_run_object(const std::string& source, ThreadPool& pool) {
  const size_t hash = source.find('#');
  if (hash == std::string::npos || hash == 0 || hash + 1 == source.size())
    throw_usage("\"" + source.substr(0, 80) + "\" is no source of an object", kSourceExample);
  const std::string run = source.substr(0, hash), name = source.substr(hash + 1);
  EditSession session(run, {{}, pool.size()});
  const EditableRoom& room = session.room();
  const GaussianSelection selection = selected_in(room, run, name, pool);
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

bool is_splat_file(const std::string& source) {
  const std::string ending = fs::path(source).extension().string();
  return ending == ".ply" || ending == ".PLY";
}

InsertedObject read_inserted_object(const std::string& source, UpAxis up, ThreadPool& pool) {
  return is_splat_file(source) ? read_file_object(source, up) : read_run_object(source, pool);
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
