#include "core/error.h"

namespace aligngs {
namespace {

std::string describe(const Error::Details& details) {
  std::string text;
  if (!details.path.empty()) text += details.path.string() + ": ";
  if (!details.field.empty()) text += details.field + ": ";
  text += details.message;
  if (!details.remedy.empty()) text += "\n  remedy: " + details.remedy;
  return text;
}

}  // namespace

Error::Error(Details details) : std::runtime_error(describe(details)), details_(std::move(details)) {}

void throw_bad_input(const std::filesystem::path& path, const std::string& field, const std::string& message,
                     const std::string& remedy) {
  throw Error({ErrorKind::kBadInput, message, path, field, remedy});
}

void throw_usage(const std::string& message, const std::string& remedy) {
  throw Error({ErrorKind::kUsage, message, {}, {}, remedy});
}

void throw_resources(const std::filesystem::path& path, const std::string& message, const std::string& remedy) {
  throw Error({ErrorKind::kResources, message, path, {}, remedy});
}

}  // namespace aligngs
