#include "edit/object_scores.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "edit/mesh_selection.h"
#include "edit/selection.h"
#include "io/atomic_file.h"
#include "io/json_integer.h"
#include "io/json_text.h"
#include "metrics/point_index.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kLargestList = uint64_t(16) << 20;  // bytes of objects.json
constexpr uint32_t kNoObject = ~0u;
constexpr double kMatch = 0.5;  // IoU of an object that is found

/// True object of each surface point of the run, the first of its name; kNoObject where no truth is near. The floor
/// under a rug is as near as the rug: surface that photos show goes first.
std::vector<uint32_t> true_objects_of(const std::vector<Vec3f>& points, const TriangleMesh& truth,
                                      const std::vector<TrueObject>& objects, const std::vector<Camera>& cameras,
                                      const ObjectScoreOptions& options, ThreadPool& pool) {
  SamplingOptions sampling;
  sampling.points_per_area = 1e4;  // 1 per cm^2: much finer than the threshold
  const SurfaceSamples samples = sample_surface(truth, sampling);
  std::vector<uint32_t> of_vertex(truth.vertices.size(), kNoObject);
  for (uint32_t o = 0; o < objects.size(); ++o) {
    uint32_t same = 0;  // the first of this name
    while (objects[same].name != objects[o].name) ++same;
    for (uint32_t v = objects[o].first; v < objects[o].end; ++v) of_vertex[v] = same;
  }
  const std::vector<uint8_t> seen = seen_points(RayScene(truth), cameras, samples.positions, kOwnSurface, pool);
  std::vector<uint32_t> out(points.size(), kNoObject);
  for (const uint8_t shown : {uint8_t(1), uint8_t(0)}) {
    std::vector<Vec3f> positions;
    std::vector<uint32_t> owners;
    for (size_t i = 0; i < seen.size(); ++i) {
      if (seen[i] != shown) continue;
      positions.push_back(samples.positions[i]);
      owners.push_back(of_vertex[truth.triangles[samples.triangles[i]][0]]);
    }
    const std::vector<Nearest> nearest = PointIndex(std::move(positions)).nearest(points, pool);
    for (size_t i = 0; i < out.size(); ++i) {
      const Nearest& n = nearest[i];
      if (out[i] == kNoObject && n.index != Nearest::kNoPoint && n.distance <= options.threshold)
        out[i] = owners[n.index];
    }
  }
  return out;
}

/// All objects of a room, and all its classes with several objects.
std::vector<SelectionTerm> selectable(const EditableRoom& room) {
  std::vector<SelectionTerm> terms;
  std::map<int, size_t> counts;
  for (const Instance& o : list_instances(room.gaussians.model, room.gaussians.labels)) {
    terms.push_back({o.label, o.number});
    if (++counts[o.label] == 2) terms.push_back({o.label, 0});
  }
  return terms;
}

/// Flag per surface point: two vertices of its triangle or more are selected, as in submesh().
std::vector<uint8_t> selected_points(const EditableRoom& room, const SelectionTerm& term, const SurfaceSamples& surface,
                                     ThreadPool& pool) {
  SelectionQuery query;
  query.include = {term};
  std::vector<uint8_t> flags(surface.positions.size(), 0);
  const GaussianSelection selection = select_gaussians(room.gaussians, query, {}, room.labels, {}, pool);
  const std::vector<uint8_t> vertices =
      select_vertices(room.mesh, room.gaussians.model, selection.mask, room.gaussians.extent, pool);
  for (size_t i = 0; i < flags.size(); ++i) {
    int count = 0;
    for (const uint32_t v : room.mesh.triangles[surface.triangles[i]]) count += vertices[v];
    flags[i] = count >= 2;
  }
  return flags;
}

/// Walls, floor and ceiling, by the name of an object or of a class.
bool is_shell(const std::string& name) {
  const std::string of_class = name.substr(0, name.find('#'));
  return of_class == "wall" || of_class == "floor" || of_class == "ceiling";
}

/// An object of the run that covers a true one.
struct Overlap {
  double iou = 0;
  size_t truth = 0, object = 0;
};

/// Pairs of objects, the largest overlaps first; each object is in one pair at most.
size_t matches(std::vector<Overlap> overlaps) {
  std::stable_sort(overlaps.begin(), overlaps.end(), [](const Overlap& a, const Overlap& b) { return a.iou > b.iou; });
  std::set<size_t> truths, found;
  size_t count = 0;
  for (const Overlap& o : overlaps) {
    if (truths.count(o.truth) || found.count(o.object)) continue;
    truths.insert(o.truth);
    found.insert(o.object);
    ++count;
  }
  return count;
}

/// Walls are one object: their corners say nothing to a selection.
std::vector<TrueObject> with_one_wall(std::vector<TrueObject> objects) {
  for (TrueObject& o : objects) {
    if (o.name.rfind("wall#", 0) == 0) o.name = "wall";
  }
  return objects;
}

}  // namespace

std::vector<TrueObject> read_true_objects(const std::filesystem::path& file, size_t vertices) {
  const auto refuse = [&](const std::string& field, const char* message) {
    throw_bad_input(file, field, message, "make the scene again: aligngs synth");
  };
  const Json document = parse_ordered_json(read_file(file, kLargestList));
  std::vector<TrueObject> out;
  try {
    if (document.at("schema") != 1) refuse("schema", "schema 1 is expected");
    for (const Json& entry : document.at("objects")) {
      const Json& range = entry.at("vertices");
      out.push_back({entry.at("object").get<std::string>(), integer_of<uint32_t>(range.at(0)),
                     integer_of<uint32_t>(range.at(1))});
      if (out.back().first > out.back().end || out.back().end > vertices)
        refuse("objects[" + std::to_string(out.size() - 1) + "].vertices", "the mesh has no such vertices");
    }
  } catch (const std::out_of_range&) {
    refuse("objects", "a number of a vertex is none");
  } catch (const nlohmann::json::exception&) {
    refuse("objects", "a value is missing or of another type");
  }
  return out;
}

std::vector<ObjectScore> score_objects(const EditableRoom& room, const TriangleMesh& truth,
                                       const std::vector<TrueObject>& given, ThreadPool& pool,
                                       const ObjectScoreOptions& options, ObjectDetection* detection) {
  const std::vector<TrueObject> objects = with_one_wall(given);
  if (room.mesh.vertices.empty())
    throw_bad_input({}, "mesh.ply", "the run has no mesh", "make it first: aligngs mesh RUN");
  if (!room.gaussians.has_labels())
    throw_bad_input({}, "labels", "this run was trained without semantics, so that no object has a name",
                    "train a scene that has segmentation_logits/");
  SamplingOptions sampling;
  sampling.points_per_area = options.points_per_area;
  const SurfaceSamples surface = sample_surface(room.mesh, sampling);
  const std::vector<uint32_t> truly = true_objects_of(surface.positions, truth, objects, room.cameras, options, pool);
  std::vector<size_t> sizes(objects.size(), 0);
  for (const uint32_t o : truly) {
    if (o != kNoObject) ++sizes[o];
  }
  std::vector<ObjectScore> scores(objects.size());
  for (size_t o = 0; o < objects.size(); ++o) {
    scores[o].object = objects[o].name;
    scores[o].area = static_cast<double>(sizes[o]) / options.points_per_area;
  }
  std::vector<uint8_t> is_counted(objects.size(), 0);  // of the true ones, for the detection
  for (size_t o = 0; o < objects.size(); ++o)
    is_counted[o] = sizes[o] >= options.least_points && !is_shell(objects[o].name);
  std::vector<Overlap> overlaps;
  size_t found = 0;
  for (const SelectionTerm& term : selectable(room)) {
    const std::vector<uint8_t> chosen = selected_points(room, term, surface, pool);
    std::vector<size_t> both(objects.size(), 0);
    size_t all = 0;
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (!chosen[i] || truly[i] == kNoObject) continue;
      ++all;
      ++both[truly[i]];
    }
    const bool counts = term.instance > 0 && all >= options.least_points &&
                        !is_shell(room.labels.classes.at(static_cast<size_t>(term.label)).name);
    found += counts;
    for (size_t o = 0; o < objects.size(); ++o) {
      const double iou = both[o] ? static_cast<double>(both[o]) / static_cast<double>(all + sizes[o] - both[o]) : 0;
      if (counts && is_counted[o] && iou > kMatch) overlaps.push_back({iou, o, found});
      if (iou <= scores[o].iou) continue;
      scores[o].iou = iou;
      SelectionQuery query;
      query.include = {term};
      scores[o].selection = selection_text(query, room.labels);
    }
  }
  if (detection) {
    detection->truths = static_cast<size_t>(std::count(is_counted.begin(), is_counted.end(), uint8_t(1)));
    detection->found = found;
    detection->right = matches(std::move(overlaps));
  }
  std::vector<ObjectScore> out;
  for (size_t o = 0; o < objects.size(); ++o) {
    if (sizes[o] >= options.least_points) out.push_back(scores[o]);
  }
  return out;
}

}  // namespace aligngs
