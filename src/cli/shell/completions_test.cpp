#include "cli/shell/completions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/shell/man_page.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A program with one plain command and one that has commands of its own.
class Shell : public testing::Test {
 protected:
  Shell() {
    app_.add_flag("-q,--quiet", quiet_, "warnings only")->group("Everywhere");
    CLI::App* run = app_.add_subcommand("run", "Do everything: it's all");
    run->group("Data");
    run->footer("Example:  prog run photos\n.starts with a dot");
    run->add_option("source", text_, "folder of photos")->required();
    run->add_option("--method", text_, "how")->check(CLI::IsMember({"auto", "given"}))->capture_default_str();
    run->add_option("-o,--output", text_, "folder to write")->required();
    CLI::App* models = app_.add_subcommand("models", "Weights");
    models->group("Data");
    models->add_subcommand("list", "List them")->group("Data");
    tree_ = describe_command(app_);
  }

  /// Words that bash completes the last word of `line` to.
  std::vector<std::string> bash(const std::vector<std::string>& line) const {
    const fs::path script = fs::path(testing::TempDir()) / "aligngs.bash";
    std::ofstream(script) << bash_completion(tree_) << "\nCOMP_WORDS=(" << words(line)
                          << ")\nCOMP_CWORD=" << line.size() - 1 << "\n_aligngs\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n";
    FILE* pipe = popen(("bash '" + script.string() + "' 2>&1").c_str(), "r");
    std::string text;
    std::array<char, 256> piece{};
    while (std::fgets(piece.data(), int(piece.size()), pipe)) text += piece.data();
    EXPECT_EQ(pclose(pipe), 0) << text;
    std::istringstream in(text);
    std::vector<std::string> out;
    for (std::string word; std::getline(in, word);) {
      if (!word.empty()) out.push_back(word);
    }
    return out;
  }
  static std::string words(const std::vector<std::string>& line) {
    std::string out;
    for (const std::string& word : line) out += "'" + word + "' ";
    return out;
  }
  static bool installed(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null").c_str()) == 0;
  }
  /// Exit status of `command FILE` on a file with the text.
  static int check(const std::string& command, const std::string& text) {
    const fs::path file = fs::path(testing::TempDir()) / "script";
    std::ofstream(file) << text;
    return std::system((command + " '" + file.string() + "' >/dev/null").c_str());
  }

  CLI::App app_{"prog does it.\n\nExample: prog run", "aligngs"};
  int quiet_ = 0;
  std::string text_ = "auto";
  CommandInfo tree_;
};

TEST_F(Shell, TheTreeHasCommandsOptionsAndChoices) {
  ASSERT_EQ(tree_.commands.size(), 2u);
  const CommandInfo& run = tree_.commands[0];
  EXPECT_EQ(run.path, "run");
  EXPECT_EQ(tree_.commands[1].commands[0].path, "models list");
  const auto method = std::find_if(run.options.begin(), run.options.end(),
                                   [](const OptionInfo& o) { return o.names[0] == "--method"; });
  ASSERT_NE(method, run.options.end());
  EXPECT_THAT(method->choices, ElementsAre("auto", "given"));
  EXPECT_EQ(method->standard, "auto");
}

TEST_F(Shell, WordsOfAValueAreReadWithAndWithoutChoices) {
  EXPECT_EQ(value_words("TEXT:{a,b c}").value, "TEXT");
  EXPECT_THAT(value_words("TEXT:{a,b c}").choices, ElementsAre("a", "b c"));
  EXPECT_THAT(value_words("INT:INT in [2 - 9]").choices, IsEmpty());
  EXPECT_THAT(value_words("").choices, IsEmpty());
}

TEST_F(Shell, BashCompletesCommandsOptionsAndTheirValues) {
  EXPECT_THAT(bash({"aligngs", ""}), ElementsAre("run", "models"));
  EXPECT_THAT(bash({"aligngs", "mo"}), ElementsAre("models"));
  EXPECT_THAT(bash({"aligngs", "models", ""}), ElementsAre("list"));
  EXPECT_THAT(bash({"aligngs", "-q", "run", "--me"}), ElementsAre("--method"));
  EXPECT_THAT(bash({"aligngs", "run", "--method", ""}), ElementsAre("auto", "given"));
  EXPECT_THAT(bash({"aligngs", "run", "--"}), Contains("--quiet"));
}

TEST_F(Shell, BashCompletesFilesWhereNothingElseFits) {
  const fs::path folder = fs::path(testing::TempDir()) / "files to complete";
  fs::create_directories(folder / "a room");
  EXPECT_THAT(bash({"aligngs", "run", (folder / "a").string()}), ElementsAre((folder / "a room").string()));
}

TEST_F(Shell, ZshAcceptsItsScript) {
  const std::string script = zsh_completion(tree_);
  EXPECT_THAT(script, HasSubstr("'run:Do everything: its all'"));
  if (!installed("zsh")) GTEST_SKIP() << "zsh is not installed";
  EXPECT_EQ(check("zsh -n", script), 0);
}

TEST_F(Shell, FishAcceptsItsScript) {
  const std::string script = fish_completion(tree_);
  EXPECT_THAT(script, HasSubstr("-n '__fish_seen_subcommand_from run' -l method -x -a 'auto given' -d 'how'"));
  if (!installed("fish")) GTEST_SKIP() << "fish is not installed";
  EXPECT_EQ(check("fish --no-execute", script), 0);
}

TEST_F(Shell, AManualPageHasEveryOptionAndNoStrayControlLine) {
  const std::string page = man_page(tree_.commands[0], tree_);
  EXPECT_EQ(man_page_name(tree_.commands[1].commands[0]), "aligngs-models-list.1");
  for (const char* part : {".TH ALIGNGS\\-RUN 1", "\\-\\-method TEXT", "One of: auto, given.", "Default: auto.",
                           "\\-q, \\-\\-quiet", ".SS Arguments"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
  EXPECT_THAT(page, HasSubstr("\n\\&.starts with a dot"));
  if (!installed("groff")) GTEST_SKIP() << "groff is not installed";
  EXPECT_EQ(check("groff -man -Tascii -ww -z", page), 0);
}

}  // namespace
}  // namespace aligngs
