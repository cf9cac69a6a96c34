// Runs the built `penumbra` as users run it, in a folder of its own.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace penumbra {

struct ProgramResult {
  int exit_code = -1;  ///< -1 if a signal ended it
  int signal = 0;      ///< that signal
  std::string out, err;
};

/// A running program, its output going to hidden files in the folder where it runs.
class Program {
 public:
  /// Starts `penumbra ARGUMENTS…` with `folder` as current folder.
  Program(const std::filesystem::path& folder, const std::vector<std::string>& arguments);
  /// The same with another program, by its path.
  Program(const std::filesystem::path& folder, const std::string& program,
          const std::vector<std::string>& arguments);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  /// Kills it if it still runs.
  ~Program();

  [[nodiscard]] pid_t pid() const { return pid_; }
  void send(int signal) const;
  /// To the program and everything that it started, as a terminal's Ctrl-C does.
  void send_to_group(int signal) const;
  /// Waits until it ends.
  ProgramResult wait();

 private:
  pid_t pid_ = -1;
  bool ended_ = false;
  std::filesystem::path out_, err_;
};

/// Starts it and waits.
ProgramResult run_penumbra(const std::filesystem::path& folder, const std::vector<std::string>& arguments);

/// What a shell makes of the line in that folder, where `penumbra` and the programs beside it are in its
/// PATH.
ProgramResult run_shell(const std::filesystem::path& folder, const std::string& line);

/// Whether `penumbra view` was built.
bool has_window();

/// Path of a file of the source tree.
std::string source_path(const std::string& relative);

}  // namespace penumbra
