// The names, synonyms and colours of the classes; ADE20K's 150 unless a scene brings labels.csv.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

struct LabelClass {
  std::string name;                   ///< the first name, e.g. "sofa"
  std::vector<std::string> synonyms;  ///< further names, e.g. "couch", "lounge"
  std::array<uint8_t, 3> color{};     ///< sRGB
};

struct LabelSet {
  std::string name;                 ///< "ade20k150", or the file it came from
  std::vector<LabelClass> classes;  ///< index = class number
  int size() const { return static_cast<int>(classes.size()); }
  /// Class number of a name or synonym (case-insensitive), or -1.
  int find(const std::string& name_or_synonym) const;
};

const LabelSet& ade20k_labels();

/// Reads labels.csv: a header line, then one class per line with columns index,name,synonyms,r,g,b
/// (any order, named in the header; synonyms separated by ';'). Throws Error{kBadInput}.
LabelSet read_label_csv(const std::filesystem::path& path);
void write_label_csv(const std::filesystem::path& path, const LabelSet& labels);

}  // namespace aligngs
