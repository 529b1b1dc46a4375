#include "serve/http_answer.h"

#include <nlohmann/json.hpp>

#include "io/json_text.h"
#include "io/text_encoding.h"
#include "serve/request_rules.h"

namespace aligngs {
namespace {

constexpr const char* kPagePolicy =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self' blob:; "
    "object-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
/// A report with its pictures may be looked at.
constexpr const char* kFilePolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src 'self' data:; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

http::response<http::empty_body> head_of(const Request& request, http::status status, std::string_view type,
                                         AnswerPolicy policy) {
  http::response<http::empty_body> head{status, request.version()};
  head.set(http::field::server, "aligngs");
  head.set("X-Content-Type-Options", "nosniff");
  head.set("Referrer-Policy", "no-referrer");
  head.set("Cross-Origin-Resource-Policy", "same-origin");
  head.set("Cross-Origin-Opener-Policy", "same-origin");
  head.set("Content-Security-Policy", policy == AnswerPolicy::kPage ? kPagePolicy : kFilePolicy);
  head.set(http::field::cache_control, "no-store");
  head.set(http::field::content_type, beast_view(type));
  head.keep_alive(request.keep_alive());
  return head;
}

HttpAnswer json_answer(const Request& request, http::status status, const nlohmann::json& body) {
  return text_answer(request, status, json_line(body), "application/json");
}

}  // namespace

HttpAnswer text_answer(const Request& request, http::status status, std::string body, std::string_view type) {
  HttpAnswer answer;
  answer.head = head_of(request, status, type, AnswerPolicy::kPage);
  answer.text = std::move(body);
  answer.bytes = {0, answer.text.size()};
  answer.head.content_length(answer.text.size());
  return answer;
}

HttpAnswer refusal(const Request& request, http::status status, std::string_view why) {
  HttpAnswer answer = json_answer(request, status, nlohmann::json{{"error", why}});
  answer.head.keep_alive(false);
  return answer;
}

HttpAnswer refusal(const Request& request, const Error& error) {
  const bool theirs = error.kind() == ErrorKind::kUsage || error.kind() == ErrorKind::kBadInput;
  const std::string file = as_utf8(error.details().path.filename().string());  // the page knows the run's folder
  return json_answer(request, theirs ? http::status::bad_request : http::status::internal_server_error,
                     {{"error", (file.empty() ? "" : file + ": ") + error.details().message},
                      {"remedy", error.details().remedy},
                      {"field", error.details().field}});
}

HttpAnswer download_answer(const Request& request, Download download) {
  HttpAnswer answer;
  const uint64_t size = download.file ? download.file->size() : download.prepared->size();
  const AskedRange asked =
      asked_range(view_of(request[http::field::range]), view_of(request[http::field::if_range]), download.etag, size);
  http::status status = http::status::ok;
  answer.bytes = {0, size};
  const std::string_view if_match = view_of(request[http::field::if_match]);
  if (!if_match.empty() && !names_etag(if_match, download.etag)) {
    return refusal(request, http::status::precondition_failed, "the file has changed");
  }
  if (names_etag(view_of(request[http::field::if_none_match]), download.etag)) {
    status = http::status::not_modified;
    answer.bytes = {0, 0};
  } else if (asked.kind == AskedRange::Kind::kPart) {
    status = http::status::partial_content;
    answer.bytes = asked.bytes;
  } else if (asked.kind == AskedRange::Kind::kBeyondTheFile) {
    status = http::status::range_not_satisfiable;
    answer.bytes = {0, 0};
  }
  answer.head = head_of(request, status, download.type, download.policy);
  answer.head.set(http::field::etag, download.etag);
  answer.head.set(http::field::accept_ranges, "bytes");
  answer.head.set(http::field::cache_control, "no-cache");  // kept, and asked for again with its ETag
  if (is_text_type(download.type)) answer.head.set(http::field::vary, "Accept-Encoding");
  if (download.gzip) answer.head.set(http::field::content_encoding, "gzip");
  if (status == http::status::partial_content)
    answer.head.set(http::field::content_range, content_range(answer.bytes, size));
  if (status == http::status::range_not_satisfiable)
    answer.head.set(http::field::content_range, "bytes */" + std::to_string(size));
  if (status != http::status::not_modified) answer.head.content_length(answer.bytes.count);
  answer.prepared = std::move(download.prepared);
  answer.file = std::move(download.file);
  return answer;
}

}  // namespace aligngs
