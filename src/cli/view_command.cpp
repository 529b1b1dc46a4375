// `aligngs view RUN|FILE`: the page that shows a run, while it trains and afterwards.
#include <CLI/App.hpp>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/page_server.h"
#include "core/free_memory.h"
#include "edit/splat_file.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

/// Error{kBadInput} for a .ply file that holds no splats: the page would have nothing to show.
void require_splats(const std::filesystem::path& run) {
  if (std::filesystem::is_regular_file(run) && run.extension() == ".ply") read_splat_file(run);
}

}  // namespace

void add_view_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("view", "Show a run in the browser, also while it trains, and edit it");
  command->group("Use");
  command->footer(help_footer(
      {.reads = "a run folder, also while it trains, or a .ply file",
       .writes = "edits and exports that you ask for on the page",
       .example = "aligngs view demo_run",
       .advanced = "aligngs view demo_run --port 9000 --allow-host room.example.org",
       .notes = "The server listens on localhost only. Over ssh the command prints the line for a tunnel."}));
  struct Options {
    std::string run, scene, web_root;
    uint16_t port = 0;
    std::vector<std::string> allowed_hosts;
  };
  auto options = std::make_shared<Options>();
  command->add_option("run", options->run, "run folder or .ply file")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  command->add_option("--port", options->port, "port on localhost (default: the first free one from 7860)")
      ->check(CLI::Range(1, 65535));
  command->add_option("--allow-host", options->allowed_hosts,
                      "accept this name in the Host header, e.g. behind a proxy");
  command->add_option("--web-root", options->web_root, "serve the page from this folder instead of the one built in");
  command->callback([&context, options] {
    PageServerOptions page;
    page.server.run = options->run;
    page.server.port = options->port;
    page.server.allowed_hosts = options->allowed_hosts;
    page.server.web_root = options->web_root;
    page.scene = options->scene;
    page.threads = context.global.threads;
    return_large_arrays_at_once();
    require_splats(options->run);
    const PageServer server(std::move(page));
    const std::string ssh = server.ssh_line();
    if (context.global.json) {
      std::printf("%s\n",
                  json_line(nlohmann::json({{"url", server.url()}, {"port", server.port()}, {"ssh", ssh}})).c_str());
    } else {
      std::printf("%s\n", server.url().c_str());
      if (!ssh.empty()) std::printf("from your own computer: %s\nthen open %s\n", ssh.c_str(), server.url().c_str());
      std::printf("Ctrl-C ends\n");
    }
    std::fflush(stdout);
    server.wait();
  });
}

}  // namespace aligngs
