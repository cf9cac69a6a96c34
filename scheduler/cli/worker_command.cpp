// `penumbra worker …`: starts penumbra-worker.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/program_path.h"

namespace penumbra {

void add_worker_command(CLI::App& app) {
  app.add_subcommand("worker", "Start penumbra-worker; `penumbra worker --help` shows its options")
      ->prefix_command();
}

ExitCode run_worker(const std::vector<std::string>& arguments) {
  const auto program = find_program("penumbra-worker");
  if (!program) return print_error(program.error()), kIncomplete;
  std::string path = program->string();
  std::vector<char*> words{path.data()};
  std::vector<std::string> copies = arguments;
  for (std::string& word : copies) words.push_back(word.data());
  words.push_back(nullptr);
  execv(path.c_str(), words.data());
  print_error({fmt::format("cannot start {}: {}", path, std::strerror(errno))});
  return kIncomplete;
}

}  // namespace penumbra
