// The requests that are refused before their body is read.
#pragma once

#include <optional>
#include <string>

#include "serve/http_answer.h"
#include "serve/view_server.h"

namespace aligngs {

/// GET or HEAD.
bool is_get(const Request& request);

/// Requests of other sites, repeated headers that decide this, methods that are not served, POST without the token of this server or to no handler.
/// Nothing when the request is welcome.
std::optional<HttpAnswer> refusal_of(const Request& request, const ViewServerOptions& options,
                                     const std::string& token);

}  // namespace aligngs
