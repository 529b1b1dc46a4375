// Answers of the server: a head with its security headers, and a body that is a text, a prepared stream or a file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.h"
#include "serve/byte_range.h"
#include "serve/http_types.h"
#include "serve/served_file.h"

namespace aligngs {

enum class AnswerPolicy {
  kPage,  ///< scripts of this server may run
  kFile,  ///< nothing in a run folder may run, as a run may come from anywhere
};

/// The head has Content-Length of the body, also where HEAD or status 304 sends none.
struct HttpAnswer {
  http::response<http::empty_body> head;
  std::string text;  ///< the body, unless one of the others is given
  std::shared_ptr<const std::string> prepared;
  std::optional<ServedFile> file;
  ByteRange bytes;  ///< the part of the body that is sent
};

/// A body of text.
HttpAnswer text_answer(const Request& request, http::status status, std::string body, std::string_view type);
/// {"error": WHY}; the connection ends with it.
HttpAnswer refusal(const Request& request, http::status status, std::string_view why);
/// The error as JSON: 400 for what makes no sense, 500 for what is our fault. The connection goes on.
HttpAnswer refusal(const Request& request, const Error& error);

/// A body that may be asked for in parts. Honours Range, If-Range and If-None-Match of the request: status 200, 206,
/// 304 or 416.
struct Download {
  std::string type;   ///< content type
  std::string etag;   ///< with its quotes
  bool gzip = false;  ///< the bytes are a gzip stream
  AnswerPolicy policy = AnswerPolicy::kFile;
  std::shared_ptr<const std::string> prepared;
  std::optional<ServedFile> file;
};
HttpAnswer download_answer(const Request& request, Download download);

}  // namespace aligngs
