#include "cli/page_server.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <sstream>

#include "cli/stages/room_stage.h"
#include "core/error.h"
#include "core/log.h"
#include "core/stop_signal.h"
#include "io/file_system_error.h"
#include "serve/page_notes.h"
#include "serve/room_scale_service.h"

namespace aligngs {

PageServer::PageServer(PageServerOptions options) {
  const std::filesystem::path& run = options.server.run;
  options.server.scene = options.scene;
  scenes_ = std::make_unique<SceneService>(run, options.server.expect_run);
  scenes_->serve(options.server);
  start_ = std::make_unique<StartPicture>(run, options.server.expect_run, options.scene, options.threads, &drawing_);
  start_->serve(options.server);
  if (options.server.expect_run || std::filesystem::is_directory(run)) {
    edits_ = std::make_unique<EditService>(EditServiceOptions{
        run, options.scene, options.threads, [this](const std::string& path) { return scenes_->shown(path); },
        &drawing_, [this](const EditableRoom& room) { start_->edited(room.gaussians.model); }});
    if (!options.server.expect_run) edits_->open_ahead();
    edits_->serve(options.server);
    selections_ =
        std::make_unique<SelectionService>(*edits_, [this](const std::string& path) { return scenes_->shown(path); });
    selections_->serve(options.server);
    renders_ = std::make_unique<ViewRenders>(run, LoadRunOptions{options.scene, options.threads}, drawing_);
    renders_->serve(options.server);
    serve_notes(run, options.server);
    serve_scale(
        run, [run](const MeasuredRoom& room) { return with_scale_of_scene(room, run); }, options.server);
    serve_control(run, options.server, [this] { stop_asked_ = true; });
  }
  server_ = std::make_unique<ViewServer>(std::move(options.server));
  thread_ = std::thread([this] {
    try {
      server_->run([this] { return stop_.load(); });
    } catch (const std::exception& error) {  // the work goes on without its page
      log_error("the page's server has ended: {}", error.what());
    }
  });
}

PageServer::~PageServer() {
  stop_ = true;
  thread_.join();
}

std::string PageServer::url() const { return fmt::format("http://127.0.0.1:{}/", server_->port()); }

std::string PageServer::ssh_line() const {
  const char* connection = std::getenv("SSH_CONNECTION");  // client address, client port, server address, server port
  if (connection == nullptr) return {};
  std::istringstream words(connection);
  std::string client, client_port, server, server_port;
  words >> client >> client_port >> server >> server_port;
  if (server.empty()) return {};
  const char* user = std::getenv("USER");
  return fmt::format("ssh{} -N -L {}:localhost:{} {}{}",
                     server_port == "22" || server_port.empty() ? "" : " -p " + server_port, port(), port(),
                     user != nullptr ? std::string(user) + "@" : "", server);
}

void PageServer::announce() const {
  log_info("watch the work at {}", url());
  if (const std::string ssh = ssh_line(); !ssh.empty()) log_info("from your own computer first: {}", ssh);
}

void PageServer::wait() const {
  while (!stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

std::unique_ptr<PageServer> serve_while_working(bool view, uint16_t port, const std::filesystem::path& run,
                                                const std::filesystem::path& scene, int threads) {
  if (!view) return nullptr;
  std::error_code error;
  const bool made = std::filesystem::create_directories(run, error);
  if (error)
    throw_resources(run, "the run folder cannot be created: " + error.message(), remedy_for_write(error.value()));
  PageServerOptions options;
  options.server.run = run;
  options.server.expect_run = true;
  options.server.port = port;
  options.server.port_option = "--view-port";
  options.scene = scene;
  options.threads = threads;
  try {
    auto server = std::make_unique<PageServer>(std::move(options));
    server->announce();
    return server;
  } catch (const Error&) {
    if (made) std::filesystem::remove(run, error);  // nothing was begun
    throw;
  }
}

void work_beside_page(const std::unique_ptr<PageServer>& server, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    if (server && server->stop_was_asked() && error.kind() == ErrorKind::kInterrupted && !stop_requested()) {
      log_info("{}; the page stays at {} until Ctrl-C", error.details().message, server->url());
      server->wait();
    }
    throw;
  }
  if (!server || stop_requested()) return;
  log_info("done; the page stays at {} until Ctrl-C", server->url());
  server->wait();
}

}  // namespace aligngs
