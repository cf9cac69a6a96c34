#include "tests/support/program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

void redirect(const std::filesystem::path& path, int descriptor) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  dup2(file, descriptor);
  close(file);
}

}  // namespace

Program::Program(const std::filesystem::path& folder, const std::vector<std::string>& arguments)
    : Program(folder, PENUMBRA_BINARY_DIR "/penumbra", arguments) {}

Program::Program(const std::filesystem::path& folder, const std::string& program,
                 const std::vector<std::string>& arguments)
    : out_(folder / ".stdout"), err_(folder / ".stderr") {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("fork failed");
  if (pid_ > 0) setpgid(pid_, pid_);  // here too, so that it is done whichever process runs first
  if (pid_ == 0) {
    setpgid(0, 0);
    if (chdir(folder.c_str()) != 0) _exit(126);
    redirect("/dev/null", STDIN_FILENO);
    redirect(out_, STDOUT_FILENO);
    redirect(err_, STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
}

Program::~Program() {
  if (ended_) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void Program::send(int signal) const { kill(pid_, signal); }

void Program::send_to_group(int signal) const { kill(-pid_, signal); }

ProgramResult Program::wait() {
  int status = 0;
  if (waitpid(pid_, &status, 0) != pid_) throw std::runtime_error("waitpid failed");
  ended_ = true;
  ProgramResult result;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  result.out = file_contents(out_);
  result.err = file_contents(err_);
  std::filesystem::remove(out_);
  std::filesystem::remove(err_);
  return result;
}

ProgramResult run_penumbra(const std::filesystem::path& folder, const std::vector<std::string>& arguments) {
  return Program(folder, arguments).wait();
}

ProgramResult run_shell(const std::filesystem::path& folder, const std::string& line) {
  return Program(folder, "/bin/bash", {"-c", "PATH=" PENUMBRA_BINARY_DIR ":$PATH\n" + line}).wait();
}

bool has_window() { return std::filesystem::exists(PENUMBRA_BINARY_DIR "/penumbra-view"); }

std::string source_path(const std::string& relative) {
  return std::string(PENUMBRA_SOURCE_DIR "/") + relative;
}

}  // namespace penumbra
