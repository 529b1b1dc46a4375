// Names of tensors of one layout turned into those of another.
#pragma once

#include <string>

namespace aligngs::nn {

/// Replaces `from` at the beginning of a name; false when it does not begin so.
inline bool replace_start(std::string& name, const std::string& from, const std::string& to) {
  if (name.compare(0, from.size(), from) != 0) return false;
  name = to + name.substr(from.size());
  return true;
}

/// Replaces the first `from` anywhere.
inline bool replace_part(std::string& name, const std::string& from, const std::string& to) {
  const size_t at = name.find(from);
  if (at == std::string::npos) return false;
  name.replace(at, from.size(), to);
  return true;
}

}  // namespace aligngs::nn
