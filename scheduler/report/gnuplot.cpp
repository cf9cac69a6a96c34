#include "scheduler/report/gnuplot.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "scheduler/outputs/atomic_file.h"
#include "scheduler/outputs/run_program.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

Expected<void> write_text(const fs::path& path, const std::string& text) {
  return write_file_atomically(path, bytes_of(text));
}

}  // namespace

Expected<fs::path> find_gnuplot() {
  const char* path = std::getenv("PATH");
  std::stringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder.empty() ? "." : folder) / "gnuplot";
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  return fail("plots need gnuplot (Debian: apt-get install gnuplot-nox); --no-plots does without them");
}

std::string gnuplot_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

Expected<GnuplotOutput> run_gnuplot(const fs::path& gnuplot, const fs::path& folder, const std::string& name,
                                    const std::string& script, int width, int height) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail(fmt::format("cannot create the folder {}: {}", folder.string(), error.message()));
  const auto file = [&](const char* ending) { return folder / (name + ending); };
  const std::string text = fmt::format(
      "# Draws {2}.svg and {2}.png.\n"
      "set terminal svg size {3},{4} noenhanced font 'sans-serif,13' background rgb 'white'\n"
      "set output {0}\n{5}\n"
      "set terminal pngcairo size {3}*2,{4}*2 noenhanced fontscale 1.1 linewidth 2 pointscale 2 font "
      "'sans-serif,20'\n"
      "set output {1}\nreplot\nset output\n",
      gnuplot_quoted(file(".svg").string()), gnuplot_quoted(file(".png").string()), name, width, height,
      script);
  if (auto written = write_text(file(".gp"), text); !written) return std::unexpected(written.error());
  const auto end = run_program(gnuplot.string(), {file(".gp").string()}, true);
  if (!end) return std::unexpected(end.error());
  GnuplotOutput output{contents(file(".svg")), {}};
  const std::string png = contents(file(".png"));
  output.png.assign(png.begin(), png.end());
  if (!end->succeeded || output.svg.empty() || output.png.empty()) {
    return fail(fmt::format("gnuplot could not draw {}: {}", file(".gp").string(), end->output));
  }
  return output;
}

}  // namespace penumbra
