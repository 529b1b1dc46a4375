// The JSON files of a run as the page reads them.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace aligngs {

/// Each file is read once, and the page shows its fault.
class RunDescriptions {
 public:
  using Json = nlohmann::json;

  /// The value of a file below `root`, null when it is absent, unreadable or nested too deeply.
  const Json& read(const std::filesystem::path& root, const std::string& name) { return entry(root, name).value; }
  /// read() of a file that is a JSON object.
  const Json& object(const std::filesystem::path& root, const std::string& name);
  /// Why a file that is a JSON object cannot be read; null where it can.
  const Json& fault(const std::filesystem::path& root, const std::string& name);
  /// The views and measurements of page.json; null without any.
  Json notes(const std::filesystem::path& root);
  const Json& problems() const { return problems_; }

 private:
  struct Entry {
    Json value, fault;
  };

  Entry& entry(const std::filesystem::path& root, const std::string& name);
  Entry read_now(const std::filesystem::path& root, const std::string& name);
  Entry faulty(const std::string& told);

  std::map<std::filesystem::path, Entry> files_;
  Json problems_ = Json::array();
};

/// The value of a name; null where `object` is none or has no such name.
nlohmann::json json_field(const nlohmann::json& object, const char* name);

}  // namespace aligngs
