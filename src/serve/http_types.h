// Boost.Beast and Asio as the server uses them. Included by sources alone, as it is large.
#pragma once

// Asio 1.74 does not find clang's coroutines by itself, and uses std::exchange without including <utility>.
#if defined(__clang__)
#define BOOST_ASIO_HAS_CO_AWAIT 1
#define BOOST_ASIO_HAS_STD_COROUTINE 1
#endif
#include <utility>

#include <boost/asio.hpp>
#include <boost/beast.hpp>

#include <string>
#include <string_view>

namespace aligngs {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

using Request = http::request<http::string_body>;

inline std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }
inline beast::string_view beast_view(std::string_view text) { return {text.data(), text.size()}; }

}  // namespace aligngs
