// `aligngs view RUN|FILE`: the page that shows a run, while it trains and afterwards.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command.h"
#include "core/stop_signal.h"
#include "serve/view_server.h"

namespace aligngs {
namespace {

/// The line to type on the computer in front of the user when this one is reached over ssh; empty otherwise.
std::string ssh_line(uint16_t port) {
  const char* connection = std::getenv("SSH_CONNECTION");  // client address, client port, server address, server port
  if (connection == nullptr) return {};
  std::istringstream words(connection);
  std::string client, client_port, server, server_port;
  words >> client >> client_port >> server >> server_port;
  if (server.empty()) return {};
  const char* user = std::getenv("USER");
  return fmt::format("ssh{} -N -L {}:localhost:{} {}{}", server_port == "22" || server_port.empty() ? "" : " -p " + server_port,
                     port, port, user != nullptr ? std::string(user) + "@" : "", server);
}

}  // namespace

void add_view_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("view", "Show a run in the browser, also while it trains");
  command->group("Results");
  command->footer("Example: aligngs view demo_run\n         aligngs view scene.ply --port 9000");
  auto options = std::make_shared<ViewServerOptions>();
  auto run = std::make_shared<std::string>();
  auto web_root = std::make_shared<std::string>();
  command->add_option("run", *run, "run folder or .ply file")->required();
  command->add_option("--port", options->port, "port on 127.0.0.1 (default: the first free one from 7860 on)")->check(CLI::Range(1, 65535));
  command->add_option("--allow-host", options->allowed_hosts, "accept this name in the Host header, e.g. behind a proxy");
  command->add_option("--web-root", *web_root, "serve the page from this folder instead of the one built in");
  command->callback([&context, options, run, web_root] {
    options->run = *run;
    options->web_root = *web_root;
    ViewServer server(*options);
    const std::string url = fmt::format("http://127.0.0.1:{}/", server.port());
    const std::string ssh = ssh_line(server.port());
    if (context.global.json) {
      std::printf("%s\n", nlohmann::json({{"url", url}, {"port", server.port()}, {"ssh", ssh}}).dump().c_str());
    } else {
      std::printf("%s\n", url.c_str());
      if (!ssh.empty()) std::printf("from your own computer: %s\nthen open %s\n", ssh.c_str(), url.c_str());
      std::printf("Ctrl-C ends\n");
    }
    std::fflush(stdout);
    server.run([] { return stop_requested(); });
  });
}

}  // namespace aligngs
