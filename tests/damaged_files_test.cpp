// Description files of scenes, runs and batches, damaged anywhere: a reader takes what is left, or refuses it by name.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "batch/lease.h"
#include "batch/room_record.h"
#include "core/error.h"
#include "edit/edit_change_file.h"
#include "edit/edit_operation.h"
#include "edit/named_selection.h"
#include "edit/object_scores.h"
#include "io/atomic_file.h"
#include "io/exif_focal_length.h"
#include "io/exif_orientation.h"
#include "io/json_text.h"
#include "io/npz.h"
#include "io/zip_writer.h"
#include "metrics/metrics_json.h"
#include "room/room_json.h"
#include "room/testing/sample_room.h"
#include "scene/camera_path_json.h"
#include "scene/label_set.h"
#include "scene/scene_json.h"
#include "scene/segment_file.h"
#include "serve/page_notes.h"
#include "train/config_file.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr size_t kDamages = 150;  // of each kind: a sample of a long file, every byte of a short one

struct Reader {
  const char* name;
  std::function<std::string()> valid;
  std::function<void(const fs::path&)> read;
};

void PrintTo(const Reader& reader, std::ostream* out) { *out << reader.name; }

fs::path folder() { return fs::path(testing::TempDir()) / "damaged_files"; }

/// The bytes that a writer puts into a file.
std::string written(const std::function<void(const fs::path&)>& write) {
  fs::create_directories(folder());
  const fs::path file = folder() / "written";
  write(file);
  return read_file(file);
}

std::string valid_change() {
  EditChange change;
  change.number = 1;
  change.base = 7;
  change.removed = {row_of_edit(0, 3), row_of_edit(0, 4)};
  change.removed_triangles = {row_of_edit(0, 1)};
  return encode_change(change);
}

std::string npy_of_two_by_three() {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
  header.resize(117, ' ');
  header += '\n';
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + std::string(24, '\1');
}

std::vector<Reader> readers() {
  const auto text = [](const char* t) { return [t] { return std::string(t); }; };
  return {
      {"scene_json",
       text(R"({"units": "metres", "up": [0, -1, 0], "up_source": "x", "source": "s", "written_by": "aligngs",
            "units_estimate": {"model": "m", "spread": 0.1, "photos": 3},
            "to_original": {"scale": 2, "translation": [1, 2, 3]}})"),
       [](const fs::path& f) { read_scene_json(f); }},
      {"split_json", text(R"({"train": ["a", "b"], "test": ["c"]})"), [](const fs::path& f) { read_split_json(f); }},
      {"priors_json",
       text(R"({"depth": {"model": "m", "scale": "metres"}, "semantics": {"model": "n", "kind": "scores"}})"),
       [](const fs::path& f) { read_priors_json(f); }},
      {"exposure_json", text(R"({"log_gains": {"a": [0.1, 0, -0.2], "b": [0, 0, 0]}})"),
       [](const fs::path& f) { read_exposure_json(f); }},
      {"segments",
       [] {
         return written([](const fs::path& file) {
           write_segments(file, {3, 1, {0, 1, SegmentMap::kNone}, {{0, Segment::kStuff}, {19, 2}}});
         });
       },
       [](const fs::path& f) { read_segments(f, 150); }},
      {"labels_csv",
       [] {
         LabelSet labels;
         labels.classes = {{"wall", {"partition"}, {1, 2, 3}}, {"floor", {}, {4, 5, 6}}};
         return written([&](const fs::path& f) { write_label_csv(f, labels); });
       },
       [](const fs::path& f) { read_label_csv(f); }},
      {"camera_path", text(R"({"format": "aligngs camera path", "version": 1, "keys": [{"time": 0, "eye": [0, 1, -2],
            "target": [0, 1, 0], "fov": 62}, {"time": 2, "eye": [1, 1, -1], "target": [0, 1, 0]}]})"),
       [](const fs::path& f) { read_camera_path(f); }},
      {"room_json", [] { return room_json(sample_room::make()); }, [](const fs::path& f) { read_room(f); }},
      {"run_json",
       [] {
         return written([](const fs::path& f) {
           RunRecord record;
           record.status = RunStatus::kDone;
           record.scene = "../scene";
           record.left_out = {"a"};
           write_run_record(f, record);
         });
       },
       [](const fs::path& f) {
         is_run_record(f);
         read_run_record(f);
       }},
      {"config_toml", [] { return config_to_toml(resolve_config({})); },
       [](const fs::path& f) {
         TrainConfig config;
         apply_config_file(f, config);
         check_config(config);
       }},
      {"metrics_json", [] { return metrics_json(RunMetrics{}).dump(2); }, [](const fs::path& f) { read_metrics(f); }},
      {"page_json", text(R"({"format": "aligngs page", "version": 1, "views": [{"name": "bed", "eye": [1, 2, 3],
            "target": [0, 0.5, -1], "cut": [0, 1, 0, 0.5, 0.25, 1]}],
            "measurements": [{"from": [0, 0, 0], "to": [0, 2.5, 0]}]})"),
       [](const fs::path& f) { read_page_notes(read_file(f), f); }},
      {"edits_json", text(R"({"schema": 1, "edits": [{"operation": "delete", "select": "pillow#2", "threshold": "auto",
            "fill": true}, {"operation": "recolor", "select": "sofa", "threshold": "0.25", "color": "#add8e6"}]})"),
       [](const fs::path& f) { read_edits(f); }},
      {"selections_json",
       text(R"({"schema": 1, "selections": [{"name": "my corner", "scene": "0123456789abcdef", "gaussians": 300,
            "rows": "0,12-41,57"}]})"),
       [](const fs::path& f) { parse_named_selections(read_file(f), f); }},
      {"edit_change", valid_change, [](const fs::path& f) { read_change(f); }},
      {"objects_json",
       text(R"({"schema": 1, "objects": [{"object": "box#1", "class": "box", "low": [0, 0, 0], "high": [1, 1, 1],
            "vertices": [0, 99]}]})"),
       [](const fs::path& f) { read_true_objects(f, 99); }},
      {"room_record",
       [] {
         return written([](const fs::path& f) {
           RoomRecord record;
           record.state = AttemptState::kDone;
           record.command = "aligngs run";
           write_room_record(f, record);
         });
       },
       [](const fs::path& f) { read_room_record(f); }},
      {"lease", text(R"({"host": "a", "pid": 12})"),
       [](const fs::path& f) {
         const fs::path leases = f.parent_path() / "leases";
         fs::create_directories(leases);
         fs::copy_file(f, leases / "one.1", fs::copy_options::overwrite_existing);
         look_at_lease(leases, "one", {});
       }},
      {"npz",
       [] {
         return make_stored_zip({{"arr_0.npy", npy_of_two_by_three()}});
       },
       [](const fs::path& f) {
         read_npz_header(f);
         read_npz(f);
       }},
      {"exif", [] { return exif_with_focal_35mm(28); },
       [](const fs::path& f) {
         std::string bytes = read_file(f);
         exif_focal_35mm(bytes, 4000);
         exif_orientation(bytes);
         set_exif_upright(bytes, 0, bytes.size());
       }},
  };
}

class DamagedFiles : public testing::TestWithParam<Reader> {
 protected:
  void SetUp() override {
    fs::create_directories(folder());
    file_ = folder() / (std::string(GetParam().name) + ".file");
    valid_ = GetParam().valid();
  }
  /// Whether the reader takes these bytes; anything but an error of input or of settings fails the test.
  bool takes(const std::string& bytes, const std::string& what) {
    std::ofstream(file_, std::ios::binary) << bytes;
    try {
      GetParam().read(file_);
      return true;
    } catch (const Error& error) {
      const bool theirs = error.kind() == ErrorKind::kBadInput || error.kind() == ErrorKind::kUsage;
      EXPECT_TRUE(theirs) << what << ": " << error.what();
    } catch (const std::exception& error) {
      ADD_FAILURE() << what << " throws " << error.what();
    }
    return false;
  }
  size_t stride() const { return std::max<size_t>(1, valid_.size() / kDamages); }

  fs::path file_;
  std::string valid_;
};

TEST_P(DamagedFiles, TheWholeFileIsTaken) { EXPECT_TRUE(takes(valid_, "the whole file")); }

TEST_P(DamagedFiles, CutFilesAndOtherBytesAreTakenOrRefused) {
  for (size_t at = 0; at < valid_.size(); at += stride()) {
    const std::string place = std::to_string(at);
    takes(valid_.substr(0, at), "cut at " + place);
    std::string bytes = valid_;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    takes(bytes, "another bit at " + place);
    takes(std::string(valid_).erase(at, 1), "without byte " + place);
    takes(std::string(valid_).insert(at, "\xff"), "a byte that is no text at " + place);
    takes(std::string(valid_).insert(at, "1e999"), "a number beyond all at " + place);
  }
}

TEST_P(DamagedFiles, OtherValuesOfJsonAreTakenOrRefused) {
  const Json whole = parse_json(valid_);
  if (whole.is_discarded()) return;  // a binary file, a table or TOML: its bytes are damaged above
  const Json values = {nullptr,
                       true,
                       -1,
                       0,
                       2.5,
                       1e308,
                       1e-308,
                       uint64_t(18446744073709551615u),
                       "",
                       "\n/../etc/x",
                       Json::array(),
                       {nullptr, 1},
                       Json::object(),
                       {{"a", 1}}};
  std::vector<std::string> places;
  const std::function<void(const Json&, const std::string&)> list = [&](const Json& json, const std::string& place) {
    places.push_back(place);
    if (!json.is_structured()) return;
    for (const auto& [key, value] : json.items()) list(value, place + "/" + key);
  };
  list(whole, "");
  const size_t every = std::max<size_t>(1, places.size() * values.size() / (4 * kDamages));
  size_t trial = 0;
  for (const std::string& place : places) {
    for (const Json& value : values) {
      if (trial++ % every != 0) continue;
      Json changed = whole;
      changed[Json::json_pointer(place)] = value;
      takes(changed.dump(), place + " = " + value.dump());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryReader, DamagedFiles, testing::ValuesIn(readers()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace aligngs
