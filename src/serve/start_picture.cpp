#include "serve/start_picture.h"

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/free_memory.h"
#include "engine/engine.h"
#include "gaussians/gaussian_ply.h"
#include "io/image_file.h"
#include "scene/camera_path.h"
#include "serve/seen_gaussians.h"

namespace aligngs {

using namespace std::chrono_literals;

namespace {

constexpr int kWidth = 1056, kHeight = 704;               // pixels: about those of a window, drawn in a second
constexpr double kFieldOfView = 80;                       // degrees, as web/src/page.ts has it for a tall page
constexpr int kQuality = 82;                              // of JPEG: about 100 kB, a fifth of a second at 4 Mbit/s
constexpr uint64_t kLargestSplats = uint64_t(512) << 20;  // bytes of a file: more takes longer than the page itself
constexpr size_t kMostEdited = 2'000'000;                 // splats of an edited room: about the same bytes
constexpr auto kQuiet = 2s;  // after an edit: somebody who edits on does not wait for this picture

std::string text_of(const std::vector<uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Camera start_camera(const StartPose& pose) {
  return camera_of({0, pose.eye, pose.target, kFieldOfView}, pose.up, kWidth, kHeight);
}

/// A picture that shows nothing: an absent one would be an error in the browser.
GetAnswer no_picture() {
  const Image<uint8_t> pixel(1, 1, 4);
  return {"image/png", text_of(encode_png(pixel)), {}, {}};
}

}  // namespace

StartPicture::StartPicture(const std::filesystem::path& run, bool expect_run, const std::filesystem::path& scene,
                           int threads, std::mutex* drawing)
    : run_(run, expect_run, scene), threads_(threads), drawing_(drawing != nullptr ? *drawing : own_drawing_) {
  if (auto now = subject(); now && now->room == Room::kTrained) ask_for({std::move(*now), {}});
  work_ = std::jthread([this](const std::stop_token& stop) { draw_what_is_asked(stop); });
}

StartPicture::~StartPicture() = default;

std::optional<StartPicture::Subject> StartPicture::subject() const {
  const nlohmann::json state = run_.description();
  if (!state["splats"].is_string()) return {};
  const auto pose = start_pose(state["cameras"], state["up"]);
  if (!pose) return {};
  Subject now{Room::kTrained, state["splats"].get<std::string>(), state["version"].get<std::string>(), *pose};
  if (state["edited"].get<bool>()) {
    now.room = Room::kEdited;
    now.version += "-" + state["edits"].get<std::string>();
  } else if (state["active"].get<bool>()) {
    now.room = Room::kInTraining;
  }
  return now;
}

void StartPicture::ask_for(Work work) {
  if (next_) picture_of(next_->subject.room).version.clear();  // it will not be drawn, and may be asked for again
  picture_of(work.subject.room).version = work.subject.version;
  next_ = std::move(work);
  asked_.notify_all();
}

void StartPicture::edited(const GaussianModel& model) {
  auto now = subject();
  if (!now || now->room != Room::kEdited || model.size() > kMostEdited) return;
  {
    const std::lock_guard lock(mutex_);
    if (picture_of(Room::kEdited).version == now->version) return;
  }
  GaussianModel seen = seen_gaussians(model, start_camera(now->pose));
  const std::lock_guard lock(mutex_);
  ask_for({std::move(*now), std::move(seen)});
}

void StartPicture::draw_what_is_asked(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto asked = [this] { return next_.has_value(); };
  while (asked_.wait(lock, stop, asked)) {
    if (next_->model) {
      const std::string version = next_->subject.version;
      const auto is_other = [&] { return next_->subject.version != version; };
      if (asked_.wait_for(lock, stop, kQuiet, is_other)) continue;
      if (stop.stop_requested()) return;
    }
    Work work = std::move(*next_);
    next_.reset();
    lock.unlock();
    const Subject subject = work.subject;
    const bool undone = was_undone(subject);
    auto jpeg = undone ? nullptr : drawn(std::move(work));
    work.model.reset();
    give_back_free_memory();
    lock.lock();
    Picture& picture = picture_of(subject.room);
    if (!undone)
      picture.jpeg = std::move(jpeg), picture.drawn = subject.version;
    else if (picture.version == subject.version)
      picture.version.clear();  // the edit may be done again
  }
}

bool StartPicture::was_undone(const Subject& subject) const {
  if (subject.room != Room::kEdited) return false;
  const auto now = this->subject();
  return !now || now->room != Room::kEdited || now->version != subject.version;
}

std::shared_ptr<const std::string> StartPicture::drawn(Work work) {
  try {
    const Camera camera = start_camera(work.subject.pose);
    const std::lock_guard turn(drawing_);
    if (!work.model) {
      const auto file = run_.file(work.subject.splats);
      if (!file || file->size() > kLargestSplats) return nullptr;
      work.model = seen_gaussians(read_gaussian_ply(file->path()), camera);
    }
    const std::unique_ptr<Engine> engine = make_cpu_engine(threads_);
    engine->load(*work.model);
    work.model.reset();
    RenderOptions options;
    options.geometry = false;
    return std::make_shared<const std::string>(
        text_of(encode_jpeg(to_bytes(engine->render(camera, options).color), kQuality)));
  } catch (const std::exception&) {
    return nullptr;  // the page asks for the same splats and tells the reason
  }
}

GetAnswer StartPicture::picture() {
  auto now = subject();
  if (!now) return no_picture();
  const std::lock_guard lock(mutex_);
  const Picture& known = picture_of(now->room);
  const bool is_old = known.version != now->version;
  // During a training every snapshot is another version, and an old one is better than none.
  const bool shows = known.jpeg && (known.drawn == now->version || now->room == Room::kInTraining);
  GetAnswer answer = shows ? GetAnswer{"image/jpeg", {}, known.jpeg, "\"start-" + known.drawn + "\""} : no_picture();
  if (is_old && now->room != Room::kEdited) ask_for({std::move(*now), {}});
  return answer;
}

void StartPicture::serve(ViewServerOptions& options) {
  options.get["/api/start.jpg"] = [this](const std::string&) -> std::optional<GetAnswer> { return picture(); };
}

}  // namespace aligngs
