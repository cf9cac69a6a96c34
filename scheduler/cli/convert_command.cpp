// `penumbra convert`: a scene of any format as a file of Mitsuba 3.
#include <fmt/format.h>

#include <memory>

#include "scenes/mitsuba/scene_writer.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/loaded_scene.h"

namespace penumbra {
namespace {

struct ConvertOptions {
  SceneOptions scene;
  std::string output;
};

ExitCode convert(const ConvertOptions& options) {
  const auto scene = read_scene_with_options(options.scene);
  if (!scene) return print_error(scene.error()), kIncomplete;
  for (const std::string& warning : scene->warnings) print_warning(warning);
  if (const auto done = mitsuba::write_scene(*scene, options.output); !done)
    return print_error(done.error()), kIncomplete;
  return kAllDone;
}

}  // namespace

void add_convert_command(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "convert", "Write a scene as a file of Mitsuba 3, its meshes as PLY files beside it");
  const auto options = std::make_shared<ConvertOptions>();
  add_scene_options(*command, options->scene);
  command->add_option("output", options->output, "The file to write: OUT.xml")->required();
  command->footer("Examples:\n  penumbra convert scene.toml scene.xml");
  command->callback([options, &chosen] { chosen = [options] { return convert(*options); }; });
}

}  // namespace penumbra
