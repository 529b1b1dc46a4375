#include "edit/splat_file.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <utility>

#include "core/error.h"
#include "gaussians/gaussian_ply.h"
#include "scene/label_set.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr size_t kMostSplats = 20'000'000;  // Gaussians: more than any room has, 5 GB

/// The header of a PLY file, or what begins a file that is none.
std::string head_of(const std::filesystem::path& file) {
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

}  // namespace

int commonest_label(const std::vector<uint16_t>& labels) {
  std::map<uint16_t, size_t> counts;
  for (const uint16_t label : labels) {
    if (label != kNoLabel) ++counts[label];
  }
  const auto best =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return best == counts.end() ? -1 : best->first;
}

SplatFile read_splat_file(const std::filesystem::path& file) {
  SplatFile out;
  const std::string head = head_of(file);
  const auto has = [&](const char* name) { return head.find(std::string(" ") + name + "\n") != std::string::npos; };
  if (has("label") && has("instance") && has("confidence")) {
    LabelledModel labelled = read_labelled_gaussian_ply(file);
    out.model = std::move(labelled.model);
    out.class_name = class_of_file(head, labelled.labels.label);
  } else {
    out.model = read_gaussian_ply(file);
  }
  const size_t count = out.model.size();
  if (count == 0 || count > kMostSplats) {
    throw_bad_input(file, "element vertex", count == 0 ? "the file has no Gaussians" : "more than 20 million Gaussians",
                    "give a file with the splats of an object or a room");
  }
  return out;
}

}  // namespace aligngs
