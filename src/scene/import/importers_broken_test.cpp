// Valid captures of every layout with one thing broken: an importer leaves frames out, or ends with a typed error and
// no output. It never crashes, hangs or leaves half of a scene. ALIGNGS_FUZZ_SECONDS goes on so long for each layout;
// seeds are printed on failure.
#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>

#include "core/error.h"
#include "core/log.h"
#include "scene/import/import_capture.h"
#include "scene/import/testing/random_layouts.h"
#include "scene/scene_json.h"

namespace aligngs {
namespace {

/// The files of a folder, in the order of their names.
std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Changes one file in one of the ways in which files break; says how.
std::string break_one_thing(const fs::path& folder, Random& random) {
  const std::vector<fs::path> files = files_below(folder);
  // Photos are many and texts few: half of the time a text is chosen.
  std::vector<fs::path> texts;
  for (const fs::path& file : files) {
    const std::string extension = file.extension().string();
    if (extension == ".txt" || extension == ".json" || extension == ".bin") texts.push_back(file);
  }
  const std::vector<fs::path>& from = random.chance(0.6) && !texts.empty() ? texts : files;
  const fs::path file = from[size_t(random.below(int(from.size())))];
  std::string bytes = read_file(file);
  const size_t at = bytes.empty() ? 0 : size_t(random.below(int(bytes.size())));
  const char* words[] = {"nan",      "-1",      "1e999",      "0",    "",
                         "\"\"",     "null",    "[]",         "{}",   "99999999999999999999",
                         "\xff\xfe", "../../x", "2147483648", "-0.5", "true"};
  const int how = random.below(9);
  switch (how) {
    case 0:
      fs::remove(file);
      break;
    case 1:
      bytes.resize(at);
      break;
    case 2:
      bytes.clear();
      break;
    case 3:
      bytes[at < bytes.size() ? at : 0] = static_cast<char>(random.below(256));
      break;
    case 4:
      bytes.insert(at, words[random.below(15)]);
      break;
    case 5: {  // a number or word becomes another
      const size_t begin = bytes.find_first_of("0123456789tfn\"", at), end = bytes.find_first_of(" ,\n]}:", begin);
      if (begin != std::string::npos)
        bytes.replace(begin, end == std::string::npos ? end : end - begin, words[random.below(15)]);
      break;
    }
    case 6:
      bytes += bytes;
      break;
    case 7: {  // another file's content
      bytes = read_file(files[size_t(random.below(int(files.size())))]);
      break;
    }
    default: {  // a folder in its place
      fs::remove(file);
      fs::create_directories(file / "folder");
    }
  }
  if (how >= 1 && how <= 7) write_file_atomically(file, bytes);
  return fmt::format("{} of {} at byte {}", how, fs::relative(file, folder).string(), at);
}

class BrokenCaptures : public testing::TestWithParam<Layout> {};

TEST_P(BrokenCaptures, EndWellOrWithATypedErrorAndNoOutput) {
  const char* seconds = std::getenv("ALIGNGS_FUZZ_SECONDS");
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds ? std::atoi(seconds) : 0);
  const uint64_t seeds = random_captures(75);
  const fs::path folder = scratch_folder(fmt::format("broken_{}", GetParam().name));
  set_log_level(LogLevel::kSilent);
  ThreadPool pool(1);
  ImportOptions options;
  options.progress.enabled = false;
  uint64_t refused = 0, seed = 0;
  for (; (seed < seeds || std::chrono::steady_clock::now() < end) && !HasFailure(); ++seed) {
    fs::remove_all(folder);
    const Written written = GetParam().write(seed, folder / "source");
    Random random(seed);
    SCOPED_TRACE(fmt::format("seed {}: {}", seed, break_one_thing(folder / "source", random)));
    try {
      import_capture(read_capture(folder / "source", written.options), folder / "scene", options, pool);
      EXPECT_NO_THROW(open_scene(folder / "scene")) << "what import ends well for, training accepts";
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << error.what();
      EXPECT_FALSE(fs::exists(folder / "scene")) << error.what();
    } catch (const std::exception& error) {
      ADD_FAILURE() << "an error without a type: " << error.what();
    }
    for (const auto& entry : fs::directory_iterator(folder))
      EXPECT_EQ(entry.path().filename().string().find(".tmp-"), std::string::npos) << entry.path();
  }
  set_log_level(LogLevel::kInfo);
  RecordProperty("captures", int(seed));
  RecordProperty("refused", int(refused));
  EXPECT_LT(refused, seed) << "most single faults leave a capture usable";
  fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Layouts, BrokenCaptures, testing::ValuesIn(random_layouts()),
                         [](const auto& layout) { return std::string(layout.param.name); });

}  // namespace
}  // namespace aligngs
