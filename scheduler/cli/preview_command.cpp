// `penumbra preview SCENE`: a scheduler with workers that renders for an interactive window.
#include <fmt/format.h>

#include <memory>

#include "scheduler/cli/commands.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/run/progress.h"
#include "scheduler/run/render_preparation.h"

namespace penumbra {
namespace {

ExitCode preview(const RenderOptions& options) {
  const std::atomic<bool>& stop = install_stop_signal();
  auto prepared = prepare_watched_render(options);
  if (!prepared) return prepared.error();
  const auto outcome = run_render(prepared->job, prepared->farm, stop, [](const RenderProgress& progress) {
    for (const std::string& notice : progress.notices) print_message(notice);
  });
  if (!outcome) return print_error(outcome.error()), kIncomplete;
  for (const std::string& problem : outcome->problems) print_warning(problem);
  return stop ? kAllDone : kIncomplete;
}

}  // namespace

void add_preview_command(CommandLine& app, Command& chosen) {
  CommandLine* command = app.add_command("preview", "Wait for windows, and render what they ask for");
  const auto options = std::make_shared<RenderOptions>();
  add_preview_options(*command, *options);
  command->footer(
      "`penumbra view SCENE` starts this itself. Start it by hand on the machine that has the scene and the "
      "processors, and connect from another one:\n"
      "  there$ penumbra preview scene.xml --workers 8 --threads 4 --listen 127.0.0.1:7000\n"
      "  here$  ssh -N -L 7000:127.0.0.1:7000 there &\n"
      "  here$  PENUMBRA_TOKEN=... penumbra view --connect 127.0.0.1:7000\n"
      "Nothing is rendered while no window wants samples. Ctrl-C ends it.");
  command->callback([options, &chosen] { chosen = [options] { return preview(*options); }; });
}

}  // namespace penumbra
