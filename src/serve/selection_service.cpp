#include "serve/selection_service.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "edit/report_json.h"
#include "io/base64.h"
#include "io/gzip.h"
#include "io/json_text.h"
#include "serve/request_body.h"

namespace aligngs {

using Json = nlohmann::json;

namespace {

constexpr size_t kLongestField = size_t(64) << 10;  // bytes; a body is no longer
constexpr int kPlacesGzipLevel = 6;
constexpr uint32_t kBits = 8;  // of a byte

size_t bytes_of(size_t places) { return (places + kBits - 1) / kBits; }

/// The splats of a path, where their rows are those of the run.
std::shared_ptr<const ShownSplats> splats_of(const SelectionService::Shown& shown, const std::string& path,
                                             size_t rows) {
  auto splats = shown ? shown(path) : nullptr;
  if (!splats || std::any_of(splats->order.begin(), splats->order.end(), [&](uint32_t row) { return row >= rows; }))
    return nullptr;
  return splats;
}

}  // namespace

std::string SelectionService::list() {
  return json_line(Json{{"selections", selections_json(edits_.session().selections())}});
}

std::string SelectionService::save(const std::string& request) {
  const Json json = text_fields(request, {"name", "scene", "splats", "places"}, kLongestField);
  EditSession& session = edits_.session();
  const size_t rows = session.original().origins.size();
  const auto splats = splats_of(shown_, json["scene"].get<std::string>(), rows);
  if (!splats || json["splats"] != std::to_string(splats->order.size()))
    throw_usage("the selection is of other splats than those of the run", "load the page again");
  const auto packed = base64_bytes(json["places"].get_ref<const std::string&>());
  if (!packed) throw_usage("the places of the selection are no base64");
  const size_t bytes = bytes_of(splats->order.size());
  std::string bits;
  try {
    bits = gzip_expanded(*packed, "the places of the selection", bytes);
  } catch (const Error& error) {
    throw_usage("the places of the selection cannot be read: " + error.details().message);
  }
  if (bits.size() != bytes) throw_usage("the selection has another number of places than the splats");
  std::vector<uint8_t> selected(rows, 0);
  for (size_t place = 0; place < splats->order.size(); ++place)
    selected[splats->order[place]] = static_cast<unsigned char>(bits[place / kBits]) >> place % kBits & 1;
  session.save_selection(json["name"].get<std::string>(), selected);
  return list();
}

std::string SelectionService::rename(const std::string& request) {
  const Json json = text_fields(request, {"name", "to"});
  edits_.session().rename_selection(json["name"].get<std::string>(), json["to"].get<std::string>());
  return list();
}

std::string SelectionService::remove(const std::string& request) {
  const Json json = text_fields(request, {"name"});
  edits_.session().remove_selection(json["name"].get<std::string>());
  return list();
}

std::optional<GetAnswer> SelectionService::places(const std::string& path) {
  const size_t slash = path.find('/');
  if (slash == std::string::npos) return {};
  EditSession& session = edits_.session();
  const auto splats = splats_of(shown_, path.substr(slash + 1), session.original().origins.size());
  if (!splats) return {};
  const std::vector<uint8_t> selected = session.selections().usable(path.substr(0, slash)).mask();
  std::string bits(bytes_of(splats->order.size()), '\0');
  for (size_t place = 0; place < splats->order.size(); ++place) {
    if (selected[splats->order[place]])
      bits[place / kBits] = static_cast<char>(bits[place / kBits] | 1 << place % kBits);
  }
  return GetAnswer{"application/octet-stream", gzip_compressed(bits, kPlacesGzipLevel), {}, {}};
}

void SelectionService::serve(ViewServerOptions& options) {
  options.get["/api/selections"] = [this](const std::string&) -> std::optional<GetAnswer> {
    return GetAnswer{"application/json", list(), {}, {}};
  };
  options.get["/api/selections/places/"] = [this](const std::string& path) { return places(path); };
  options.post["/api/selections/save"] = [this](const std::string& body) { return save(body); };
  options.post["/api/selections/rename"] = [this](const std::string& body) { return rename(body); };
  options.post["/api/selections/remove"] = [this](const std::string& body) { return remove(body); };
}

}  // namespace aligngs
