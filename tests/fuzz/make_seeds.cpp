// Writes valid files for the fuzzers to start from: OUT/<target>/<seed>.
#include <cstdio>

#include "core/error.h"
#include "edit/edit_change_file.h"
#include "io/exif_focal_length.h"
#include "io/testing/valid_files.h"
#include "io/zip_archive.h"
#include "io/zip_writer.h"
#include "room/room_json.h"
#include "room/testing/sample_room.h"
#include "scene/segment_file.h"
#include "split_input.h"

namespace aligngs {
namespace {

void make_seeds(const std::filesystem::path& out) {
  namespace valid = valid_files;
  const std::filesystem::path scratch = out / "scratch";
  const auto seed = [&](const char* target, const char* name, const std::string& bytes) {
    write_file_atomically(out / target / name, bytes);
  };
  const std::string array = valid::npy(scratch);
  seed("fuzz_npy", "c_order", array);
  seed("fuzz_npz", "deflated", make_deflated_zip({{"arr_0.npy", array}}));
  seed("fuzz_npz", "stored", make_stored_zip({{"arr_0.npy", array}}));
  const std::string torch = valid::torch(scratch);
  seed("fuzz_torch", "tensor", torch);
  seed("fuzz_weights", "tensors.safetensors", valid::safetensors(scratch));
  const ZipArchive archive(memory_source(torch, "tensor"));
  seed("fuzz_pickle", "tensor", archive.read(*archive.find("archive/data.pkl")));
  seed("fuzz_safetensors", "two", valid::safetensors(scratch));
  seed("fuzz_ply", "binary", valid::binary_ply(scratch));
  seed("fuzz_ply", "ascii", valid::ascii_ply());
  seed("fuzz_image", "exif.jpg", valid::jpeg_with_exif());
  seed("fuzz_image", "grey.jpg", valid::text_of(encode_jpeg(valid::picture(1), 60)));
  seed("fuzz_image", "lossy.webp", valid::webp());
  seed("fuzz_image", "plain.heic", valid::heic());
  seed("fuzz_image", "rgba.png", valid::text_of(encode_png(valid::picture(4))));
  seed("fuzz_gray_png", "16bit", valid::gray_png16(scratch));
  seed("fuzz_gray_png", "8bit", valid::text_of(encode_png(valid::picture(1))));
  write_segments(scratch / "segments.png", {3, 1, {0, 1, SegmentMap::kNone}, {{0, Segment::kStuff}, {19, 2}}});
  seed("fuzz_segments", "chair", read_file(scratch / "segments.png"));
  seed("fuzz_toml", "settings", valid::toml());
  const valid::ColmapFiles binary = valid::colmap(scratch), text = valid::colmap_text();
  seed("fuzz_colmap", "model", join_input(binary.cameras, binary.images, binary.points));
  seed("fuzz_colmap_text", "cameras", text.cameras);
  seed("fuzz_colmap_text", "images", text.images);
  seed("fuzz_colmap_text", "points", text.points);
  seed("fuzz_edits", "two",
       R"({"schema": 1, "edits": [{"operation": "delete", "select": "pillow#2", "threshold": "auto", "fill": true},
    {"operation": "recolor", "select": "sofa", "threshold": "0.25", "color": "#add8e6"}]})");
  seed("fuzz_selection", "list", "pillow, Cushions#2 and the couch");
  seed("fuzz_selection", "exclusion", "everything but wall, floor");
  seed(
      "fuzz_selections", "two",
      R"({"schema": 1, "selections": [{"name": "my corner", "scene": "0123456789abcdef", "gaussians": 300, "rows": "0,12-41,57"},
    {"name": "seat", "scene": "0123456789abcdef", "gaussians": 300, "rows": "299"}]})");
  seed("fuzz_room_list", "table",
       "# room\nkitchen\tphotos/kitchen\t--method colmap\ntrial\tdemo\t-n 50 --config 'a b.toml'\n");
  seed("fuzz_room_list", "tables",
       "options = [\"-n\", \"50\"]\n[[room]]\nname = \"a\"\nsource = \"demo\"\noptions = \"--strict\"\n");
  seed(
      "fuzz_camera_path", "keys.json",
      R"({"format": "aligngs camera path", "version": 1, "keys": [{"time": 0, "eye": [0, 1.5, -2], "target": [0, 1, 0], "fov": 62},
    {"time": 2.5, "eye": [1, 1.5, -1], "target": [0, 1, 0]}, {"time": 4, "eye": [0, 1.5, -2], "target": [0, 1, 0], "fov": 62}]})");
  seed("fuzz_exif", "focal", exif_with_focal_35mm(28));
  seed("fuzz_room_json", "sample", room_json(sample_room::make()));
  seed("fuzz_scene_json", "scene",
       R"({"units": "metres", "up": [0, -1, 0], "to_original": {"scale": 2, "translation": [1, 2, 3]}})");
  seed("fuzz_scene_json", "split", R"({"train": ["a", "b"], "test": ["c"]})");
  seed("fuzz_scene_json", "priors", R"({"depth": {"model": "m", "scale": "metres"}, "semantics": {"kind": "scores"}})");
  seed("fuzz_scene_json", "exposure", R"({"log_gains": {"a": [0.1, 0, -0.2]}})");
  seed(
      "fuzz_page_notes", "views",
      R"({"format": "aligngs page", "version": 1, "views": [{"name": "bed", "eye": [1, 2, 3], "target": [0, 0, -1]}]})");
  EditChange change;
  change.number = 1;
  change.removed = {row_of_edit(0, 3), row_of_edit(0, 4)};
  seed("fuzz_edit_change", "removal", encode_change(change));
  std::filesystem::remove_all(scratch);
}

}  // namespace
}  // namespace aligngs

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds OUT\n");
    return 2;
  }
  try {
    aligngs::make_seeds(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
