#include "scheduler/report/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

#include "kernels/host/plain_file.h"
#include "scheduler/outputs/atomic_file.h"
#include "scheduler/quoting.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxPlotBytes = std::uint64_t{256} << 20;
constexpr std::chrono::seconds kTimeToDraw{300};
constexpr std::chrono::milliseconds kPollInterval{2};

/// Empty if it cannot be read.
std::string contents(const fs::path& path) { return read_plain_file(path, kMaxPlotBytes).value_or(""); }

Expected<void> write_text(const fs::path& path, const std::string& text) {
  return write_file_atomically(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// Runs the program in a folder, with its output in the file `log` there; its exit status. One that does not
/// end is killed.
Expected<int> run_program(const fs::path& program, const fs::path& folder, const std::string& argument,
                          const std::string& log) {
  const pid_t child = fork();
  if (child < 0) return fail(fmt::format("cannot start {}: {}", program.string(), std::strerror(errno)));
  if (child == 0) {
    if (chdir(folder.c_str()) != 0) _exit(126);
    const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    const int in = open("/dev/null", O_RDONLY | O_CLOEXEC);
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    execl(program.c_str(), program.c_str(), argument.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  const auto deadline = std::chrono::steady_clock::now() + kTimeToDraw;
  for (pid_t ended = 0; ended != child;) {
    ended = waitpid(child, &status, WNOHANG);
    if (ended < 0 && errno != EINTR)
      return fail(fmt::format("lost {}: {}", program.string(), std::strerror(errno)));
    if (ended == 0 && std::chrono::steady_clock::now() > deadline) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return fail(fmt::format("{} did not end within {} s", program.string(), kTimeToDraw.count()));
    }
    if (ended == 0) std::this_thread::sleep_for(kPollInterval);
  }
  return status;
}

}  // namespace

Expected<fs::path> find_gnuplot() {
  const char* path = std::getenv("PATH");
  std::stringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder.empty() ? "." : folder) / "gnuplot";
    if (access(program.c_str(), X_OK) == 0) return fs::absolute(program);
  }
  return fail("plots need gnuplot (Debian: apt-get install gnuplot-nox); --no-plots does without them");
}

Expected<GnuplotOutput> run_gnuplot(const fs::path& gnuplot, const fs::path& folder, const std::string& name,
                                    const std::string& script, int width, int height) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail(fmt::format("cannot create the folder {}: {}", folder.string(), error.message()));
  // gnuplot runs in the folder: a name that begins with ./ is to it neither an option, nor a home, nor a
  // pipe.
  const std::string plain_name = file_name_of(name);
  const auto file = [&](const char* ending) { return folder / (plain_name + ending); };
  const auto local = [&](const char* ending) { return "./" + plain_name + ending; };
  const std::string text = fmt::format(
      "set terminal svg size {2},{3} noenhanced font 'sans-serif,13' background rgb 'white'\n"
      "set output {0}\n{4}\n"
      "set terminal pngcairo size {2}*2,{3}*2 noenhanced fontscale 1.1 linewidth 2 pointscale 2 font "
      "'sans-serif,20'\n"
      "set output {1}\nreplot\nset output\n",
      gnuplot_quoted(local(".svg")), gnuplot_quoted(local(".png")), width, height, script);
  if (auto written = write_text(file(".gp"), text); !written) return std::unexpected(written.error());
  const fs::path log = file(".log");
  const auto status = run_program(gnuplot, folder, local(".gp"), local(".log"));
  if (!status) return std::unexpected(status.error());
  const std::string said = contents(log);
  fs::remove(log, error);
  GnuplotOutput output{contents(file(".svg")), {}};
  const std::string png = contents(file(".png"));
  output.png.assign(png.begin(), png.end());
  if (*status != 0 || output.svg.empty() || output.png.empty()) {
    return fail(fmt::format("gnuplot could not draw {}: {}", file(".gp").string(), said));
  }
  return output;
}

}  // namespace penumbra
