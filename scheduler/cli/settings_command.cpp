// `penumbra settings`: all that --set takes.
#include "scenes/settings.h"
#include "scheduler/cli/commands.h"

namespace penumbra {

void add_settings_command(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "settings", "A table of all that --set and scene files may set: values, defaults, meaning");
  command->footer("Examples:\n  penumbra settings");
  command->callback([&chosen] {
    chosen = [] {
      print_answer(settings_table());
      return kAllDone;
    };
  });
}

}  // namespace penumbra
