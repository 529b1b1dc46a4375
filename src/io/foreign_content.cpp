#include "io/foreign_content.h"

#include <cctype>
#include <string>

#include "core/error.h"

namespace aligngs {
namespace {

bool begins(std::string_view text, std::string_view word) {
  if (text.size() < word.size()) return false;
  for (size_t i = 0; i < word.size(); ++i) {
    if (std::tolower(static_cast<unsigned char>(text[i])) != word[i]) return false;
  }
  return true;
}

}  // namespace

void refuse_foreign_content(std::string_view bytes, const std::filesystem::path& file) {
  if (bytes.empty()) throw_bad_input(file, "", "the file is empty", "copy the file again");
  if (begins(bytes, "version https://git-lfs"))
    throw_bad_input(file, "", "this is a pointer of Git LFS, not the file itself",
                    "fetch the file with `git lfs pull`");
  const size_t start = bytes.find_first_not_of(" \t\r\n");
  const std::string_view text = start == bytes.npos ? std::string_view() : bytes.substr(start);
  if (begins(text, "<!doctype html") || begins(text, "<html"))
    throw_bad_input(file, "", "this is a web page, not the file itself", "download the file again");
}

}  // namespace aligngs
