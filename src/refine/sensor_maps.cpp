#include "refine/sensor_maps.h"

#include "io/npy.h"
#include "io/resample.h"
#include "scene/confidence_file.h"
#include "scene/prior_maps.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

ImageF read_view_map(const View& view, const fs::path& path) {
  FloatArray array = read_map(path);
  const MapShape shape = depth_map_shape(array.shape, path);
  require_same_aspect(shape, view.camera.width, view.camera.height, path, "shape");
  ImageF map;
  map.width = shape.width;
  map.height = shape.height;
  map.channels = 1;
  map.data = std::move(array.data);
  return map;
}

const View& view_of(const Scene& scene, int view) { return scene.views[static_cast<size_t>(view)]; }

}  // namespace

SensorDepth clean_sensor_maps(const Scene& scene, int view, const ImageF& luma, const SensorDepthSettings& settings) {
  const View& v = view_of(scene, view);
  const ImageF depth = read_view_map(v, v.prior_depth);
  const fs::path file = scene.folder / "pred_confidence" / (v.name + ".npy");
  ImageF confidence;
  if (fs::exists(file)) confidence = resize_nearest(read_view_map(v, file), depth.width, depth.height);
  return clean_sensor_depth(v.camera.resized(depth.width, depth.height), depth,
                            confidence.empty() ? nullptr : &confidence, resize_area(luma, depth.width, depth.height),
                            settings);
}

void write_sensor_maps(const Scene& scene, int view, const SensorDepth& maps, const fs::path& folder) {
  const View& v = view_of(scene, view);
  fs::remove(folder / "pred_depths" / v.prior_depth.filename());  // of another format, perhaps
  write_npy_float32(folder / "pred_depths" / (v.name + ".npy"), {maps.depth.height, maps.depth.width},
                    maps.depth.data.data());
  write_confidence(folder, v.name, maps.confidence);
}

}  // namespace aligngs
