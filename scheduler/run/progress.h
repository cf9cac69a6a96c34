// Shows the progress of a render: one line that is redrawn on a terminal, or occasional lines elsewhere.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "scheduler/farm/render_job.h"

namespace penumbra {

enum class ProgressStyle {
  kNone,
  kBar,    ///< one line, redrawn in place
  kLines,  ///< a line every kSecondsBetweenLines, for log files
  kJson,   ///< a JSON object a line on stdout, for other programs
};

constexpr double kSecondsBetweenLines = 10.0;

/// Whole seconds, rounded up so that 0 appears only at the end: "1:02:03", "4:05", "12 s".
std::string clock_text(double seconds);

/// At the rate so far of this process; nothing as long as that is unknown, 0 at the end.
std::optional<double> seconds_left(const RenderProgress& progress);

/// Percentage, rate, remaining time, error and workers, without a bar. Unknown values are left out.
std::string progress_text(const RenderProgress& progress);

/// A bar followed by `progress_text`, at most `columns` wide. If there is not enough room, first the bar is
/// shortened, then the text.
std::string progress_bar(const RenderProgress& progress, int columns);

/// One line with the fields samples_done, samples_total, seconds, seconds_left, relative_error, workers,
/// notices and, if it is not empty, render, which is `what`. Unknown values are null.
std::string progress_json(const RenderProgress& progress, std::string_view what);

/// Prints progress. Times are taken from the progress data.
class ProgressPrinter {
 public:
  /// `columns` is the width of the terminal, for kBar.
  ProgressPrinter(ProgressStyle style, int columns);
  /// Shows the progress. Notices are printed as lines that remain. `what` is put before the text.
  void update(const RenderProgress& progress, const std::string& what = {});
  /// Clears the bar.
  void finish();

 private:
  ProgressStyle style_;
  int columns_;
  double last_line_ = 0;  ///< elapsed seconds at the last plain line
};

/// The style for stderr: a bar on a terminal that can redraw a line, else lines.
ProgressStyle progress_style();
/// The style of an option's value: bar, lines, json; otherwise that for stderr. `show`: whether stderr shows
/// progress.
ProgressStyle progress_style(std::string_view name, bool show);
/// The width of stderr's terminal; 80 if it is not a terminal.
int terminal_columns();

}  // namespace penumbra
