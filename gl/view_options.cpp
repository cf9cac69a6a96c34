#include "gl/view_options.h"

#include <fmt/format.h>

#include <limits>
#include <string_view>

#include "scheduler/render/option_checks.h"
#include "worker/cli/access_options.h"
#include "worker/keys/tcp_address.h"

namespace penumbra {
namespace {

constexpr const char* kOwn = "Window";  // the group of options that are not for the scheduler
constexpr int kSmallestWindow = 64, kLargestWindow = 16384;

/// What is wrong with an address to connect to; empty if it is valid.
std::string check_address(const std::string& address) {
  constexpr std::string_view kUnix = "unix:";
  if (address.starts_with(kUnix) && address.size() > kUnix.size()) return {};
  const std::size_t colon = address.rfind(':');
  if (!address.starts_with(kUnix) && colon != std::string::npos && colon > 0) {
    const std::string_view port = std::string_view(address).substr(colon + 1);
    if (is_port(port) && port != "0") return {};
  }
  return fmt::format("'{}' is not an address: give unix:/path or host:port", address);
}

std::string check_screenshot(const std::string& path) {
  if (std::string_view(path).ends_with(".png")) return {};
  return fmt::format("a screenshot is written as FILE.png, not as '{}'", path);
}

}  // namespace

void add_view_options(CommandLine& app, ViewOptions& options) {
  add_preview_options(app, options.preview);
  Option* scene = app.option("SCENE");
  scene->required(false)->description(
      "Scene file: a scheduler and workers are started for it. Or an image: EXR, PNG, …; or the frames of a "
      "shot: 'out/shot.####.exr', which --frame and --fps apply to");
  // The window's own scheduler listens on a private socket; for others, and over TCP, use `penumbra preview`.
  app.remove_option(app.option("--listen"));
  app.add_option("--connect", options.connect,
                 "Watch a render that is under way, at the address that it printed: unix:/path, or HOST:PORT "
                 "with --keys, or with the token that it printed in PENUMBRA_TOKEN")
      ->type_name("ADDRESS")
      ->check({check_address})
      ->group(kOwn)
      ->excludes(scene);
  app.add_option("--job", options.job, "Job of a service (default: the oldest that is under way)")
      ->type_name("N")
      ->check(whole_number(1, std::numeric_limits<JobId>::max()))
      ->group(kOwn)
      ->needs("--connect");
  app.option("--keys")->group(kOwn)->description(
      "For a scheduler at HOST:PORT with TLS: the folder that `penumbra keys` made, or its part for windows");
  add_token_refusal(app);
  app.add_option("--reference", options.reference, "Image to compare with")
      ->type_name("FILE")
      ->check(existing_file())
      ->group(kOwn);
  app.add_option("--script", options.script, "Run the commands of this file, one a line, and end")
      ->type_name("FILE")
      ->check(existing_file())
      ->group(kOwn);
  app.add_option(
         "--screenshot", options.screenshot,
         "Write what the window shows at the end of the script, or without one once all samples are there")
      ->type_name("FILE.png")
      ->check({check_screenshot})
      ->group(kOwn);
  for (const auto& [name, size, help] :
       {std::tuple{"--width", &options.width, "Width of the window in pixels"},
        std::tuple{"--height", &options.height, "Height of the window in pixels"}})
    app.add_option(name, *size, help)
        ->check(whole_number(kSmallestWindow, kLargestWindow))
        ->type_name("N")
        ->capture_default_str()
        ->group(kOwn);
  app.add_flag("--hidden", options.hidden,
               "Show no window; needs a display all the same, such as that of xvfb-run")
      ->group(kOwn);
  app.add_flag("--gl-debug", options.gl_debug, "Let OpenGL check every call; exit code 1 if it complains")
      ->group(kOwn);
}

std::vector<std::string> preview_arguments(const CommandLine& app) {
  std::vector<std::string> arguments;
  for (const Option* option : app.options()) {
    if (!option->is_given() || option->group() == kOwn) continue;
    const bool is_flag = !option->takes_value();
    for (const std::string& value : option->results()) {
      if (!option->is_positional()) arguments.push_back(option->name());
      if (!is_flag) arguments.push_back(value);
    }
  }
  return arguments;
}

}  // namespace penumbra
