// `penumbra settings`: lists all settings of --set. `penumbra plugins`: lists all plugins of scene files.
#include <memory>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/reference_text.h"
#include "worker/cli/help_text.h"
#include "worker/cli/text_layout.h"

namespace penumbra {
namespace {

ExitCode print_reference(const std::string& name, std::string (*overview)(int),
                         Expected<std::string> (*text)(const std::string&, int)) {
  if (name.empty()) return print_answer(overview(text_columns())), kAllDone;
  const auto found = text(name, text_columns());
  if (!found) return print_error(found.error()), kBadInput;
  return print_answer(*found), kAllDone;
}

}  // namespace

void add_settings_command(CommandLine& app, Command& chosen) {
  CommandLine* command = app.add_command("settings", "List what --set takes: values, defaults, meaning");
  const auto name = std::make_shared<std::string>();
  command
      ->add_option("NAME", *name,
                   "A setting such as max_depth, or a group: integrator, sampler, film, camera (default: a "
                   "list)")
      ->group(group::kInput);
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print all settings as JSON")->excludes("NAME")->group(group::kOutput);
  command->footer(
      "Examples:\n"
      "  penumbra settings\n"
      "  penumbra settings camera\n"
      "  penumbra settings integrator.max_depth");
  command->callback([name, json, &chosen] {
    chosen = [name, json] {
      if (*json) return print_answer(settings_description()), kAllDone;
      return print_reference(*name, settings_overview, settings_text);
    };
  });
}

void add_plugins_command(CommandLine& app, Command& chosen) {
  CommandLine* command =
      app.add_command("plugins", "List what Mitsuba's scene files may hold: plugins and their parameters");
  const auto name = std::make_shared<std::string>();
  command
      ->add_option(
          "NAME", *name,
          "A plugin such as roughconductor, or a kind such as bsdf, shape or sensor (default: a list)")
      ->group(group::kInput);
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print all plugins as JSON")->excludes("NAME")->group(group::kOutput);
  command->footer(
      "Examples:\n"
      "  penumbra plugins\n"
      "  penumbra plugins sensor\n"
      "  penumbra plugins roughconductor");
  command->callback([name, json, &chosen] {
    chosen = [name, json] {
      if (*json) return print_answer(plugins_description()), kAllDone;
      return print_reference(*name, plugins_overview, plugins_text);
    };
  });
}

}  // namespace penumbra
