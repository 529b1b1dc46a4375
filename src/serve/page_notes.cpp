#include "serve/page_notes.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "serve/plain_run.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr const char* kNotesFormat = "aligngs page";
constexpr int kNotesVersion = 1;
constexpr size_t kMostNotes = 200;                     // of each list: what a person looks through
constexpr size_t kLongestNoteName = 200;               // bytes
constexpr double kFarthestNote = 1e6;                  // scene units
constexpr uint64_t kLargestNotes = uint64_t(1) << 20;  // bytes of page.json
constexpr const char* kNotesRemedy = "repair the file, or remove it to forget views and measurements";

std::array<double, 3> place_of(const Json& entry, const char* name, const std::string& field, const fs::path& file) {
  std::array<double, 3> out{};
  const auto it = entry.is_object() ? entry.find(name) : entry.end();
  bool whole = entry.is_object() && it != entry.end() && it->is_array() && it->size() == out.size();
  for (size_t k = 0; whole && k < out.size(); ++k) {
    whole = (*it)[k].is_number();
    if (whole) out[k] = (*it)[k].get<double>();
    whole = whole && std::isfinite(out[k]) && std::fabs(out[k]) <= kFarthestNote;
  }
  if (!whole) throw_bad_input(file, field + "." + name, "a place is not three numbers up to a million", kNotesRemedy);
  return out;
}

/// Nothing where the view shows the whole room.
std::optional<std::array<double, 6>> cut_of(const Json& entry, const std::string& field, const fs::path& file) {
  const auto it = entry.find("cut");
  if (it == entry.end() || it->is_null()) return std::nullopt;
  std::array<double, 6> out{};
  bool whole = it->is_array() && it->size() == out.size();
  for (size_t k = 0; whole && k < out.size(); ++k) {
    whole = (*it)[k].is_number();
    if (whole) out[k] = (*it)[k].get<double>();
    whole = whole && out[k] >= 0 && out[k] <= 1 && (k % 2 == 0 || out[k - 1] < out[k]);
  }
  if (!whole)
    throw_bad_input(file, field + ".cut", "a cut is not six shares that rise in pairs, from 0 to 1", kNotesRemedy);
  return out;
}

const Json& list_of(const Json& notes, const char* name, const fs::path& file) {
  static const Json kNone = Json::array();
  const auto it = notes.find(name);
  if (it == notes.end()) return kNone;
  if (!it->is_array()) throw_bad_input(file, name, "this is no list", kNotesRemedy);
  if (it->size() > kMostNotes)
    throw_bad_input(file, name, "the list has more than " + std::to_string(kMostNotes) + " entries", "remove some");
  return *it;
}

}  // namespace

PageNotes read_page_notes(const std::string& text, const fs::path& name_for_errors) {
  const Json json = parse_json(text);
  if (!json.is_object()) throw_bad_input(name_for_errors, {}, "this is no JSON object", kNotesRemedy);
  const auto format = json.find("format"), version = json.find("version");
  if (format == json.end() || *format != kNotesFormat || version == json.end() || *version != kNotesVersion)
    throw_bad_input(name_for_errors, "format", "these are no views and measurements of this program", kNotesRemedy);
  PageNotes notes;
  for (const Json& entry : list_of(json, "views", name_for_errors)) {
    const std::string field = "views[" + std::to_string(notes.views.size()) + "]";
    const auto name = entry.is_object() ? entry.find("name") : entry.end();
    if (!entry.is_object() || name == entry.end() || !name->is_string() ||
        name->get_ref<const std::string&>().empty() || name->get_ref<const std::string&>().size() > kLongestNoteName) {
      throw_bad_input(name_for_errors, field + ".name", "a name has 1 to 200 bytes", kNotesRemedy);
    }
    notes.views.push_back({name->get<std::string>(), place_of(entry, "eye", field, name_for_errors),
                           place_of(entry, "target", field, name_for_errors), cut_of(entry, field, name_for_errors)});
  }
  for (const Json& entry : list_of(json, "measurements", name_for_errors)) {
    const std::string field = "measurements[" + std::to_string(notes.measurements.size()) + "]";
    notes.measurements.push_back(
        {place_of(entry, "from", field, name_for_errors), place_of(entry, "to", field, name_for_errors)});
  }
  return notes;
}

Json page_notes_json(const PageNotes& notes) {
  Json views = Json::array(), measurements = Json::array();
  for (const SavedView& v : notes.views) {
    views.push_back({{"name", v.name}, {"eye", v.eye}, {"target", v.target}});
    if (v.cut) views.back()["cut"] = *v.cut;
  }
  for (const SavedMeasurement& m : notes.measurements) measurements.push_back({{"from", m.from}, {"to", m.to}});
  return {{"format", kNotesFormat}, {"version", kNotesVersion}, {"views", views}, {"measurements", measurements}};
}

PageNotes page_notes_of_run(const fs::path& run) {
  const fs::path file = run / "page.json";
  return fs::exists(file) ? read_page_notes(read_file(file, kLargestNotes), file) : PageNotes();
}

namespace {

/// The reader's errors speak of a file, which a request is not.
PageNotes notes_of_request(const std::string& body) {
  try {
    return read_page_notes(body, {});
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    throw Error({ErrorKind::kUsage,
                 error.details().message,
                 {},
                 error.details().field,
                 "send format, version, views and measurements, as page.json of a run has them"});
  }
}

}  // namespace

void serve_notes(const fs::path& run, ViewServerOptions& options) {
  options.prompt.insert("/api/notes");  // page.json is of no other handler
  options.post["/api/notes"] = [run](const std::string& body) -> std::string {
    const PageNotes notes = notes_of_request(body);
    require_plain_run(run);
    if (!fs::is_directory(run)) {
      throw_bad_input(run, {}, "the run folder is no longer there, so that nothing is kept",
                      "put the folder back, or end this server");
    }
    write_file_atomically(run / "page.json", json_document(page_notes_json(notes)));
    return "{}";
  };
}

}  // namespace aligngs
