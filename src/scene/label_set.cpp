#include "scene/label_set.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>

#include "core/error.h"
#include "core/letter_case.h"
#include "io/atomic_file.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr size_t kMaxLabelFile = size_t(16) << 20;  // bytes; 65534 classes with long synonym lists fit
constexpr int kMaxClasses = 65534;                  // 65535 is kNoLabel

std::string folded(std::string_view text) { return lower_case(trimmed(text)); }

/// folded(text) == wanted, without a copy: an edit asks this for every word of every class.
bool folds_to(std::string_view text, std::string_view wanted) {
  const std::string_view core = trimmed(text);
  return core.size() == wanted.size() &&
         std::equal(core.begin(), core.end(), wanted.begin(), [](char a, char b) { return lower_case(a) == b; });
}

/// Splits one CSV line; a field may be in double quotes, with "" for a quote (RFC 4180, single lines only).
std::vector<std::string> split_csv(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted) {
      if (c != '"') {
        fields.back() += c;
      } else if (i + 1 < line.size() && line[i + 1] == '"') {
        fields.back() += '"';
        ++i;
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::string quoted_csv(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string out = "\"";
  for (char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

/// Reads rows of labels.csv by the names of its header.
class LabelTable {
 public:
  LabelTable(const std::filesystem::path& path, const std::string& header) : path_(path) {
    const std::vector<std::string> names = split_csv(header);
    for (size_t i = 0; i < names.size(); ++i) columns_.emplace(folded(names[i]), i);
    for (const char* needed : {"index", "name", "r", "g", "b"}) {
      if (!columns_.count(needed)) {
        throw_bad_input(path, "line 1", std::string("the header has no column '") + needed + "'",
                        "start the file with the line index,name,synonyms,r,g,b");
      }
    }
  }

  void read_row(const std::string& line, int line_number) {
    line_ = line_number;
    fields_ = split_csv(line);
    const int index = number("index", kMaxClasses - 1);
    LabelClass entry;
    entry.name = text("name");
    if (folded(entry.name).empty()) throw_bad_input(path_, field("name"), "a class without a name", "give it a name");
    entry.color = {static_cast<uint8_t>(number("r", 255)), static_cast<uint8_t>(number("g", 255)),
                   static_cast<uint8_t>(number("b", 255))};
    std::string word;
    for (char c : text("synonyms") + ";") {
      if (c != ';') {
        word += c;
        continue;
      }
      if (!folded(word).empty()) entry.synonyms.push_back(word);
      word.clear();
    }
    if (!rows_.emplace(index, std::move(entry)).second) {
      throw_bad_input(path_, field("index"), "class " + std::to_string(index) + " appears twice",
                      "number the classes 0, 1, 2, ... without repetition");
    }
  }

  std::vector<LabelClass> classes() {
    if (rows_.empty()) throw_bad_input(path_, "", "no class in the file", "add one line per class");
    const int expected = static_cast<int>(rows_.size());
    if (rows_.rbegin()->first != expected - 1) {
      throw_bad_input(
          path_, "index",
          std::to_string(expected) + " classes, but the largest index is " + std::to_string(rows_.rbegin()->first),
          "number the classes 0, 1, 2, ... without gaps");
    }
    std::vector<LabelClass> out;
    for (auto& [index, entry] : rows_) out.push_back(std::move(entry));
    return out;
  }

 private:
  std::string field(const char* column) const { return "line " + std::to_string(line_) + ", column " + column; }
  std::string text(const char* column) const {
    const auto found = columns_.find(column);
    return found != columns_.end() && found->second < fields_.size() ? fields_[found->second] : std::string();
  }
  int number(const char* column, int largest) const {
    const std::string value = folded(text(column));
    int n = -1;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), n);
    if (error != std::errc() || end != value.data() + value.size() || n < 0 || n > largest) {
      throw_bad_input(path_, field(column), "'" + value + "' is no whole number from 0 to " + std::to_string(largest),
                      "correct this line");
    }
    return n;
  }

  std::filesystem::path path_;
  std::map<std::string, size_t> columns_;
  std::map<int, LabelClass> rows_;
  std::vector<std::string> fields_;
  int line_ = 1;
};

}  // namespace

int LabelSet::find(const std::string& name_or_synonym) const {
  const std::string wanted = folded(name_or_synonym);
  for (int i = 0; i < size(); ++i) {
    if (folds_to(classes[i].name, wanted)) return i;
  }
  for (int i = 0; i < size(); ++i) {
    for (const std::string& synonym : classes[i].synonyms) {
      if (folds_to(synonym, wanted)) return i;
    }
  }
  return -1;
}

LabelSet read_label_csv(const std::filesystem::path& path) {
  std::string content = read_file(path, kMaxLabelFile);
  if (content.rfind("\xef\xbb\xbf", 0) == 0) content.erase(0, 3);  // byte order mark of spreadsheet programs
  std::vector<std::string> lines(1);
  for (char c : content) {
    if (c == '\n') {
      lines.emplace_back();
    } else if (c != '\r') {
      lines.back() += c;
    }
  }
  LabelTable table(path, lines[0]);
  for (size_t i = 1; i < lines.size(); ++i) {
    if (!folded(lines[i]).empty()) table.read_row(lines[i], static_cast<int>(i) + 1);
  }
  LabelSet labels;
  labels.name = path.filename().string();
  labels.classes = table.classes();
  return labels;
}

void write_label_csv(const std::filesystem::path& path, const LabelSet& labels) {
  std::string out = "index,name,synonyms,r,g,b\n";
  for (int i = 0; i < labels.size(); ++i) {
    const LabelClass& entry = labels.classes[i];
    std::string synonyms;
    for (const std::string& synonym : entry.synonyms) synonyms += (synonyms.empty() ? "" : ";") + synonym;
    out += std::to_string(i) + "," + quoted_csv(entry.name) + "," + quoted_csv(synonyms);
    for (uint8_t value : entry.color) out += "," + std::to_string(value);
    out += "\n";
  }
  write_file_atomically(path, out);
}

}  // namespace aligngs
