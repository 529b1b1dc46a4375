#include "serve/event_lines.h"

#include <algorithm>

#include "serve/request_body.h"

namespace aligngs {

std::string event_array(std::string_view lines) {
  std::string array = "[";
  while (!lines.empty()) {
    std::string_view line = lines.substr(0, lines.find('\n'));
    lines.remove_prefix(std::min(lines.size(), line.size() + 1));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty() || line.front() != '{' || line.find('\r') != std::string_view::npos || json_fault(line)) continue;
    if (array.size() > 1) array += ',';
    array += line;
  }
  return array + "]";
}

}  // namespace aligngs
