// The program penumbra with all its commands.
#include <fmt/format.h>

#include <exception>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

#include "kernels/host/text.h"
#include "scenes/diagnostic.h"
#include "scheduler/cli/build_info.h"
#include "scheduler/cli/commands.h"
#include "scheduler/run/option_hints.h"
#include "worker/cli/command_line.h"
#include "worker/protocol/grpc_log.h"
#include "worker/protocol/message_memory.h"

namespace penumbra {
namespace {

constexpr const char* kExamples =
    "Exit code: 0 all done, 1 something is incomplete or failed, 2 bad usage or bad input.\n\n"
    "Examples:\n"
    "  penumbra render scenes/cornell/cornell.xml          cornell.exr, .png and .json in this folder\n"
    "  penumbra render scene.xml -o out/a.exr --spp 256 --workers 4\n"
    "  penumbra view scene.xml\n"
    "  penumbra info scene.xml\n"
    "  penumbra compare out/a.exr reference.exr\n"
    "  penumbra report scene.xml -o report --integrator path_ems --integrator path_mis";

/// Commands by group, in the order of the help.
const std::pair<const char*, std::vector<const char*>> kGroups[] = {
    {"Render", {"render", "view", "preview", "worker"}},
    {"Scenes", {"info", "convert", "plugins", "settings"}},
    {"Images", {"denoise", "merge"}},
    {"Measure", {"advise", "compare", "report", "stress"}},
    {"Service", {"serve", "submit", "status", "prioritize", "cancel", "retry", "fetch", "keys", "sbatch"}},
    {"Installation", {"completion", "man"}}};

void group_commands(CommandLine& app) {
  for (const auto& [group, commands] : kGroups)
    for (const char* command : commands) app.find_command(command)->group(group);
}

/// `help`, `help COMMAND` and `version` as the flags that they stand for.
std::vector<std::string> with_flags(std::vector<std::string> line) {
  if (line.size() == 2 && line[1] == "version") line[1] = "--version";
  if (line.size() == 2 && line[1] == "help") line[1] = "--help";
  if (line.size() > 2 && line[1] == "help") {
    line.erase(line.begin() + 1);
    line.insert(line.begin() + 2, "--help");
  }
  return line;
}

ExitCode run(int argc, char** argv) {
  const std::vector<std::string> command_line = with_flags({argv, argv + argc});
  if (const std::string program = command_line.size() > 1 ? sibling_program(command_line[1]) : "";
      !program.empty()) {
    return run_sibling(program, {command_line.begin() + 2, command_line.end()});
  }
  CommandLine app("Penumbra: a distributed tile-parallel batch renderer", "penumbra");
  app.add_version(build_info);
  app.require_command();
  app.explain(command_hint);
  Command chosen;
  add_render_command(app, command_line, chosen);
  add_preview_command(app, chosen);
  add_info_command(app, chosen);
  add_advise_command(app, chosen);
  add_convert_command(app, chosen);
  add_plugins_command(app, chosen);
  add_settings_command(app, chosen);
  add_denoise_command(app, chosen);
  add_merge_command(app, command_line, chosen);
  add_compare_command(app, chosen);
  add_report_command(app, command_line, chosen);
  add_sibling_commands(app);
  add_serve_command(app, chosen);
  add_submit_command(app, command_line, chosen);
  add_status_command(app, chosen);
  add_change_commands(app, chosen);
  add_fetch_command(app, chosen);
  add_keys_command(app, chosen);
  add_sbatch_command(app, chosen);
  add_reference_commands(app, chosen);
  app.footer(kExamples);
  group_commands(app);
  if (const auto answered = answer_reference(app, {command_line.begin() + 1, command_line.end()}))
    return *answered;
  if (argc > 2 && std::string_view(argv[1]) == "help" && app.find_command(argv[2]) == nullptr) {
    std::vector<std::string> names;
    for (const CommandLine* command : app.commands()) names.push_back(command->name());
    return app.refuse(fmt::format("there is no command '{}'{}", argv[2], suggestion(argv[2], names)));
  }
  std::vector<const char*> words;
  for (const std::string& word : command_line) words.push_back(word.c_str());
  if (const auto ended = app.parse(int(words.size()), words.data())) return *ended;
  return chosen();
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  penumbra::begin_program("penumbra");
  penumbra::keep_message_memory();
  penumbra::route_grpc_log();
  try {
    return penumbra::end_program(penumbra::run(argc, argv));
  } catch (const std::bad_alloc&) {
    penumbra::print_error({"out of memory"});
  } catch (const std::exception& error) {
    penumbra::print_error({fmt::format("internal error: {}", error.what())});
  }
  return penumbra::kIncomplete;
}
