#include "cli/given_options.h"

#include <CLI/App.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>

#include "cli/command.h"
#include "core/error.h"

namespace aligngs {
namespace {

/// "--overwrite" after -o, or a short option of the command: its own value was forgotten.
bool is_option(const CLI::App& app, const std::string& value) {
  if (value.size() > 2 && value.rfind("--", 0) == 0) return true;
  if (value.size() != 2 || value[0] != '-') return false;
  for (const CLI::App* at = &app; at != nullptr; at = at->get_parent()) {
    if (at->get_option_no_throw(value) != nullptr) return true;
  }
  return false;
}

/// Whole numbers that do not fit would wrap around or stop at the largest number.
bool fits_whole_number(const std::string& value, bool with_sign) {
  const size_t begin = with_sign && !value.empty() && (value[0] == '-' || value[0] == '+') ? 1 : 0;
  if (value.size() == begin || value.find_first_not_of("0123456789", begin) != std::string::npos) return false;
  errno = 0;
  with_sign ? void(std::strtoll(value.c_str(), nullptr, 10)) : void(std::strtoull(value.c_str(), nullptr, 10));
  return errno == 0;
}

void require_value(const CLI::App& app, const CLI::Option& option, const std::string& value) {
  const auto has_type = [&](const char* type) { return option.get_type_name().rfind(type, 0) == 0; };
  const std::string name = option.get_name();
  if (value.empty())
    throw_usage(name + " has an empty value",
                "give a value, or leave the option out; a variable of the shell may be unset");
  if (!option.get_positional() && is_option(app, value))
    throw_usage(name + " needs a value: \"" + value + "\" is an option",
                "give a value after " + name + "; a name that begins with a dash is written as ./" + value);
  if (value == "-" && option.get_group() == "Output folder")
    throw_usage(name + ": \"-\" is no name of a folder; nothing is written to standard output", "name a folder");
  if (has_type("FLOAT") && !std::isfinite(std::strtod(value.c_str(), nullptr)))
    throw_usage(name + ": \"" + value + "\" is no finite number", "give a number");
  if (has_type("UINT") && !fits_whole_number(value, false))
    throw_usage(name + ": \"" + value + "\" is no whole number from zero on", "give a whole number, in digits");
  if (has_type("INT") && !fits_whole_number(value, true))
    throw_usage(name + ": \"" + value + "\" is no whole number that fits", "give a smaller whole number, in digits");
}

void require_values_of(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || option->get_items_expected_max() == 0) continue;
    for (const std::string& value : option->results()) require_value(app, *option, value);
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

/// The shortest of the names that begin with `typed`, as "--delete" for "--dele"; else the one that is spelled alike.
std::string nearest_option(const std::string& typed, const std::vector<std::string>& known) {
  constexpr size_t kFewestLetters = 3;  // two dashes and one letter tell too little
  std::string best;
  for (const std::string& name : known) {
    if (typed.size() > kFewestLetters && name.starts_with(typed) && (best.empty() || name.size() < best.size()))
      best = name;
  }
  return best.empty() ? nearest_word(typed, known) : best;
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
    if (std::find(known.begin(), known.end(), name) == known.end()) return {name, nearest_option(name, known)};
  }
  return {};
}

}  // namespace aligngs
