// Answers with the files of the page: those in the program, or of a folder while the page is developed.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "serve/http_answer.h"

namespace aligngs {

struct PageSource {
  const std::filesystem::path& web_root;    ///< empty: the files in the program
  std::vector<std::string> first_requests;  ///< addresses that the page will ask for at once
  const std::string& token;                 ///< of the server, which the page itself brings as a cookie
};

/// "/" is the page itself, which is never taken from a cache. 404 for what is no file of the page.
HttpAnswer page_answer(const Request& request, const std::string& path, const PageSource& source);

/// The ETag of bytes, with its quotes.
std::string etag_of(std::string_view bytes);

}  // namespace aligngs
