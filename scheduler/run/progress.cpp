#include "scheduler/run/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "kernels/host/console.h"
#include "kernels/host/text.h"
#include "scheduler/files/json_number.h"

namespace penumbra {
namespace {

constexpr int kWidestBar = 20;  // leaves enough of 80 columns for the text, whose length varies
constexpr int kNarrowestBar = 5;

double done_share(const RenderProgress& progress) {
  if (progress.samples_total == 0) return 0.0;
  return std::min(1.0, double(progress.samples_done) / double(progress.samples_total));
}

}  // namespace

std::string clock_text(double seconds) {
  const auto whole = (long long)(std::ceil(std::clamp(seconds, 0.0, 1e12)));
  const long long hours = whole / 3600, minutes = whole / 60 % 60, rest = whole % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, rest);
  if (minutes > 0) return fmt::format("{}:{:02}", minutes, rest);
  return fmt::format("{} s", rest);
}

std::optional<double> seconds_left(const RenderProgress& progress) {
  const auto left = double(progress.samples_total - std::min(progress.samples_done, progress.samples_total));
  const double rate = double(progress.samples_done - progress.samples_before) / progress.elapsed_seconds;
  if (progress.samples_total > 0 && left == 0) return 0.0;
  return rate > 0 && std::isfinite(rate) ? std::optional(left / rate) : std::nullopt;
}

std::string progress_text(const RenderProgress& progress) {
  // Rounded down, so that 100% means that everything is done.
  std::string text = fmt::format("{:3d}%", int(std::floor(done_share(progress) * 100)));
  if (progress.samples_done > 0 && progress.elapsed_seconds > 0) {
    const double rate = double(progress.samples_done - progress.samples_before) / progress.elapsed_seconds;
    text += fmt::format("  {:.2f} Msamples/s", rate * 1e-6);
    if (const auto left = seconds_left(progress); left > 0.0)
      text += fmt::format("  {} left", clock_text(*left));
  }
  if (std::isfinite(progress.relative_error))
    text += fmt::format("  error {:.2g}%", progress.relative_error * 100);
  text += "  " + counted(progress.workers, "worker");
  return text;
}

std::string progress_bar(const RenderProgress& progress, int columns) {
  const std::string text = progress_text(progress);
  const int room = columns - int(text.size()) - 3;  // minus brackets and a space
  const int length = std::min(room, kWidestBar);
  if (length < kNarrowestBar) return text.substr(0, std::size_t(std::max(columns, 0)));
  const int filled = int(std::floor(done_share(progress) * length));
  return fmt::format("[{}{}] {}", std::string(std::size_t(filled), '#'),
                     std::string(std::size_t(length - filled), '.'), text);
}

std::string progress_json(const RenderProgress& progress, std::string_view what) {
  nlohmann::ordered_json json = {{"samples_done", progress.samples_done},
                                 {"samples_total", progress.samples_total},
                                 {"seconds", json_number(progress.elapsed_seconds)},
                                 {"seconds_left", json_number(seconds_left(progress).value_or(NAN))},
                                 {"relative_error", json_number(progress.relative_error)},
                                 {"workers", progress.workers},
                                 {"notices", progress.notices}};
  if (!what.empty()) json["render"] = what;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

ProgressPrinter::ProgressPrinter(ProgressStyle style, int columns) : style_(style), columns_(columns) {}

void ProgressPrinter::update(const RenderProgress& progress, const std::string& what) {
  if (style_ == ProgressStyle::kNone) return;
  if (style_ == ProgressStyle::kJson) return print_remark(progress_json(progress, what) + "\n");
  for (const std::string& notice : progress.notices) print_message(notice);
  if (style_ == ProgressStyle::kBar) {
    // Leave one column free, because terminals wrap a line that fills the last one.
    redraw_line(what + progress_bar(progress, columns_ - 1 - int(what.size())));
  } else if (std::abs(progress.elapsed_seconds - last_line_) >= kSecondsBetweenLines) {
    print_message(what + progress_text(progress));
    last_line_ = progress.elapsed_seconds;
  }
}

void ProgressPrinter::finish() { clear_line(); }

ProgressStyle progress_style() {
  const char* terminal = std::getenv("TERM");
  const bool can_redraw = terminal != nullptr && std::string_view(terminal) != "dumb";
  return isatty(STDERR_FILENO) != 0 && can_redraw ? ProgressStyle::kBar : ProgressStyle::kLines;
}

ProgressStyle progress_style(std::string_view name, bool show) {
  if (name == "json") return ProgressStyle::kJson;
  if (!show) return ProgressStyle::kNone;
  if (name == "bar") return ProgressStyle::kBar;
  return name == "lines" ? ProgressStyle::kLines : progress_style();
}

int terminal_columns() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

}  // namespace penumbra
