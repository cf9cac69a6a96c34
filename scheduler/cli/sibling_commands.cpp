// `penumbra view …`, `penumbra worker …`, `penumbra stress …` start separate programs, so that `penumbra`
// itself needs no libraries for windows and devices.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "kernels/host/process.h"
#include "scheduler/cli/commands.h"
#include "scheduler/files/program_path.h"

namespace penumbra {
namespace {

struct Sibling {
  const char *command, *program, *help, *hint;  ///< hint: shown if the program is missing
};
constexpr Sibling kSiblings[] = {
    {"view", "penumbra-view", "Open a window on a scene, or on a render that is under way",
     "builds without GLFW, libepoxy and Dear ImGui leave it out: `.ci/install_packages.sh window` and a new "
     "build bring it"},
    {"worker", "penumbra-worker", "Render for a scheduler that runs elsewhere",
     "`cmake --build --preset release --target penumbra-worker` builds it"},
    {"stress", "penumbra-stress", "Check stiff and extreme cases against high-precision references",
     "`cmake --build --preset release --target penumbra-stress` builds it"},
};

}  // namespace

void add_sibling_commands(CommandLine& app) {
  for (const Sibling& sibling : kSiblings) app.add_command(sibling.command, sibling.help)->prefix_command();
}

std::string sibling_program(const std::string& command) {
  for (const Sibling& sibling : kSiblings) {
    if (command == sibling.command) return sibling.program;
  }
  return {};
}

ExitCode run_sibling(const std::string& name, const std::vector<std::string>& arguments) {
  const auto program = find_program(name);
  if (!program) {
    const auto* const sibling = std::ranges::find(kSiblings, name, &Sibling::program);
    print_error({program.error().message + "; " + sibling->hint});
    return kIncomplete;
  }
  std::string path = program->string();
  std::vector<char*> words{path.data()};
  std::vector<std::string> copies = arguments;
  for (std::string& word : copies) words.push_back(word.data());
  words.push_back(nullptr);
  restore_default_signals();
  execv(path.c_str(), words.data());
  print_error({fmt::format("cannot start {}: {}", path, std::strerror(errno))});
  return kIncomplete;
}

}  // namespace penumbra
