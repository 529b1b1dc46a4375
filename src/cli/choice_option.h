// Options of the command line whose words are those of an enum (core/choice_words.h).
#pragma once

#include <CLI/App.hpp>

#include <string>

#include "core/choice_words.h"

namespace aligngs {

/// Adds an option that takes one of the enum's words in any case; `choice` is the default and must outlive the command.
template <class Choice>
CLI::Option* add_choice_option(CLI::App& command, const std::string& name, Choice& choice, const std::string& help) {
  const auto take = [&choice](const std::string& word) { choice = choice_named<Choice>(word).value(); };
  return command.add_option_function<std::string>(name, take, help)
      ->transform(CLI::IsMember(choice_list<Choice>(), CLI::ignore_case))
      ->default_str(std::string(word_of(choice)));
}

}  // namespace aligngs
