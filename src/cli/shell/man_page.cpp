#include "cli/shell/man_page.h"
#include "core/version.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace aligngs {
namespace {

/// Text that roff prints as it is: dashes stay dashes, and no line begins with a control character.
std::string plain(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    line_start = c == '\n';
    if (c == '-')
      out += "\\-";
    else if (c == '\\')
      out += "\\e";
    else
      out += c;
  }
  return out;
}

std::string page_of(const std::string& path) {
  std::string out = path.empty() ? "aligngs" : "aligngs-" + path;
  std::replace(out.begin(), out.end(), ' ', '-');
  return out;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string option_entry(const OptionInfo& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + plain(name);
  std::string out = fmt::format(".TP\n.B {}", names);
  if (!option.value.empty() && !option.positional) out += " " + plain(option.value);
  out += "\n" + plain(option.description);
  if (!option.choices.empty()) {
    std::string choices;
    for (const std::string& choice : option.choices) choices += (choices.empty() ? "" : ", ") + choice;
    out += fmt::format("\n.br\nOne of: {}.", plain(choices));
  }
  if (!option.standard.empty()) out += fmt::format("\n.br\nDefault: {}.", plain(option.standard));
  if (option.required) out += "\n.br\nRequired.";
  return out + "\n";
}

/// Options under the headings of the help, in the order in which these first come.
std::string option_sections(const CommandInfo& command) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (const OptionInfo& option : command.options) {
    const std::string heading = option.positional ? "Arguments" : option.group == "Options" ? "General" : option.group;
    auto found = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == heading; });
    if (found == groups.end())
      found = groups.insert(heading == "Arguments" ? groups.begin() : groups.end(), {heading, ""});
    found->second += option_entry(option);
  }
  std::string out;
  for (const auto& [heading, entries] : groups) out += fmt::format(".SS {}\n{}", plain(heading), entries);
  return out;
}

}  // namespace

std::string man_page_name(const CommandInfo& command) { return page_of(command.path) + ".1"; }

std::string man_page_beginning(const CommandInfo& command) {
  return fmt::format(".TH {} 1 \"\" \"aligngs ", plain(upper(page_of(command.path))));
}

std::string man_page(const CommandInfo& command, const CommandInfo& program) {
  const std::string page = page_of(command.path);
  const bool top = command.path.empty();
  std::string brief = command.description.substr(0, command.description.find('\n'));
  while (!brief.empty() && (brief.back() == ',' || brief.back() == '.')) brief.pop_back();
  std::string out = man_page_beginning(command) + version() + "\" \"aligngs\"\n";
  out += fmt::format(".SH NAME\n{} \\- {}\n", plain(page), plain(brief));
  out += fmt::format(".SH SYNOPSIS\n.B aligngs{}\n[OPTIONS]", top ? "" : " " + plain(command.path));
  for (const OptionInfo& option : command.options) {
    if (option.positional)
      out += option.required ? " " + plain(option.names.front()) : " [" + plain(option.names.front()) + "]";
  }
  out += command.commands.empty() ? "\n" : " COMMAND ...\n";
  if (!command.footer.empty() || top) {
    out += fmt::format(".SH DESCRIPTION\n.nf\n{}\n.fi\n", plain(top ? command.description : command.footer));
  }
  if (!command.commands.empty()) {
    out += ".SH COMMANDS\n";
    for (const CommandInfo& below : command.commands) {
      out += fmt::format(".TP\n.BR {} (1)\n{}\n", plain(page_of(below.path)), plain(below.description));
    }
  }
  out += ".SH OPTIONS\n" + option_sections(command);
  if (!top) {
    CommandInfo everywhere;
    for (const OptionInfo& option : program.options) {
      if (option.group == "Everywhere") everywhere.options.push_back(option);
    }
    out += option_sections(everywhere);
  }
  out +=
      ".SH EXIT STATUS\n"
      ".TP\n.B 0\nThe command did its work.\n"
      ".TP\n.B 2\nThe command line is wrong.\n"
      ".TP\n.B 3\nThe input is bad.\n"
      ".TP\n.B 4\nNetwork weights are missing or damaged.\n"
      ".TP\n.B 5\nMemory, disk or a device is missing.\n"
      ".TP\n.B 75\nA signal stopped the command, and the same command can go on.\n"
      ".TP\n.B 1\nAnything else failed.\n";
  if (!top) out += ".SH SEE ALSO\n.BR aligngs (1)\n";
  return out;
}

}  // namespace aligngs
