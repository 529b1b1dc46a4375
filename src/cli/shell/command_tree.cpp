#include "cli/shell/command_tree.h"

#include <CLI/App.hpp>

namespace aligngs {
namespace {

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

OptionInfo describe_option(const CLI::Option& option) {
  OptionInfo out;
  out.positional = option.get_positional();
  if (out.positional) out.names.push_back(option.get_name(true));
  for (const std::string& name : option.get_snames()) out.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) out.names.push_back("--" + name);
  out.description = one_line(option.get_description());
  out.group = option.get_group();
  out.required = option.get_required();
  out.standard = option.get_default_str();
  if (option.get_items_expected_max() > 0) {
    ValueWords words = value_words(option.get_type_name());
    out.value = words.value.empty() ? "VALUE" : words.value;
    out.choices = std::move(words.choices);
  }
  return out;
}

}  // namespace

ValueWords value_words(const std::string& type_name) {
  ValueWords out;
  out.value = type_name.substr(0, type_name.find(':'));
  const size_t begin = type_name.find(":{"), end = type_name.find('}', begin == std::string::npos ? 0 : begin);
  if (begin == std::string::npos || end == std::string::npos) return out;
  std::string word;
  for (size_t i = begin + 2; i <= end; ++i) {
    if (i < end && type_name[i] != ',') {
      word += type_name[i];
    } else {
      out.choices.push_back(word);
      word.clear();
    }
  }
  return out;
}

CommandInfo describe_command(const CLI::App& app, const std::string& path) {
  CommandInfo out;
  out.path = path;
  out.description = path.empty() ? app.get_description() : one_line(app.get_description());
  out.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) out.options.push_back(describe_option(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_group().empty()) continue;
    out.commands.push_back(
        describe_command(*command, path.empty() ? command->get_name() : path + " " + command->get_name()));
  }
  return out;
}

std::vector<const CommandInfo*> all_commands(const CommandInfo& root) {
  std::vector<const CommandInfo*> out = {&root};
  for (const CommandInfo& command : root.commands) {
    for (const CommandInfo* below : all_commands(command)) out.push_back(below);
  }
  return out;
}

}  // namespace aligngs
