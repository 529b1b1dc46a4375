// `aligngs completion` and `aligngs manual`: what a shell and `man` need to know, made from the command tree itself.
#include <CLI/App.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "cli/shell/completions.h"
#include "cli/shell/man_page.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "io/output_place.h"
#include "train/replaceable_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

std::string completion_for(const std::string& shell, const CommandInfo& program) {
  if (shell == "bash") return bash_completion(program);
  if (shell == "zsh") return zsh_completion(program);
  return fish_completion(program);
}

}  // namespace

void add_completion_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("completion", "Print the completion script of a shell");
  command->group("Look");
  command->footer(
      help_footer({.reads = "nothing",
                   .writes = "standard output",
                   .example = "aligngs completion bash > ~/.local/share/bash-completion/completions/aligngs",
                   .advanced = "aligngs completion zsh > ~/.zfunc/_aligngs",
                   .notes = "Packages install these scripts; a build from source does not.\n"
                            "fish reads ~/.config/fish/completions/aligngs.fish."}));
  auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([&program, &context, shell] {
    const std::string script = completion_for(*shell, describe_command(program));
    if (context.global.json)
      print_json(nlohmann::json{{"shell", *shell}, {"script", script}});
    else
      std::fputs(script.c_str(), stdout);
  });
}

void add_manual_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("manual", "Write manual pages, one per command");
  command->group("Look");
  command->footer(help_footer({.reads = "nothing",
                               .writes = "FOLDER: aligngs.1, aligngs-run.1 and so on",
                               .example = "aligngs manual ~/.local/share/man/man1",
                               .advanced = "aligngs manual pages --json",
                               .notes = "Pages of these names that aligngs did not write are never replaced."}));
  auto folder = std::make_shared<fs::path>();
  command->add_option("folder", *folder, "folder for the pages; it is made where it is missing")->required();
  command->callback([&program, &context, folder] {
    std::error_code error;
    fs::create_directories(*folder, error);
    if (error)
      throw Error(
          {ErrorKind::kResources, "the folder cannot be made: " + error.message(), *folder, {}, "give another folder"});
    const CommandInfo tree = describe_command(program);
    for (const CommandInfo* page : all_commands(tree)) {  // before the first is written
      require_file_place(*folder / man_page_name(*page));
      require_replaceable(*folder / man_page_name(*page), man_page_beginning(*page));
    }
    nlohmann::json pages = nlohmann::json::array();
    for (const CommandInfo* page : all_commands(tree)) {
      write_file_atomically(*folder / man_page_name(*page), man_page(*page, tree));
      pages.push_back(man_page_name(*page));
    }
    if (context.global.json)
      print_json(nlohmann::json{{"folder", folder->string()}, {"pages", pages}});
    else
      std::printf("%zu pages in %s\n", pages.size(), folder->c_str());
  });
}

}  // namespace aligngs
