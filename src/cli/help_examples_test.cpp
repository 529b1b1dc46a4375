#include <gmock/gmock.h>
#include <CLI/App.hpp>

#include <sstream>
#include <string>
#include <vector>

#include "cli/command.h"
#include "train/config_keys.h"

namespace aligngs {
namespace {

struct HelpExample {
  std::string line;
  std::vector<std::string> words;  ///< without the name of the program
};

/// Words of a line as a shell splits them, up to a pipe or a redirection. Double and single quotes are known.
std::vector<std::string> shell_words_of(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  char quote = 0;
  bool open = false;
  for (const char c : line + " ") {
    if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
      open = true;
    } else if (quote != 0 && c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == ' ' || c == '\t')) {
      if (open && (word == "|" || word == ">" || word == "&&")) return words;
      if (open) words.push_back(word);
      word.clear();
      open = false;
    } else {
      word += c;
      open = true;
    }
  }
  return words;
}

void gather_examples(const CLI::App& app, std::vector<HelpExample>& examples) {
  std::istringstream lines(app.get_footer());
  for (std::string line; std::getline(lines, line);) {
    for (const std::string begin : {"Example:  aligngs ", "Advanced: aligngs "}) {
      if (line.rfind(begin, 0) == 0) examples.push_back({line, shell_words_of(line.substr(begin.size()))});
    }
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    gather_examples(*command, examples);
}

/// Thrown where the options are read and the command would begin.
struct ReadAll {};

struct WholeProgram {
  CommandContext context;
  CLI::App app{"", "aligngs"};
  WholeProgram() {
    app.fallthrough();
    add_all_commands(app, context);
    app.parse_complete_callback([] { throw ReadAll(); });
  }
};

std::vector<HelpExample> all_examples() {
  std::vector<HelpExample> examples;
  gather_examples(WholeProgram().app, examples);
  return examples;
}

TEST(HelpExamples, AreThere) { EXPECT_GT(all_examples().size(), 60u); }

TEST(HelpExamples, HaveOptionsThatExist) {
  for (const HelpExample& example : all_examples()) {
    WholeProgram program;
    std::vector<std::string> words(example.words.rbegin(), example.words.rend());  // as CLI11 wants them
    try {
      program.app.parse(words);
      ADD_FAILURE() << example.line << ": no command";
    } catch (const ReadAll&) {
    } catch (const CLI::ParseError& error) {
      ADD_FAILURE() << example.line << ": " << error.what();
    }
  }
}

TEST(HelpExamples, SetSettingsThatExist) {
  size_t settings = 0;
  for (const HelpExample& example : all_examples()) {
    for (size_t i = 0; i + 1 < example.words.size(); ++i) {
      if (example.words[i] != "--set") continue;
      ++settings;
      const std::string& set = example.words[i + 1];
      TrainConfig config = make_preset(Preset::kDefault);
      EXPECT_NO_THROW(set_config(config, set.substr(0, set.find('=')), set.substr(set.find('=') + 1))) << example.line;
    }
  }
  EXPECT_GT(settings, 0u);
}

}  // namespace
}  // namespace aligngs
