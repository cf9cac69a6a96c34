// `penumbra convert`: converts a scene of any format to a Mitsuba 3 file.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "scenes/mitsuba/scene_writer.h"
#include "scenes/names.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/help_text.h"
#include "scheduler/cli/loaded_scene.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/files/output_check.h"

namespace penumbra {
namespace {

struct ConvertOptions {
  SceneOptions scene;
  std::string output;
};

ExitCode convert(const ConvertOptions& options) {
  if (to_lower_case(std::filesystem::path(options.output).extension().string()) != ".xml")
    return print_error(
               {fmt::format("'{}' does not end in .xml: what is written is Mitsuba 3 XML", options.output)}),
           kBadInput;
  const auto scene = read_scene_with_options(options.scene);
  if (!scene) return print_error(scene.error()), kIncomplete;
  for (const std::string& warning : scene->warnings) print_warning(warning);
  auto files = mitsuba::scene_files(*scene, options.output);
  if (!files) return print_error(files.error()), kIncomplete;
  std::vector<std::filesystem::path> outputs;
  for (const mitsuba::SceneFile& file : *files) outputs.push_back(file.path);
  if (const auto checked = check_outputs(outputs, scene->files); !checked)
    return print_error(checked.error()), kBadInput;
  if (const auto made = make_folders(options.output); !made) return print_error(made.error()), kIncomplete;
  OutputBatch batch;
  for (mitsuba::SceneFile& file : *files) {
    const auto bytes = bytes_of(file.contents);
    batch.add(file.path, {bytes.begin(), bytes.end()});
    file.contents.clear();
    file.contents.shrink_to_fit();
  }
  if (const auto done = batch.finish(); !done) return print_error(done.error()), kIncomplete;
  return kAllDone;
}

}  // namespace

void add_convert_command(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "convert", "Write a scene as a Mitsuba 3 file, with its meshes as PLY files beside it");
  const auto options = std::make_shared<ConvertOptions>();
  add_scene_options(*command, options->scene);
  command->add_option("OUTPUT", options->output, "File to write, ends in .xml")
      ->required()
      ->group(group::kInput);
  command->footer("Examples:\n  penumbra convert scene.toml scene.xml");
  command->callback([options, &chosen] { chosen = [options] { return convert(*options); }; });
}

}  // namespace penumbra
