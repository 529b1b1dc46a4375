#include "io/output_place.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/letter_case.h"
#include "io/file_system_error.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Extensions of scenes, meshes, splats, pictures, videos, tables, pages and weights.
constexpr std::array<std::string_view, 48> kKnownExtensions = {
    ".ply", ".glb",  ".gltf", ".obj", ".sog",  ".spz",  ".splat", ".ksplat", ".usd",  ".usda", ".usdc", ".usdz",
    ".stl", ".fbx",  ".html", ".htm", ".csv",  ".json", ".png",   ".jpg",    ".jpeg", ".zip",  ".svg",  ".dxf",
    ".pdf", ".dae",  ".3ds",  ".xyz", ".pcd",  ".las",  ".laz",   ".e57",    ".mp4",  ".mov",  ".mkv",  ".webm",
    ".gif", ".webp", ".heic", ".tif", ".tiff", ".bmp",  ".tsv",   ".txt",    ".toml", ".bin",  ".npz",  ".npy"};

/// How files of a format begin; formats without such a mark are not listed.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kBeginnings = {{{".ply", "ply"},
                                                                                       {".glb", "glTF"},
                                                                                       {".sog", "PK"},
                                                                                       {".usdz", "PK"},
                                                                                       {".spz", "\x1f\x8b"},
                                                                                       {".usda", "#usda"},
                                                                                       {".html", "<!"},
                                                                                       {".pdf", "%PDF"},
                                                                                       {".png", "\x89PNG"}}};

/// Whether a file may be an earlier output of the format, under a name without its extension.
bool begins_as(const fs::path& file, const std::string& extension) {
  const auto known = std::find_if(kBeginnings.begin(), kBeginnings.end(),
                                  [&](const auto& beginning) { return beginning.first == extension; });
  if (known == kBeginnings.end()) return false;
  std::string begin(known->second.size(), '\0');
  std::ifstream in(file, std::ios::binary);
  return in.read(begin.data(), static_cast<std::streamsize>(begin.size())) && begin == known->second;
}

}  // namespace

fs::path real_place(const fs::path& path) {
  std::error_code error;
  fs::path place = fs::weakly_canonical(fs::absolute(path), error);
  if (error) place = fs::absolute(path).lexically_normal();
  if (place.filename().empty() && place.has_relative_path()) place = place.parent_path();  // "out/" means "out"
  return place;
}

bool lies_within(const fs::path& path, const fs::path& folder) {
  const fs::path around = real_place(folder);
  for (fs::path place = real_place(path);; place = place.parent_path()) {
    std::error_code error;
    // of what is not there: an error, and false
    if (place == around || fs::equivalent(place, around, error)) return true;
    if (place == place.parent_path()) return false;
  }
}

void require_apart(const fs::path& output, const std::vector<fs::path>& sources) {
  for (const fs::path& source : sources) {
    if (source.empty()) continue;
    const bool inside = lies_within(output, source);
    if (!inside && !lies_within(source, output)) continue;
    const std::string what = inside ? "this is the source, or lies in it" : "the source lies in it";
    throw Error({ErrorKind::kUsage, what + " (" + source.string() + "): a source is never changed", output, "output",
                 "choose a folder outside of the source"});
  }
}

void require_file_place(const fs::path& file) {
  const auto refuse = [&](const std::string& what) {
    throw Error({ErrorKind::kUsage, what, file, "output", "name a file"});
  };
  if (file.empty() || file == "-") refuse("this is no name of a file; nothing is written to standard output");
  if (file.filename().empty()) refuse("this is the name of a folder");
  std::error_code error;
  const fs::file_type type = fs::status(file, error).type();
  if (type == fs::file_type::directory) refuse("this is a folder");
  if (fs::exists(fs::file_status(type)) && type != fs::file_type::regular)
    refuse("this is a device or a pipe, which a file would replace");
}

void require_extension(const fs::path& file, const std::string& format) {
  const std::string extension = lower_case(format);
  const std::string has = lower_case(file.extension().string());
  const std::string wanted = "." + extension.substr(extension.rfind('.') + 1);
  for (const char* longer : {"labels.ply", "collision.glb"}) {  // a name that says more than its extension
    const std::string ending = std::string(".") + longer;
    if (extension == longer || !lower_case(file.filename().string()).ends_with(ending)) continue;
    throw Error({ErrorKind::kUsage, std::string("the name says ") + longer + ", but " + extension + " would be written",
                 file, "output", "choose another name, or ask for -f " + std::string(longer)});
  }
  if (has == wanted || (wanted == ".html" && has == ".htm")) return;
  if (std::find(kKnownExtensions.begin(), kKnownExtensions.end(), has) == kKnownExtensions.end()) {
    std::error_code error;
    if (!fs::is_regular_file(file, error) || begins_as(file, wanted)) return;
    throw Error({ErrorKind::kUsage, "a file of another kind is there: it is never replaced", file, "output",
                 "name a file that ends in " + wanted});
  }
  throw Error({ErrorKind::kUsage, "the name says " + has.substr(1) + ", but " + wanted.substr(1) + " would be written",
               file, "output", "name a file that ends in " + wanted + ", or ask for the other format"});
}

void require_folder_place(const fs::path& folder) {
  const auto refuse = [&](const std::string& what) {
    throw Error({ErrorKind::kUsage, what, folder, "output", "name a folder"});
  };
  if (folder.empty() || folder == "-") refuse("this is no name of a folder; nothing is written to standard output");
  std::error_code error;
  if (fs::exists(folder, error) || fs::is_symlink(folder, error)) return;
  const fs::path around = nearest_existing(real_place(folder).parent_path());
  if (!fs::is_directory(around, error)) refuse("there is a file in its way: " + around.string());
  const fs::path probe = around / (".aligngs-probe-" + std::to_string(::getpid()));
  fs::create_directory(probe, error);
  if (error)
    throw_resources(folder, "the folder cannot be created: " + error.message(), remedy_for_write(error.value()));
  fs::remove(probe, error);
}

void require_empty_folder_place(const fs::path& folder, const TakenFolder& taken) {
  std::error_code error;
  if (!fs::exists(folder, error)) return require_folder_place(folder);
  if (fs::is_directory(folder, error) && fs::is_empty(folder, error)) return;
  throw Error({ErrorKind::kUsage, taken.what, folder, taken.field, taken.remedy});
}

void require_output_file(const fs::path& file) {
  require_file_place(file);
  const fs::path folder = real_place(file).parent_path();
  std::error_code error;
  if (!fs::exists(folder, error)) return require_folder_place(folder);
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return;
  const int reason = errno;
  throw_resources(file, "its folder takes no new file: " + std::generic_category().message(reason),
                  remedy_for_write(reason));
}

}  // namespace aligngs
