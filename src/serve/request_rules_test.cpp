#include "serve/request_rules.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(HostRule, AcceptsThisMachineWithAnyPort) {
  for (const char* host : {"localhost", "localhost:9000", "127.0.0.1:7860", "[::1]:7860", "[::1]"}) {
    EXPECT_TRUE(host_allowed(host, {})) << host;
  }
}

TEST(HostRule, RefusesNamesThatAnAttackerCanPointHere) {
  for (const char* host :
       {"", "evil.example", "localhost.evil.example", "127.0.0.1.evil.example:80", "[::1", "[::1]x:80", ":80"}) {
    EXPECT_FALSE(host_allowed(host, {})) << host;
  }
  EXPECT_TRUE(host_allowed("lab-7:7860", {"lab-7"}));
}

TEST(HostRule, KnowsNoCaseOfLetters) {
  EXPECT_TRUE(host_allowed("LocalHost:9000", {}));
  EXPECT_TRUE(host_allowed("lab-7:7860", {"Lab-7"})) << "browsers send names in lower case";
}

TEST(AbsoluteTarget, HasAHostAndTheTargetOfAnyOtherRequest) {
  const auto whole = absolute_target("http://localhost:9000/files/a%20b?v=1");
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->host, "localhost:9000");
  EXPECT_EQ(whole->target, "/files/a%20b?v=1");
  EXPECT_EQ(absolute_target("http://localhost")->target, "/");
  EXPECT_EQ(absolute_target("http://localhost?v=1")->target, "/?v=1");
  for (const char* other : {"", "/", "/http://localhost/", "https://localhost/", "http:/localhost/", "http:///a",
                            "http://user@localhost/", "http://user:secret@localhost/"})
    EXPECT_FALSE(absolute_target(other).has_value()) << other;
}

TEST(HostPort, IsDigitsOnly) {
  EXPECT_EQ(port_of("localhost:9000"), "9000");
  EXPECT_EQ(port_of("[::1]:7860"), "7860");
  for (const char* host :
       {"", "localhost", "[::1]", "localhost:", "localhost:12x", "localhost:123456", "localhost:1; Path=/x"}) {
    EXPECT_EQ(port_of(host), "80") << host;
  }
}

TEST(RequestPath, IsDecodedOnceWithoutItsQuery) {
  EXPECT_EQ(decode_request_path("/files/a%20b.ply?x=1"), "/files/a b.ply");
  EXPECT_EQ(decode_request_path("/a%252e"), "/a%2e");
}

TEST(RequestPath, RefusesWhatCutsOrEscapes) {
  for (const char* target :
       {"", "files", "http://x/", "/a%00.txt", "/a%zz", "/a%4", "/a%", "/..%5c..", "/a\\b", "/a%0d%0ab", "/a\x7f"}) {
    EXPECT_FALSE(decode_request_path(target).has_value()) << target;
  }
}

TEST(QueryValue, FindsTheNamedItem) {
  EXPECT_EQ(query_value("/e?a=1&from=25", "from"), "25");
  EXPECT_EQ(query_value("/e?xfrom=1", "from"), "");
  EXPECT_EQ(query_value("/e", "from"), "");
}

TEST(PostRule, NeedsOriginTypeAndToken) {
  const PostHeaders good{"localhost:9000", "http://localhost:9000", "secret", "application/json; charset=utf-8"};
  EXPECT_TRUE(post_allowed(good, "secret"));
  PostHeaders h = good;
  h.origin = "";  // curl and other programs
  EXPECT_TRUE(post_allowed(h, "secret"));
  h.origin = "http://evil.example";
  EXPECT_FALSE(post_allowed(h, "secret"));
  h.origin = "null";  // sandboxed frames and file:// pages
  EXPECT_FALSE(post_allowed(h, "secret"));
  h = good, h.content_type = "text/plain";  // what a form can send without asking
  EXPECT_FALSE(post_allowed(h, "secret"));
  h = good, h.content_type = "application/jsonp";
  EXPECT_FALSE(post_allowed(h, "secret"));
  h = good, h.token = "secreT";
  EXPECT_FALSE(post_allowed(h, "secret"));
  h = good, h.token = "";
  EXPECT_FALSE(post_allowed(h, ""));
}

TEST(FetchRule, RefusesWhatAnotherSiteSends) {
  EXPECT_TRUE(fetch_allowed({}, true, "/api/state")) << "curl sends no such headers";
  EXPECT_TRUE(fetch_allowed({"same-origin", "cors", "empty"}, false, "/api/edits/push"));
  EXPECT_TRUE(fetch_allowed({"none", "navigate", "document"}, true, "/files/report.html"))
      << "typed into the address line";
  for (const char* site : {"cross-site", "same-site", "nonsense"}) {
    EXPECT_FALSE(fetch_allowed({site, "no-cors", "image"}, true, "/files/scene.ply")) << site;
    EXPECT_FALSE(fetch_allowed({site, "cors", "empty"}, false, "/api/edits/push")) << site;
    EXPECT_FALSE(fetch_allowed({site, "navigate", "iframe"}, true, "/")) << site;
  }
}

TEST(FetchRule, ALinkOfAnotherSiteOpensThePageAlone) {
  EXPECT_TRUE(fetch_allowed({"cross-site", "navigate", "document"}, true, "/"));
  EXPECT_FALSE(fetch_allowed({"cross-site", "navigate", "document"}, true, "/files/report.html"));
  EXPECT_FALSE(fetch_allowed({"cross-site", "navigate", "document"}, false, "/"));
}

TEST(AcceptEncoding, NamesGzip) {
  EXPECT_TRUE(accepts_gzip("gzip, deflate, br"));
  EXPECT_TRUE(accepts_gzip("br;q=1.0, gzip;q=0.5"));
  EXPECT_FALSE(accepts_gzip(""));
  EXPECT_FALSE(accepts_gzip("br"));
  EXPECT_FALSE(accepts_gzip("gzip;q=0"));
}

TEST(RandomToken, IsLongAndNew) {
  EXPECT_EQ(random_token().size(), 32u);
  EXPECT_NE(random_token(), random_token());
}

}  // namespace
}  // namespace aligngs
