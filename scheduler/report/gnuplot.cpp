#include "scheduler/report/gnuplot.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <sstream>

#include "kernels/host/atomic_file.h"
#include "kernels/host/plain_file.h"
#include "scheduler/files/quoting.h"
#include "scheduler/files/run_program.h"
#include "scheduler/report/plot_svg.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxPlotBytes = std::uint64_t{256} << 20;
constexpr std::chrono::seconds kTimeToDraw{300};

/// Empty if it cannot be read.
std::string contents(const fs::path& path) { return read_plain_file(path, kMaxPlotBytes).value_or(""); }

}  // namespace

Expected<fs::path> find_gnuplot() {
  const char* path = std::getenv("PATH");
  std::stringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder.empty() ? "." : folder) / "gnuplot";
    if (access(program.c_str(), X_OK) == 0) return fs::absolute(program);
  }
  return fail("plots need gnuplot (Debian: apt-get install gnuplot-nox)");
}

Expected<GnuplotOutput> run_gnuplot(const fs::path& gnuplot, const fs::path& folder, const std::string& name,
                                    const GnuplotInput& input) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail(fmt::format("cannot create the folder {}: {}", folder.string(), error.message()));
  // gnuplot runs in the folder. It takes a name that begins with ./ neither for an option nor for a home
  // folder or a pipe.
  const std::string plain_name = file_name_of(name);
  const auto file = [&](const char* ending) { return folder / (plain_name + ending); };
  const auto local = [&](const char* ending) { return "./" + plain_name + ending; };
  const std::string text = fmt::format(
      "set encoding utf8\n"
      "set terminal svg size {2},{3} noenhanced font 'sans-serif,16' background rgb 'white'\n"
      "set output {0}\n{4}\n"
      "set terminal pngcairo size {2}*2,{3}*2 noenhanced linewidth 2 pointscale 2 font "
      "'sans-serif,24'\n"
      "set output {1}\nreplot\nset output\n",
      gnuplot_quoted(local(".svg")), gnuplot_quoted(local(".png")), input.width, input.height, input.script);
  if (auto written = write_file_atomically(file(".gp"), bytes_of(text)); !written)
    return std::unexpected(written.error());
  const auto end = run_program(gnuplot.string(), {local(".gp")},
                               {.folder = folder, .errors_too = true, .limit = kTimeToDraw});
  if (!end) return std::unexpected(end.error());
  GnuplotOutput output{contents(file(".svg")), {}};
  const std::string png = contents(file(".png"));
  output.png.assign(png.begin(), png.end());
  if (!end->succeeded || output.svg.empty() || output.png.empty()) {
    return fail(fmt::format("gnuplot could not draw {}: {}", file(".gp").string(), end->output));
  }
  output.svg = described_svg(output.svg, input.title, input.description);
  if (auto written = write_file_atomically(file(".svg"), bytes_of(output.svg)); !written)
    return std::unexpected(written.error());
  return output;
}

}  // namespace penumbra
