// `penumbra settings`: all that --set takes. `penumbra plugins`: all that scene files may hold.
#include "scenes/plugin_reference.h"
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

void add_plugins_command(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand("plugins",
                                         "A reference of the BSDFs, textures and emitters that Mitsuba's "
                                         "files may name: parameters, values, defaults");
  command->footer("Examples:\n  penumbra plugins");
  command->callback([&chosen] {
    chosen = [] {
      print_answer(plugin_reference());
      return kAllDone;
    };
  });
}

}  // namespace penumbra
