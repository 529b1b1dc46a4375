#include "serve/request_admission.h"

#include "serve/request_rules.h"

namespace aligngs {

bool is_get(const Request& request) {
  return request.method() == http::verb::get || request.method() == http::verb::head;
}

namespace {

/// Headers that decide who may ask, and how a body is read. A second one would let two readers see two requests.
constexpr const char* kOnce[] = {"Host",         "Origin",         "Sec-Fetch-Site", "Sec-Fetch-Mode",
                                 "Content-Type", "Sec-Fetch-Dest", "X-AlignGS-Token"};

std::optional<std::string> repeated_header(const Request& request) {
  for (const char* name : kOnce) {
    if (request.count(name) > 1) return std::string("the header ") + name + " is there twice";
  }
  return {};
}

}  // namespace

std::optional<HttpAnswer> refusal_of(const Request& request, const ViewServerOptions& options,
                                     const std::string& token) {
  if (const auto repeated = repeated_header(request)) return refusal(request, http::status::bad_request, *repeated);
  if (request.version() >= 11 && request.count(http::field::host) == 0)
    return refusal(request, http::status::bad_request, "the header Host is missing");
  const std::string_view host = view_of(request[http::field::host]);
  if (!host_allowed(host, options.allowed_hosts)) {
    return refusal(request, http::status::forbidden, "this host name is not served; see --allow-host");
  }
  const auto path = decode_request_path(view_of(request.target()));
  if (!path) return refusal(request, http::status::bad_request, "bad path");
  const FetchOrigin origin{view_of(request["Sec-Fetch-Site"]), view_of(request["Sec-Fetch-Mode"]),
                           view_of(request["Sec-Fetch-Dest"])};
  if (!fetch_allowed(origin, is_get(request), *path))
    return refusal(request, http::status::forbidden, "requests of other sites are refused");
  if (is_get(request)) return {};
  if (request.method() != http::verb::post) {
    return refusal(request, http::status::method_not_allowed, "only GET, HEAD and POST are served");
  }
  PostHeaders headers;
  headers.host = host;
  headers.origin = view_of(request[http::field::origin]);
  headers.token = view_of(request["X-AlignGS-Token"]);
  headers.content_type = view_of(request[http::field::content_type]);
  if (!post_allowed(headers, token))
    return refusal(request, http::status::forbidden, "wrong origin, token or content type");
  if (!options.post.contains(*path)) return refusal(request, http::status::not_found, "not found");
  return {};
}

}  // namespace aligngs
