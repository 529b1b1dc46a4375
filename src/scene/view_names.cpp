#include "scene/view_names.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>

#include "scene/photo_lookup.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

bool begins_with_drive(const std::string& name) {
  return name.size() >= 2 && std::isalpha(static_cast<unsigned char>(name[0])) && name[1] == ':';
}

std::vector<std::string> parts_below_root(const std::string& image_name) {
  std::string name = slashed_name(image_name);
  if (begins_with_drive(name)) name.erase(0, 2);
  std::vector<std::string> parts;
  for (const fs::path& part : fs::path(name).lexically_normal().relative_path()) {
    if (part != ".." && !part.empty()) parts.push_back(part.string());
  }
  if (parts.empty()) parts.push_back(name);
  return parts;
}

}  // namespace

std::string percent_decoded(const std::string& name) {
  std::string decoded;
  bool any = false;
  for (size_t i = 0; i < name.size(); ++i) {
    if (name[i] != '%') {
      decoded += name[i];
      continue;
    }
    unsigned byte = 0;
    if (i + 2 >= name.size()) return {};
    const char* const end = name.data() + i + 3;
    const auto [stop, error] = std::from_chars(name.data() + i + 1, end, byte, 16);
    if (error != std::errc() || stop != end || byte == 0) return {};
    decoded += static_cast<char>(byte);
    any = true;
    i += 2;
  }
  return any ? decoded : std::string();
}

bool is_absolute_name(const std::string& image_name) {
  const std::string name = slashed_name(image_name);
  return begins_with_drive(name) || fs::path(name).is_absolute();
}

bool leads_elsewhere(const std::string& image_name) {
  const fs::path path(slashed_name(image_name));
  return is_absolute_name(image_name) ||
         std::any_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".."; });
}

std::vector<std::string> without_shared_folders(const std::vector<std::string>& image_names) {
  std::vector<std::vector<std::string>> all;
  for (const std::string& name : image_names) all.push_back(parts_below_root(name));
  if (all.empty()) return {};
  size_t shared = all.front().size() - 1;
  for (const std::vector<std::string>& parts : all) {
    shared = std::min(shared, parts.size() - 1);
    while (!std::equal(parts.begin(), parts.begin() + static_cast<ptrdiff_t>(shared), all.front().begin())) --shared;
  }
  std::vector<std::string> names;
  for (const std::vector<std::string>& parts : all) {
    std::string name;
    for (size_t i = shared; i < parts.size(); ++i) name += (name.empty() ? "" : "/") + parts[i];
    names.push_back(name);
  }
  return names;
}

}  // namespace aligngs
