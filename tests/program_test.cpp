// The command line as a user meets it: help, mistakes, exit statuses.
#include <gmock/gmock.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/json_text.h"
#include "support/process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

constexpr std::array<const char*, 26> kCommands = {
    "run",    "demo",   "batch",  "import", "data",   "synth", "poses",      "priors", "refine",
    "train",  "render", "mesh",   "eval",   "room",   "scale", "compare",    "report", "edit",
    "export", "view",   "models", "info",   "doctor", "bench", "completion", "manual"};

class Program : public testing::Test {
 protected:
  fs::path scratch() const {
    return fs::path(testing::TempDir()) /
           ("program_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  }
  ProcessResult run(const std::string& arguments) const { return run_aligngs(arguments, scratch()); }
};

TEST_F(Program, HelpListsTheCommandsAndAnExample) {
  const ProcessResult result = run("--help");
  EXPECT_EQ(result.status, 0);
  for (const char* command : kCommands)
    EXPECT_THAT(result.out, HasSubstr(std::string("\n  ") + command + " ")) << command;
  EXPECT_THAT(result.out, HasSubstr("Example: aligngs demo"));
}

TEST_F(Program, EveryCommandHasHelpWithWhatItReadsAndWritesAndTwoExamples) {
  std::vector<std::string> commands(kCommands.begin(), kCommands.end());
  for (const char* nested : {"data check", "models list", "models download", "models verify", "models path",
                             "models import", "batch status", "batch collect", "batch retry"})
    commands.push_back(nested);
  for (const std::string& command : commands) {
    const ProcessResult result = run(command + " --help");
    EXPECT_EQ(result.status, 0) << command;
    for (const char* line : {"\nReads: ", "\nWrites: ", "\nExample:  aligngs ", "\nAdvanced: aligngs "}) {
      EXPECT_THAT(result.out, HasSubstr(line)) << command;
    }
  }
}

TEST_F(Program, AMistypedCommandIsAUsageErrorWithASuggestion) {
  const ProcessResult result = run("trian somewhere");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("did you mean: aligngs train"));
  EXPECT_EQ(result.out, "");
}

TEST_F(Program, NoCommandIsAUsageErrorThatShowsWhereToStart) {
  const ProcessResult result = run("");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("aligngs demo"));
  EXPECT_THAT(result.err, HasSubstr("aligngs --help"));
  EXPECT_EQ(run("--quiet").status, 2);
}

TEST_F(Program, AnUnknownOptionNamesTheHelp) {
  const ProcessResult result = run("doctor --wat");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("aligngs doctor --help"));
}

TEST_F(Program, ANearOptionIsSuggestedAndProgramsGetTheError) {
  const ProcessResult result = run("export run --formt glb --json");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("there is no option \"--formt\""));
  EXPECT_THAT(result.err, HasSubstr("did you mean: --format"));
  EXPECT_EQ(parse_json(result.out)["error"]["status"], 2);
}

TEST_F(Program, EmptyAndInfiniteValuesAreUsageErrors) {
  const ProcessResult empty = run("export run -f glb --object ''");
  EXPECT_EQ(empty.status, 2);
  EXPECT_THAT(empty.err, HasSubstr("--object has an empty value"));
  const ProcessResult nan = run("export run -f glb --mesh-only --error nan");
  EXPECT_EQ(nan.status, 2);
  EXPECT_THAT(nan.err, HasSubstr("no finite number"));
}

TEST_F(Program, ANumberBelowItsLimitIsNamedWithoutTheLargestDouble) {
  for (const char* option : {"-n 0", "-n x", "--memory -1", "--seed -3"}) {
    const ProcessResult result = run(std::string("run nowhere -o run ") + option);
    EXPECT_EQ(result.status, 2) << option;
    EXPECT_THAT(result.err, HasSubstr("zero")) << option;
    EXPECT_LT(result.err.size(), 300u) << option;
  }
}

TEST_F(Program, ConditionsAreReadBeforeTheWork) {
  for (const char* condition : {"foo=1", "psnr", "psnr=high", "psnr=nan"}) {
    const ProcessResult result = run(std::string("run nowhere -o run --fail-under ") + condition);
    EXPECT_EQ(result.status, 2) << condition;
    EXPECT_THAT(result.err, HasSubstr("--fail-under")) << condition;
  }
}

TEST_F(Program, InfoTellsTextAndModelsFromBrokenPictures) {
  fs::create_directories(scratch());
  for (const char* name : {"config.toml", "cameras.txt"}) {
    std::ofstream(scratch() / name) << "1";
    const ProcessResult result = run("info '" + (scratch() / name).string() + "'");
    EXPECT_EQ(result.status, 3) << name;
    EXPECT_THAT(result.err, testing::Not(HasSubstr("convert the picture"))) << name;
  }
}

TEST_F(Program, ADeviceIsNoPlaceForAnExport) {
  for (const char* file : {"/dev/null", "/dev/fd/1", "-", "/tmp"}) {
    const ProcessResult result = run(std::string("export nowhere -f glb -o ") + file);
    EXPECT_EQ(result.status, 2) << file;
    EXPECT_THAT(result.err, HasSubstr("name a file")) << file;
  }
  EXPECT_FALSE(fs::is_regular_file("/dev/null"));
}

TEST_F(Program, TheCaseOfAnExportFormatDoesNotMatter) {
  EXPECT_EQ(run("export nowhere -f Plan.SVG").status, 3) << "the run is missing, not the format";
  EXPECT_EQ(run("export nowhere -f fbx").status, 2);
  for (const char* unused :
       {"-f html --original-coordinates", "-f plan.dxf --original-coordinates", "-f plan.pdf --keep-frame"}) {
    EXPECT_EQ(run(std::string("export nowhere ") + unused).status, 2) << unused;
  }
}

TEST_F(Program, OutputThatDoesNotArriveIsStatus5) {
  for (const char* command : {"--help", "completion bash", "doctor --json"}) {
    const ProcessResult result = run(std::string(command) + " >/dev/full");
    EXPECT_EQ(result.status, 5) << command;
    EXPECT_THAT(result.err, HasSubstr("standard output")) << command;
  }
}

TEST_F(Program, ADeviceThatIsNotThereIsStatus5) {
  for (const char* command : {"train scene -o run", "run scene -o run", "render run", "mesh run",
                              "poses photos -o scene", "priors scene", "bench"}) {
    const ProcessResult result = run(std::string(command) + " --device cuda:99");
    EXPECT_EQ(result.status, 5) << command << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr("--device cpu")) << command;
  }
}

TEST_F(Program, BenchHasATableForPeopleAndADocumentForPrograms) {
  const std::string tiny = "bench --width 32 --height 32 --gaussians 100 --channels 3 --steps 1";
  const ProcessResult table = run(tiny);
  EXPECT_EQ(table.status, 0) << table.err;
  for (const char* word : {"machine", "GFLOP/s float32", "GB/s memory", "backward", "of floor", "steps per second"}) {
    EXPECT_THAT(table.out, HasSubstr(word));
  }
  const ProcessResult document = run(tiny + " --json");
  EXPECT_EQ(document.status, 0) << document.err;
  for (const char* key : {"\"fma_gflops\"", "\"floor_seconds\"", "\"instructions\""})
    EXPECT_THAT(document.out, HasSubstr(key));
}

TEST_F(Program, OptionsOfBenchThatBelongToAnotherDeviceAreUsageErrors) {
  EXPECT_EQ(run("bench --graphs").status, 2);
  EXPECT_EQ(run("bench --device quantum").status, 2);
}

TEST_F(Program, VersionIsPrinted) {
  const ProcessResult result = run("--version");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("aligngs 0."));
}

TEST_F(Program, DoctorSpeaksJsonOnStandardOutput) {
  const ProcessResult result = run("doctor --json");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out.front(), '{');
  EXPECT_THAT(result.out, HasSubstr("\"processor\""));
}

TEST_F(Program, InfoOnSomethingMissingIsBadInput) {
  const ProcessResult result = run("info /nonexistent/file.ply");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("/nonexistent/file.ply"));
  EXPECT_THAT(result.err, HasSubstr("remedy"));
}

TEST_F(Program, TrainOnAFolderThatIsNoSceneIsBadInput) {
  fs::create_directories(scratch() / "empty");
  const ProcessResult result =
      run("train '" + (scratch() / "empty").string() + "' -o '" + (scratch() / "run").string() + "'");
  EXPECT_EQ(result.status, 3);
  EXPECT_FALSE(fs::exists(scratch() / "run" / "scene.ply"));
}

TEST_F(Program, AnUnknownSettingIsAUsageErrorWithASuggestion) {
  const ProcessResult result = run("train somewhere -o elsewhere --set loss.ssimm=1");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("loss.ssim"));
}

TEST_F(Program, PrintConfigShowsEveryKeyOfAPreset) {
  const ProcessResult result = run("train --print-config --preset paper");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("[loss]"));
  EXPECT_THAT(result.out, HasSubstr("coupling"));
}

TEST_F(Program, BenchTellsEveryStageFromItsFloor) {
  const ProcessResult result =
      run("bench --json --threads 1 --width 64 --height 48 --gaussians 500 --channels 5 --steps 2 --pixel-share 1 "
          "--blend logits");
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json document = parse_json(result.out);
  EXPECT_EQ(document["scene"]["gaussians"], 500);
  EXPECT_EQ(document["scene"]["pixel_share"], 1.0);
  EXPECT_EQ(document["scene"]["blend"], "logits");
  const nlohmann::json& stages = document["step"]["stages"];
  for (const char* stage :
       {"project", "bin", "forward", "losses", "backward", "semantics", "parameter_gradients", "optimise"}) {
    EXPECT_TRUE(stages.contains(stage)) << stage;
  }
  nlohmann::json timed = stages;
  timed["densify"] = document["densify"];
  for (const auto& [name, stage] : timed.items()) {
    const double seconds = stage["seconds"], floor = stage["floor_seconds"], fraction = stage["fraction"];
    EXPECT_GT(seconds, 0) << name;
    EXPECT_GT(floor, 0) << name;
    EXPECT_NEAR(fraction * seconds, floor, 1e-9 * floor) << name;
    EXPECT_GT(stage["gbps"].get<double>(), 0) << name;
  }
  EXPECT_EQ(run("bench --blend colours").status, 2);
}

}  // namespace
}  // namespace aligngs
