#include "serve/start_picture.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "core/free_memory.h"
#include "engine/engine.h"
#include "gaussians/gaussian_ply.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "scene/camera_path.h"

namespace aligngs {
namespace {

constexpr int kWidth = 1056, kHeight = 704;               // pixels: about those of a window, drawn in a second
constexpr double kFieldOfView = 80;                       // degrees, as web/src/page.ts has it for a tall page
constexpr int kQuality = 82;                              // of JPEG: about 100 kB, a fifth of a second at 4 Mbit/s
constexpr uint64_t kLargestSplats = uint64_t(512) << 20;  // bytes of a file: more takes longer than the page itself

std::string text_of(const std::vector<uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A picture that shows nothing: an absent one would be an error in the browser.
GetAnswer no_picture() {
  const Image<uint8_t> pixel(1, 1, 4);
  return {"image/png", text_of(encode_png(pixel)), {}, {}};
}

}  // namespace

StartPicture::StartPicture(const std::filesystem::path& run, bool expect_run, const std::filesystem::path& scene,
                           int threads)
    : run_(run, expect_run, scene), threads_(threads) {
  work_ = std::jthread([this] {
    if (const auto now = subject()) draw(*now);
    drawing_ = false;
  });
}

StartPicture::~StartPicture() = default;

std::optional<StartPicture::Subject> StartPicture::subject() const {
  const nlohmann::json state = parse_json(run_.state());
  if (!state["splats"].is_string() || state["active"].get<bool>() || state["edited"].get<bool>()) return {};
  const auto pose = start_pose(state["cameras"], state["up"]);
  if (!pose) return {};
  return Subject{state["splats"].get<std::string>(), state["version"].get<std::string>(), *pose};
}

void StartPicture::draw(const Subject& subject) {
  {
    const std::lock_guard lock(mutex_);
    version_ = subject.version;
    jpeg_.reset();
  }
  try {
    const auto file = run_.file(subject.splats);
    if (!file || file->size() > kLargestSplats) return;
    std::vector<uint8_t> bytes;
    {
      const std::unique_ptr<Engine> engine = make_cpu_engine(threads_);
      engine->load(read_gaussian_ply(file->path()));
      RenderOptions options;
      options.geometry = false;
      const StartPose& pose = subject.pose;
      const Camera camera = camera_of({0, pose.eye, pose.target, kFieldOfView}, pose.up, kWidth, kHeight);
      bytes = encode_jpeg(to_bytes(engine->render(camera, options).color), kQuality);
    }
    give_back_free_memory();
    const std::lock_guard lock(mutex_);
    jpeg_ = std::make_shared<const std::string>(text_of(bytes));
  } catch (const std::exception&) {
    // The page asks for the same splats and tells the reason.
  }
}

GetAnswer StartPicture::picture() {
  const auto now = subject();
  if (!now) return no_picture();
  {
    const std::lock_guard lock(mutex_);
    if (version_ == now->version) {
      if (!jpeg_) return no_picture();
      return {"image/jpeg", {}, jpeg_, "\"start-" + now->version + "\""};
    }
  }
  if (!drawing_.exchange(true)) {
    work_ = std::jthread([this, subject = *now] {
      draw(subject);
      drawing_ = false;
    });
  }
  return no_picture();
}

void StartPicture::serve(ViewServerOptions& options) {
  options.get["/api/start.jpg"] = [this](const std::string&) -> std::optional<GetAnswer> { return picture(); };
}

}  // namespace aligngs
