// `penumbra advise SCENE`: compares techniques by pilot renders.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "scheduler/advise/advice_text.h"
#include "scheduler/cli/commands.h"
#include "scheduler/run/loaded_scene.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

struct AdviseOptions {
  RenderRequest render;
  bool json = false;
};

ExitCode advise(const AdviseOptions& options) {
  SceneOptions scene = options.render.scene;
  if (scene.integrator != kAutoIntegrator && scene.integrator)
    scene.settings.push_back("integrator.type=" + *scene.integrator);
  scene.integrator.reset();
  auto read = read_scene_to_render(scene);
  if (!read) return print_error(read.error()), kBadInput;
  const auto advice = advise(*read, scene);
  if (!advice) return print_error({fmt::format("{}: {}", scene.file, advice.error().message)}), kBadInput;
  if (options.json) {
    nlohmann::ordered_json json = {{"scene", scene.file}};
    json.update(advice_json(*advice));
    print_answer(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  } else {
    const std::string choice = choice_options(advice->choice());
    print_answer(fmt::format("{}\n{}\n{}\n", advice_table(*advice), choice_line(*advice),
                             choice.empty() ? "No options are better than the scene's."
                                            : "Options for penumbra render: " + choice));
  }
  return kAllDone;
}

}  // namespace

void add_advise_command(CommandLine& app, Command& chosen) {
  CommandLine* command = app.add_command("advise", "Compare techniques for a scene by pilot renders");
  const auto options = std::make_shared<AdviseOptions>();
  add_scene_options(*command, options->render);
  command->default_group(group::kOutput);
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(
      "Work is counted, not timed: the choice is the same on every machine, and `render --integrator auto` "
      "takes it. Errors are relative squared errors after 64 samples per pixel.\n\n"
      "Examples:\n"
      "  penumbra advise scene.xml\n"
      "  penumbra advise scene.xml --set integrator.max_depth=8 --json");
  command->callback([options, &chosen] { chosen = [options] { return advise(*options); }; });
}

}  // namespace penumbra
