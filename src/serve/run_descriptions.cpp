#include "serve/run_descriptions.h"

#include <utility>

#include "core/error.h"
#include "io/json_text.h"
#include "serve/page_notes.h"
#include "serve/request_body.h"
#include "serve/served_file.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr uint64_t kMaxJson = uint64_t(64) << 20;  // bytes of one description file

}  // namespace

const Json& RunDescriptions::object(const fs::path& root, const std::string& name) {
  Entry& found = entry(root, name);
  if (!found.value.is_null() && !found.value.is_object()) found = faulty(name + " is no JSON object");
  return found.value;
}

const Json& RunDescriptions::fault(const fs::path& root, const std::string& name) {
  object(root, name);
  return entry(root, name).fault;
}

Json RunDescriptions::notes(const fs::path& root) {
  const Json& stored = read(root, "page.json");
  if (stored.is_null()) return nullptr;
  try {
    return page_notes_json(read_page_notes(json_line(stored), "page.json"));
  } catch (const Error& error) {
    return faulty(error.what()).value;
  }
}

RunDescriptions::Entry& RunDescriptions::entry(const fs::path& root, const std::string& name) {
  const auto [place, is_new] = files_.try_emplace(root / name);
  if (is_new) place->second = read_now(root, name);
  return place->second;
}

RunDescriptions::Entry RunDescriptions::read_now(const fs::path& root, const std::string& name) {
  const auto file = ServedFile::open(root, name);
  if (!file) return {};
  const auto text = file->content(kMaxJson);
  if (!text) return faulty(name + " is larger than 64 MiB");
  if (json_depth(*text) > kDeepestFile)
    return faulty(name + " is nested deeper than " + std::to_string(kDeepestFile) + " levels");
  Json json = parse_json(*text);
  if (json.is_discarded()) return faulty(name + " is no JSON");  // files of a run take their place whole
  return {std::move(json), nullptr};
}

RunDescriptions::Entry RunDescriptions::faulty(const std::string& told) {
  problems_.push_back(told);
  return {nullptr, told};
}

Json json_field(const Json& object, const char* name) {
  return object.is_object() && object.contains(name) ? object.at(name) : Json();
}

}  // namespace aligngs
