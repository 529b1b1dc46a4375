#include "cli/help_text.h"

namespace aligngs {

std::string help_footer(const HelpText& text) {
  std::string footer = text.notes;
  if (!footer.empty()) footer += "\n\n";
  return footer + "Reads:    " + text.reads + "\nWrites:   " + text.writes + "\nExample:  " + text.example + "\nAdvanced: " + text.advanced;
}

}  // namespace aligngs
