#include "scene/import/unknown_layout.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/letter_case.h"
#include "io/file_system_error.h"
#include "io/picture_format.h"
#include "io/text_encoding.h"
#include "scene/import/capture.h"
#include "scene/photo_lookup.h"
#include "scene/photo_places.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// The files of a program's export, and the way to here.
struct ForeignExport {
  std::vector<std::string> files;  ///< all of them are there
  const char* what;
  const char* remedy;
};

constexpr const char* kRecord3d =
    "export it from Record3D as \"EXR + RGB\", and make a transforms.json of it with nerfstudio's `ns-process-data "
    "record3d`";

constexpr const char* kVideoRemedy = "`aligngs run VIDEO -o RUN` takes photos out of a video, and finds their cameras";

const std::vector<ForeignExport>& foreign_exports() {
  static const std::vector<ForeignExport> kAll = {
      {{"metadata.json", "rgb"},
       "this is an export of Record3D, which is not read",
       "nerfstudio's `ns-process-data record3d` makes a transforms.json of it"},
      {{"metadata", "rgbd"}, "this is a capture of Record3D (.r3d), which is not read", kRecord3d},
      {{"lowres_wide.traj"},
       "this is a scan of ARKitScenes, which is not read",
       "write the RGB-D layout of docs/formats.md: images/ depth/ poses/ intrinsics.txt"},
      {{"poses_bounds.npy"},
       "these are poses of LLFF, which are not read",
       "give the COLMAP model that they were made from (sparse/), or a transforms.json"},
      {{"poses.npy"},
       "these are poses of all photos in one array, which is not read",
       "write the RGB-D layout of docs/formats.md, where poses/ has a .txt or .npy for each photo"},
      {{"database.db"},
       "this is a COLMAP project without a model",
       "run `colmap mapper` first, or `aligngs poses` on the photos"},
      {{"sfm_data.json"},
       "this is a model of OpenMVG or AliceVision, which is not read",
       "export it as a COLMAP model"},
      {{"bundle.out"}, "this is a model of Bundler, which is not read", "convert it to a COLMAP model"},
      {{"reconstruction.json"},
       "this is a model of OpenSfM or ODM, which is not read",
       "export it as a COLMAP model (OpenSfM's `bin/opensfm export_colmap`)"},
      {{"cfg_args"},
       "this is a run of another program of Gaussian splats, and no capture",
       "give the data set that it was trained on: its cfg_args names it as source_path"},
      {{"cams", "pair.txt"},
       "these are cameras for MVSNet, which are not read",
       "give the COLMAP model that they were made from (sparse/), or a transforms.json"},
      {{"cameras_sphere.npz"},
       "these are cameras of IDR, NeuS or DTU, which are not read",
       "give the COLMAP model that they were made from (sparse/), or a transforms.json"},
      {{"meta_data.json"},
       "these are cameras of SDFStudio, which are not read",
       "give the data set that they were made from, or a transforms.json"},
      {{"cameras.json"},
       "these are cameras as programs of Gaussian splats write them, which are not read",
       "give the data set that the splats were trained on"},
      {{"dslr", "iphone"},
       "this is a scan of ScanNet++",
       "give its folder dslr/: dslr/colmap and its photos, or a transforms.json"},
  };
  return kAll;
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

std::vector<fs::path> folders_in(const fs::path& folder) {
  constexpr size_t kMost = 200;  // a folder of more folders is no export that was unpacked once too deep
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end && folders.size() < kMost;
       entry.increment(error)) {
    if (!is_hidden(entry->path()) && is_folder(entry->path())) folders.push_back(entry->path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

bool has_ending(const fs::path& file, std::initializer_list<const char*> endings) {
  const std::string ending = lower_case(file.extension().string());
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

bool is_model(const fs::path& file) {
  return has_ending(file, {".ply", ".splat", ".spz", ".sog", ".ksplat", ".obj", ".glb", ".gltf", ".fbx", ".usdz",
                           ".usd", ".usda", ".stl", ".las", ".laz", ".e57", ".xyz", ".pcd", ".dae"});
}

/// "a.zip, b.zip": the first names of the files that `counts` accepts; empty: none.
std::string names_of_files(const fs::path& folder, bool (*counts)(const fs::path&)) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code unreadable;
    if (!is_hidden(entry->path()) && counts(entry->path()) && entry->is_regular_file(unreadable))
      names.push_back(as_utf8(entry->path().filename().string()));
  }
  std::sort(names.begin(), names.end());
  constexpr size_t kShown = 3;
  std::string list;
  for (size_t i = 0; i < names.size() && i < kShown; ++i) list += (i ? ", " : "") + names[i];
  return list + (names.size() > kShown ? ", ..." : "");
}

/// "FOLDER (LAYOUT)" of the nearest folders below that hold something known.
std::vector<std::string> known_below(const fs::path& folder) {
  std::vector<fs::path> level = folders_in(folder);
  constexpr int kLevels = 2;
  for (int depth = 0; depth < kLevels; ++depth) {
    std::vector<std::string> known;
    std::vector<fs::path> next;
    for (const fs::path& place : level) {
      std::error_code unreadable;
      const fs::directory_iterator first(place, unreadable);
      if (unreadable) continue;
      if (const CaptureLayout* layout = recognise_layout(place))
        known.push_back(place.string() + " (" + layout->title + ")");
      const std::vector<fs::path> below = folders_in(place);
      next.insert(next.end(), below.begin(), below.end());
    }
    if (!known.empty()) return known;
    level = std::move(next);
  }
  return {};
}

}  // namespace

bool is_archive(const fs::path& file) {
  return has_ending(file, {".zip", ".tar", ".tgz", ".gz", ".bz2", ".xz", ".7z", ".rar", ".r3d"});
}

void require_capture_folder(const fs::path& folder) {
  if (is_folder(folder)) return require_readable_folder(folder, "give the folder of the capture");
  std::error_code error;
  if (!fs::exists(folder, error))
    throw_bad_input(folder, "", "there is no such folder", "give the folder of the capture");
  if (has_ending(folder, {".r3d"}))
    throw_bad_input(folder, "", "this is a capture of Record3D, which is not read", kRecord3d);
  if (is_archive(folder))
    throw_bad_input(folder, "", "this is an archive, not a folder", "unpack it, and give the folder");
  if (is_video_name(folder)) throw_bad_input(folder, "", "this is a video, which has no cameras yet", kVideoRemedy);
  throw_bad_input(folder, "", "this is a file, not a folder", "give the folder of the capture");
}

void refuse_layout(const fs::path& folder) {
  const fs::path around = data_set_around(folder / "model");  // photos that were given without their cameras
  for (const fs::path& place : {fs::absolute(folder).lexically_normal().parent_path(), around}) {
    const CaptureLayout* layout = place.empty() ? nullptr : recognise_layout(place);
    if (layout)
      throw_bad_input(folder, "layout", "this is none of the known layouts, but the folder around it is",
                      "give " + place.string() + " (" + layout->title + ")");
  }
  if (const std::vector<std::string> known = known_below(folder); !known.empty()) {
    constexpr size_t kShown = 3;
    std::string list;
    for (size_t i = 0; i < known.size() && i < kShown; ++i) list += (i ? ", " : "") + known[i];
    throw_bad_input(folder, "layout", "this is none of the known layouts, but a folder in it is",
                    "give " + list + (known.size() > kShown ? ", or another" : ""));
  }
  std::vector<fs::path> places = folders_in(folder);
  places.insert(places.begin(), folder);
  for (const fs::path& place : places) {
    for (const ForeignExport& program : foreign_exports()) {
      const bool all = std::all_of(program.files.begin(), program.files.end(), [&](const std::string& name) {
        std::error_code error;
        return fs::exists(place / name, error);
      });
      if (all) throw_bad_input(place, "layout", program.what, program.remedy);
    }
  }
  if (const std::string archives = names_of_files(folder, is_archive); !archives.empty())
    throw_bad_input(folder, "layout", "this is none of the known layouts, and holds archives: " + archives,
                    "unpack them, and give the folder with the capture");
  if (const std::string models = names_of_files(folder, is_model); !models.empty())
    throw_bad_input(folder, "layout", "this holds a finished model (" + models + "), and no photos with cameras",
                    "export the photos with their cameras (docs/formats.md has the layouts), or give photos alone to "
                    "`aligngs poses`");
  const fs::path images = images_folder(folder);
  for (const fs::path& place : {folder, images}) {
    if (const std::string photos = names_of_files(place, has_picture_extension); !place.empty() && !photos.empty())
      throw_bad_input(
          folder, "layout", "this holds photos without cameras (" + photos + ")",
          "`aligngs poses` finds cameras of photos, and `aligngs run` does all; with cameras it is one of: " +
              known_layouts());
  }
  if (const std::string videos = names_of_files(folder, is_video_name); !videos.empty())
    throw_bad_input(folder, "layout", "this holds no capture with cameras, but videos: " + videos, kVideoRemedy);
  throw_bad_input(folder, "layout", "this is none of the known layouts", "known: " + known_layouts());
}

}  // namespace aligngs
