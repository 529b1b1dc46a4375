#include "serve/page_answer.h"

#include <functional>
#include <memory>
#include <utility>

#include "serve/request_rules.h"
#include "serve/web_page.h"

namespace aligngs {
namespace {

constexpr uint64_t kLargestPageFile = uint64_t(64) << 20;  // bytes of one file of --web-root

}  // namespace

std::string etag_of(std::string_view bytes) {
  return "\"" + std::to_string(std::hash<std::string_view>()(bytes)) + "\"";
}

HttpAnswer page_answer(const Request& request, const std::string& path, const PageSource& source) {
  const std::string name = path == "/" ? "/index.html" : path;
  Download download{std::string(content_type_of(name)), {}, false, AnswerPolicy::kPage, {}, {}};
  if (!source.web_root.empty()) {
    std::error_code error;
    const auto root = std::filesystem::canonical(source.web_root, error);
    if (!error) download.file = ServedFile::open(root, name.substr(1));
    if (!download.file || download.file->size() > kLargestPageFile)
      return refusal(request, http::status::not_found, "not found");
    download.etag = download.file->etag();
  } else {
    const auto content = embedded_page_file(name);
    if (content.empty()) return refusal(request, http::status::not_found, "not found");
    download.prepared =
        std::make_shared<const std::string>(reinterpret_cast<const char*>(content.data()), content.size());
    download.etag = etag_of(*download.prepared);
    download.gzip = true;
  }
  if (path != "/") return download_answer(request, std::move(download));
  // The page itself brings the token of this server: it is never taken from a cache.
  Request afresh = request;
  afresh.erase(http::field::if_none_match);
  HttpAnswer answer = download_answer(afresh, std::move(download));
  answer.head.set(http::field::cache_control, "no-store");
  std::string links;
  for (const std::string& address : source.first_requests)
    links += (links.empty() ? "<" : ", <") + address + ">; rel=preload; as=fetch; crossorigin";
  answer.head.set(http::field::link, links);
  answer.head.set(http::field::set_cookie, "aligngs_" + port_of(view_of(request[http::field::host])) + "=" +
                                               source.token + "; SameSite=Strict; Path=/");
  return answer;
}

}  // namespace aligngs
