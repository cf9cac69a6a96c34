// How far a render is, for people: one redrawn line on a terminal, a plain line now and then elsewhere.
#pragma once

#include <string>

#include "scheduler/farm/render_job.h"

namespace penumbra {

enum class ProgressStyle {
  kNone,
  kBar,    ///< one line, redrawn in place
  kLines,  ///< a line every kSecondsBetweenLines, for log files
};

constexpr double kSecondsBetweenLines = 10.0;

/// e.g. "1:02:03", "4:05", "12 s"; whole seconds, rounded up, so that it is not 0 before the end.
std::string clock_text(double seconds);

/// Percent done, rate, time left, error and workers, without a bar. What is not known yet is left out.
std::string progress_text(const RenderProgress& progress);

/// A bar in front of `progress_text`, at most `columns` wide; the bar shrinks first, then the text is cut.
std::string progress_bar(const RenderProgress& progress, int columns);

/// Prints progress to stderr. Time is what the progress says it is.
class ProgressPrinter {
 public:
  /// `columns` is the width of the terminal, for kBar.
  ProgressPrinter(ProgressStyle style, int columns);
  /// Notices become lines that stay; `what` is put before the rest.
  void update(const RenderProgress& progress, const std::string& what = {});
  /// Clears the bar.
  void finish();

 private:
  ProgressStyle style_;
  int columns_;
  double last_line_ = 0;  ///< elapsed seconds at the last plain line
};

/// The style for stderr: a bar if it is a terminal that can redraw a line, else lines.
ProgressStyle progress_style();
/// Width of stderr's terminal, 80 if it has none.
int terminal_columns();

}  // namespace penumbra
