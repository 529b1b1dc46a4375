#include "cli/given_options.h"

#include <CLI/App.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "cli/command.h"
#include "core/error.h"

namespace aligngs {
namespace {

void require_values_of(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || option->get_items_expected_max() == 0) continue;
    const bool number = option->get_type_name().rfind("FLOAT", 0) == 0;
    for (const std::string& value : option->results()) {
      if (value.empty()) {
        throw_usage(option->get_name() + " has an empty value",
                    "give a value, or leave the option out; a variable of the shell may be unset");
      }
      if (number && !std::isfinite(std::strtod(value.c_str(), nullptr)))
        throw_usage(option->get_name() + ": \"" + value + "\" is no finite number", "give a number");
    }
  }
}

/// The called command, as deep as it goes ("models download").
const CLI::App& called(const CLI::App& program, const std::vector<std::string>& arguments) {
  const CLI::App* app = &program;
  for (const std::string& word : arguments) {
    for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; })) {
      if (command->get_name() != word) continue;
      app = command;
      break;
    }
  }
  return *app;
}

}  // namespace

void require_given_values(const CLI::App& program) {
  require_values_of(program);
  for (const CLI::App* command : program.get_subcommands()) require_given_values(*command);
}

UnknownOption find_unknown_option(const CLI::App& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> known;
  for (const CLI::App* app = &called(program, arguments); app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
  }
  for (const std::string& word : arguments) {
    if (word == "--") break;
    if (word.rfind("--", 0) != 0) continue;
    const std::string name = word.substr(0, word.find('='));
    if (std::find(known.begin(), known.end(), name) == known.end()) return {name, nearest_word(name, known)};
  }
  return {};
}

}  // namespace aligngs
