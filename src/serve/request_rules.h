// Requests that the page's server answers: everything that protects a local server from other web sites.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

/// The Host header names this machine: localhost, 127.0.0.1 or [::1] with any port (`ssh -L` changes the port). It may
/// also be one of `allowed` (host names without port). Letters have no case. Refusing other names stops DNS rebinding.
bool host_allowed(std::string_view host, const std::vector<std::string>& allowed);

/// A request target in absolute form, "http://localhost:7860/files?v=1", in its two parts (RFC 9112, section 3.2.2).
struct AbsoluteTarget {
  std::string host, target;
};
/// Nothing for a target in another form, with another scheme, or with a user before its host.
std::optional<AbsoluteTarget> absolute_target(std::string_view target);

/// The port of a Host header, unchanged, digits only; "80" when it names none.
std::string port_of(std::string_view host);

/// The path of a request target, percent-decoded, without its query. Nothing when it does not start with '/', has a
/// broken escape, a control character or a backslash, also in encoded form.
std::optional<std::string> decode_request_path(std::string_view target);

/// Value of `name` in the query of a request target, undecoded; empty when absent.
std::string_view query_value(std::string_view target, std::string_view name);

/// Headers of a request that changes something.
struct PostHeaders {
  std::string_view host, origin, token, content_type;
};
/// Origin absent or "http://<Host>", the run's token, a JSON body: another site's page can send none of these.
bool post_allowed(const PostHeaders& headers, std::string_view token);

/// A browser's headers about the origin of a request: Sec-Fetch-Site, Sec-Fetch-Mode and Sec-Fetch-Dest. All are empty
/// in clients that are no browser.
struct FetchOrigin {
  std::string_view site, mode, destination;
};
/// The request comes from the page itself, from the address line, or from no browser. A link on another site may open
/// the page (a GET of "/" in a window of its own) and nothing else.
bool fetch_allowed(const FetchOrigin& origin, bool get, std::string_view path);

/// Whether Accept-Encoding takes gzip.
bool accepts_gzip(std::string_view accept_encoding);

/// 32 hexadecimal digits from the system's random source.
std::string random_token();

/// Content type by the file's extension.
std::string_view content_type_of(const std::filesystem::path& path);
/// The type is text, which gzip makes several times smaller; pictures and splats are packed already.
bool is_text_type(std::string_view content_type);

}  // namespace aligngs
