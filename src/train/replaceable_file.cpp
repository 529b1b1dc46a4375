#include "train/replaceable_file.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <initializer_list>
#include <string>
#include <string_view>

#include "core/error.h"
#include "io/drawn_picture.h"
#include "io/output_place.h"
#include "scene/data_parts.h"
#include "scene/import/capture.h"
#include "scene/scene_place.h"
#include "train/run_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNothingElse = ": nothing else is written there";
constexpr int kPathLevels = 4;  // folders above a file: a data set's deepest files lie in D/colmap/sparse/0/

bool is_one_of(std::string ending, std::initializer_list<std::string_view> endings) {
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

/// The first bytes of a file, at most `count`.
std::string first_bytes(const fs::path& file, size_t count) {
  std::string bytes(count, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<size_t>(in.gcount()));
  return bytes;
}

/// Pages of runs, of comparisons and of exports name the program in their titles.
bool is_own_page(const fs::path& file) {
  constexpr size_t kHead = 4096;  // bytes
  const std::string head = first_bytes(file, kHead);
  return head.empty() || head.find("<title>aligngs") != std::string::npos;
}

[[noreturn]] void refuse(const fs::path& file, const std::string& what,
                         const std::string& remedy = "name another file") {
  throw Error({ErrorKind::kUsage, what, file, "output", remedy});
}

}  // namespace

void require_replaceable(const fs::path& file, std::string_view own_beginning) {
  std::error_code error;
  const bool there = fs::is_regular_file(file, error);
  if (there && ::access(file.c_str(), W_OK) != 0)
    throw_resources(file, "this file is protected against writing: it is not replaced",
                    "let it be written (chmod u+w), or name another file");
  const std::string ending = file.extension().string();
  if (there && is_one_of(ending, {".png", ".jpg", ".jpeg", ".webp", ".mp4", ".mov"}) && !has_drawn_mark(file))
    refuse(file, "this picture or video was not drawn by aligngs: it is never replaced");
  if (there && is_one_of(ending, {".html", ".htm"}) && !is_own_page(file))
    refuse(file, "this page was not written by aligngs: it is never replaced");
  const bool own = there && !own_beginning.empty() && first_bytes(file, own_beginning.size()) == own_beginning;
  if (there && !own_beginning.empty() && !own)
    refuse(file, "this file was not written by aligngs: it is never replaced",
           "name another place, or move this file away");
  const fs::path place = real_place(file);
  fs::path folder = place.parent_path();
  for (int level = 0; level < kPathLevels && folder != folder.parent_path(); ++level, folder = folder.parent_path()) {
    const RunFolder run(folder);
    if (run.has_run()) {  // its transforms.json and sparse/ make no data set of it
      if (run.wrote(place)) refuse(file, "this place belongs to the run " + folder.string() + kNothingElse);
      continue;
    }
    if (is_own_scene(folder)) refuse(file, "this place belongs to the scene " + folder.string() + kNothingElse);
    const fs::path first = *place.lexically_relative(folder).begin();
    const bool foreign = there && !own;
    const bool owned = level > 0 ? foreign || is_data_part(folder / first)
                                 : foreign && is_one_of(ending, {".ply", ".obj", ".json", ".txt", ".csv"});
    if (owned && recognise_layout(folder) != nullptr)
      refuse(file, "this place belongs to the data set " + folder.string() + kNothingElse);
  }
}

}  // namespace aligngs
