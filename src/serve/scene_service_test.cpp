// The compact form as the page asks for it, over a real socket.
#include "serve/scene_service.h"

#include "io/gzip.h"
#include "io/ply.h"
#include "serve/testing/view_server.h"

namespace aligngs {
namespace {

using test_http::ask;
using test_http::body;
using test_http::header;
using test_http::status;

PlyFile splats(size_t count) {
  PlyElement vertices{"vertex", count, {}};
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3"}) {
    vertices.properties.push_back({name, PlyType::kFloat32, false, std::vector<double>(count, 0.5), {}});
  }
  return {{}, {vertices}};
}

class SceneParts : public testing_support::ViewServerTest {
 protected:
  void configure(ViewServerOptions& options) override {
    write_ply(base_ / "run" / "scene.ply", splats(10));
    service_ = std::make_unique<SceneService>(options.run, false);
    service_->serve(options);
  }
  void TearDown() override {
    ViewServerTest::TearDown();
    service_.reset();
  }
  std::unique_ptr<SceneService> service_;
};

TEST_F(SceneParts, ComeOfEveryFileOfSplats) {
  for (const char* part : {"coarse", "rest"}) {
    const std::string answer = get(std::string("/api/scene/") + part + "/scene.ply?v=1");
    EXPECT_EQ(status(answer), 200) << part;
    EXPECT_NE(gzip_expanded(body(answer), part, 1 << 20).find("\"total\":10"), std::string::npos) << part;
  }
  EXPECT_EQ(status(get("/api/scene/coarse/absent.ply")), 404);
  EXPECT_EQ(status(get("/api/scene/coarse/run.json")), 404);
  EXPECT_EQ(status(get("/api/scene/fine/scene.ply")), 404);
  EXPECT_EQ(status(get("/api/scene/coarse/../secret.ply")), 404);
}

TEST_F(SceneParts, AreResumedAndKept) {
  const std::string whole = get("/api/scene/coarse/scene.ply"), tag = header(whole, "ETag");
  const std::string rest =
      ask(server_->port(), "GET", "/api/scene/coarse/scene.ply", "Range: bytes=10-\r\nIf-Range: " + tag + "\r\n");
  EXPECT_EQ(status(rest), 206);
  EXPECT_EQ(body(whole).substr(10), body(rest));
  EXPECT_EQ(status(ask(server_->port(), "GET", "/api/scene/coarse/scene.ply", "If-None-Match: " + tag + "\r\n")), 304);
}

TEST_F(SceneParts, FollowANewVersionOfTheFile) {
  const std::string before = header(get("/api/scene/coarse/scene.ply"), "ETag");
  write_ply(base_ / "run" / "scene.ply", splats(20));
  const std::string after = get("/api/scene/coarse/scene.ply");
  EXPECT_NE(header(after, "ETag"), before);
  EXPECT_NE(gzip_expanded(body(after), "part", 1 << 20).find("\"total\":20"), std::string::npos);
}

TEST_F(SceneParts, AFileWithoutSplatsIsToldInWords) {
  write("run/mesh.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n");
  const std::string answer = get("/api/scene/coarse/mesh.ply");
  EXPECT_EQ(status(answer), 400);
  EXPECT_NE(body(answer).find("the PLY file has no splats"), std::string::npos);
}

}  // namespace
}  // namespace aligngs
