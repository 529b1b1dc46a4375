#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "core/error.h"
#include "train/config_file.h"
#include "train/config_keys.h"

namespace aligngs {
namespace {

using ::testing::HasSubstr;

std::filesystem::path test_file(const std::string& name, const std::string& content) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "aligngs_config_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << content;
  return folder / name;
}

Error::Details error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.details();
  }
  ADD_FAILURE() << "no error was thrown";
  return {};
}

TEST(ConfigKeys, NamesAreUniqueAndDocumented) {
  std::set<std::string_view> names;
  for (const ConfigKey& key : config_keys()) {
    EXPECT_TRUE(names.insert(key.name).second) << key.name;
    EXPECT_FALSE(key.doc.empty()) << key.name;
    EXPECT_NE(key.name.find('.'), std::string_view::npos) << key.name;
  }
}

TEST(ConfigKeys, EveryPresetValueHasTheTypeAndRangeOfItsKey) {
  for (const Preset p : {Preset::kPreview, Preset::kDefault, Preset::kPaper, Preset::kHigh, Preset::kPgsr}) {
    const TrainConfig config = make_preset(p);  // set_config throws otherwise
    EXPECT_NO_THROW(check_config(config));
    EXPECT_EQ(config.train.preset, p);
    for (const ConfigKey& key : config_keys()) {
      EXPECT_EQ(get_config(config, key), key.presets[static_cast<size_t>(p)]) << key.name;
    }
  }
}

std::vector<std::string> words_of(const ConfigKey& key) {
  std::vector<std::string> words;
  std::istringstream text(choices_of(key));
  for (std::string word; std::getline(text, word, '|');) words.push_back(word);
  return words;
}

TEST(ConfigKeys, NothingHasAValueUntilAPresetFillsIt) {
  TrainConfig empty;
  for (const ConfigKey& key : config_keys()) {
    const ConfigField field = key.field(empty);
    if (const auto* choice = std::get_if<ChoiceField>(&field)) {
      EXPECT_EQ(*static_cast<const int*>(choice->field), 0) << key.name;  // the first one: none is chosen
      continue;
    }
    const ConfigValue value = get_config(empty, key);
    const bool none = value == ConfigValue(0.0) || value == ConfigValue(int64_t(0)) || value == ConfigValue(false) ||
                      value == ConfigValue(std::string());
    EXPECT_TRUE(none) << key.name << " is " << config_value_text(value);
  }
}

TEST(ConfigKeys, EveryWordOfAChoiceMakesARoundTrip) {
  size_t choices = 0;
  for (const ConfigKey& key : config_keys()) {
    const std::vector<std::string> words = words_of(key);
    choices += !words.empty();
    for (const std::string& word : words) {
      TrainConfig config = make_preset(Preset::kDefault);
      set_config(config, key.name, word);
      EXPECT_EQ(get_config(config, key), ConfigValue(word)) << key.name;
      EXPECT_EQ(config_value_text(get_config(config, key)), "\"" + word + "\"") << key.name;
    }
    EXPECT_EQ(std::set<std::string>(words.begin(), words.end()).size(), words.size()) << key.name;
  }
  EXPECT_EQ(choices, 7u);
}

TEST(ConfigKeys, AnotherWordIsRefusedWithTheWordsThatAreAllowed) {
  TrainConfig config = make_preset(Preset::kDefault);
  for (const ConfigKey& key : config_keys()) {
    if (choices_of(key).empty()) continue;
    const Error::Details error = error_of([&] { set_config(config, key.name, std::string("neither")); });
    EXPECT_EQ(error.kind, ErrorKind::kUsage);
    EXPECT_EQ(error.field, key.name);
    EXPECT_EQ(error.message, "'neither' is no choice");
    EXPECT_EQ(error.remedy, "use one of " + choices_of(key));
  }
}

TEST(ConfigKeys, PaperPresetHasThePrintedNumbers) {
  const TrainConfig c = make_preset(Preset::kPaper);
  EXPECT_EQ(c.train.iterations, 7000);
  EXPECT_EQ(c.loss.l1, 0.8);
  EXPECT_EQ(c.loss.ssim, 0.2);
  EXPECT_EQ(c.loss.pearson, 0.5);
  EXPECT_EQ(c.loss.normal_consistency, 0.05);
  EXPECT_EQ(c.loss.normal_boundary, 0.01);
  EXPECT_EQ(c.loss.log_depth, 0);
  EXPECT_EQ(c.semantic.soft, 1);
  EXPECT_EQ(c.semantic.hard, 0.1);
  EXPECT_EQ(c.semantic.blend, SemanticBlend::kLogits);
  EXPECT_EQ(c.optimizer.semantic, 1e-3);
  EXPECT_EQ(c.densify.opacity_reset_every, 3000);
}

TEST(ConfigKeys, PgsrPresetIsTheBaseOfThePaperWithItsOwnTerms) {
  const TrainConfig c = make_preset(Preset::kPgsr);
  EXPECT_EQ(c.loss.multi_view_geometric, 0.03);
  EXPECT_EQ(c.loss.multi_view_photometric, 0.15);
  EXPECT_EQ(c.loss.normal_consistency, 0.015);
  EXPECT_NEAR(double(c.loss.multi_view_from) / double(c.train.reference_iterations), 7000.0 / 30000, 1e-3);
  EXPECT_EQ(c.loss.normal_start, c.loss.multi_view_from);
  EXPECT_EQ(c.data.prior_depth, PriorDepthUse::kNone);
  EXPECT_FALSE(c.data.semantics);
  const TrainConfig paper = make_preset(Preset::kPaper);
  EXPECT_EQ(c.loss.flatten, paper.loss.flatten);
  EXPECT_EQ(c.densify.gradient_abs, paper.densify.gradient_abs);
  EXPECT_EQ(c.init.start, paper.init.start);
}

TEST(ConfigKeys, MultiViewTermsAreOffInEveryOtherPreset) {
  for (const Preset p : {Preset::kPreview, Preset::kDefault, Preset::kPaper, Preset::kHigh}) {
    EXPECT_EQ(make_preset(p).loss.multi_view_geometric, 0);
    EXPECT_EQ(make_preset(p).loss.multi_view_photometric, 0);
  }
}

TEST(ConfigKeys, PreviewWorksAtHalfWidthAndHeight) {
  const TrainConfig c = make_preset(Preset::kPreview);
  EXPECT_EQ(c.data.scale, 0.5);
  EXPECT_EQ(c.train.iterations, 1000);
}

TEST(ConfigKeys, UnknownKeySuggestsTheNearest) {
  TrainConfig c = make_preset(Preset::kDefault);
  const Error::Details e = error_of([&] { set_config(c, "loss.sim", std::string("1")); });
  EXPECT_EQ(e.kind, ErrorKind::kUsage);
  EXPECT_EQ(e.field, "loss.sim");
  EXPECT_THAT(e.remedy, HasSubstr("loss.ssim"));
}

TEST(ConfigKeys, SuggestionFindsAKeyWithoutItsGroup) {
  EXPECT_THAT(suggest_config_keys("iterations"), ::testing::Contains("train.iterations"));
  EXPECT_TRUE(suggest_config_keys("completely different").empty());
}

TEST(ConfigKeys, RejectsValuesOutsideTheirRange) {
  TrainConfig c = make_preset(Preset::kDefault);
  for (const char* text : {"-0.1", "nan", "inf", "1e9", "", "0.8x"}) {
    EXPECT_EQ(error_of([&] { set_config(c, "loss.l1", std::string(text)); }).kind, ErrorKind::kUsage) << text;
  }
  EXPECT_THAT(error_of([&] { set_config(c, "mesh.depth", std::string("mean")); }).remedy, HasSubstr("median"));
  EXPECT_THAT(error_of([&] { set_config(c, "train.iterations", std::string("1.5")); }).message, HasSubstr("whole"));
  EXPECT_THAT(error_of([&] { set_config(c, "data.semantics", std::string("yes")); }).remedy,
              HasSubstr("true or false"));
}

TEST(ConfigFile, RoundTripIsExact) {
  TrainConfig c = make_preset(Preset::kPaper);
  set_config(c, "loss.l1", std::string("0.1234567890123"));
  set_config(c, "train.seed", std::string("12345678901"));
  const std::filesystem::path path = test_file("round.toml", config_to_toml(c));
  ConfigSources sources;
  sources.config_file = path;
  EXPECT_THAT(config_differences(c, resolve_config(sources)), ::testing::IsEmpty());
}

TEST(ConfigFile, LaterSourcesWin) {
  ConfigSources sources;
  sources.preset = "paper";
  sources.config_file = test_file("partial.toml", "train.iterations = 50\n[loss]\nl1 = 1\nssim = 0.5\n");
  sources.sets = {"loss.ssim=0.25"};
  sources.iterations = 60;
  sources.seed = 9;
  const TrainConfig c = resolve_config(sources);
  EXPECT_EQ(c.loss.l1, 1);
  EXPECT_EQ(c.loss.ssim, 0.25);
  EXPECT_EQ(c.loss.pearson, make_preset(Preset::kPaper).loss.pearson);
  EXPECT_EQ(c.train.iterations, 60);
  EXPECT_EQ(c.train.seed, 9);
}

TEST(ConfigFile, FileMadeFromAPresetKeepsItsPreset) {
  ConfigSources sources;
  sources.config_file = test_file("preset.toml", "[train]\npreset = \"paper\"\n");
  EXPECT_EQ(resolve_config(sources).semantic.blend, SemanticBlend::kLogits);
}

TEST(ConfigFile, ErrorsNameFileAndKey) {
  TrainConfig c = make_preset(Preset::kDefault);
  const std::filesystem::path unknown = test_file("unknown.toml", "[loss]\nl3 = 1\n");
  const Error::Details e = error_of([&] { apply_config_file(unknown, c); });
  EXPECT_EQ(e.path, unknown);
  EXPECT_EQ(e.field, "loss.l3");
  EXPECT_THAT(e.message, HasSubstr("line 2"));
  EXPECT_EQ(error_of([&] { apply_config_file(test_file("broken.toml", "[loss\n"), c); }).kind, ErrorKind::kBadInput);
  EXPECT_EQ(error_of([&] { apply_config_file(test_file("list.toml", "loss.l1 = [1]\n"), c); }).kind, ErrorKind::kUsage);
  EXPECT_EQ(error_of([&] { apply_config_file("/nonexistent/config.toml", c); }).kind, ErrorKind::kBadInput);
}

TEST(ConfigFile, SetNeedsAKeyAndAValue) {
  TrainConfig c = make_preset(Preset::kDefault);
  EXPECT_EQ(error_of([&] { apply_config_set("loss.l1", c); }).kind, ErrorKind::kUsage);
  EXPECT_EQ(error_of([&] { apply_config_set("=1", c); }).kind, ErrorKind::kUsage);
  EXPECT_EQ(error_of([&] { apply_config_set("train.preset=paper", c); }).remedy, "use --preset");
}

TEST(ConfigFile, ContradictionsAreRefused) {
  for (const char* set : {"densify.start=4000", "semantic.coupling_stop=10", "semantic.pixel_share=0.3",
                          "optimizer.position_end=0", "optimizer.aspect_max=0.5", "loss.log_depth_end=0"}) {
    ConfigSources sources;
    sources.sets = {set};
    EXPECT_EQ(error_of([&] { resolve_config(sources); }).kind, ErrorKind::kUsage) << set;
  }
}

TEST(ConfigFile, ReferenceListsEveryKey) {
  const std::string text = config_reference_markdown();
  for (const ConfigKey& key : config_keys()) EXPECT_THAT(text, HasSubstr(std::string(key.name)));
}

TEST(ConfigFile, ManualIsMadeFromTheTable) {
  std::ifstream manual(std::string(ALIGNGS_SOURCE_DIR) + "/docs/settings.md");
  const std::string text((std::istreambuf_iterator<char>(manual)), std::istreambuf_iterator<char>());
  // When this fails, replace the last table of docs/settings.md by what config_reference_markdown() returns.
  EXPECT_NE(text.find(config_reference_markdown()), std::string::npos) << config_reference_markdown();
}

/// The rows of docs/settings.md must stay settings that exist.
TEST(ConfigFile, AblationRowsAreSettings) {
  const std::vector<std::vector<std::string>> rows = {
      {"data.prior_depth=none", "data.semantics=false", "loss.pearson=0", "loss.normal_consistency=0",
       "loss.normal_boundary=0"},
      {"semantic.coupling_strength=0", "loss.pearson=0"},
      {"data.prior_depth=none", "data.semantics=false", "loss.normal_consistency=0"}};
  for (const std::vector<std::string>& row : rows) {
    ConfigSources sources;
    sources.preset = "paper";
    sources.sets = row;
    EXPECT_NO_THROW(resolve_config(sources));
  }
}

TEST(ConfigKeys, AKeyOfAnotherGroupSuggestsAllOfItsName) {
  EXPECT_THAT(suggest_config_keys("train.max_gaussians"),
              ::testing::IsSupersetOf({"init.max_gaussians", "densify.max_gaussians"}));
}

}  // namespace
}  // namespace aligngs
