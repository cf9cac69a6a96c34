#include "scenes/diagnostic.h"

#include <fmt/format.h>

#include <algorithm>

#include "kernels/host/text.h"
#include "scenes/text.h"

namespace penumbra {
namespace {

constexpr std::size_t kMaxReportedErrors = 20;
constexpr std::size_t kMaxReportedWarnings = 200;
constexpr std::size_t kMaxShownColumns = 120;
constexpr std::size_t kMaxMessageBytes = 2000;

bool starts_code_point(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

/// Counts characters as visible() shows them: each invalid byte is one.
std::size_t count_characters(std::string_view text) {
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size(); ++count)
    at += std::max<std::size_t>(1, character_length(text, at));
  return count;
}

std::string_view line_at(const SourceFile& file, std::size_t offset, std::size_t& line_start) {
  const std::string_view text = file.text;
  line_start = offset == 0 ? 0 : text.rfind('\n', offset - 1) + 1;  // npos + 1 is 0
  const std::size_t end = text.find('\n', line_start);
  std::string_view line = text.substr(line_start, end == text.npos ? text.npos : end - line_start);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// Sorted marks. Within a line they are at most about kMarkBytes apart, so that any position is found
/// quickly.
const std::vector<SourceFile::Mark>& marks_of(const SourceFile& file) {
  constexpr std::size_t kMarkBytes = 4096;
  std::vector<SourceFile::Mark>& marks = file.marks;
  if (!marks.empty()) return marks;
  const std::string_view text = file.text;
  std::size_t start = 0;
  for (std::size_t line = 1; start != text.npos; ++line) {
    const std::size_t line_feed = text.find('\n', start), end = std::min(line_feed, text.size());
    marks.push_back({start, {line, 1}});
    std::size_t column = 1;
    for (std::size_t at = start; end - at > kMarkBytes;) {
      for (const std::size_t next = at + kMarkBytes; at < next; ++column)
        at += std::max<std::size_t>(1, character_length(text, at));
      if (at < end) marks.push_back({at, {line, column}});
    }
    start = line_feed == text.npos ? line_feed : line_feed + 1;
  }
  return marks;
}

}  // namespace

LineColumn line_and_column(SourceLocation location) {
  const std::string_view text = location.file->text;
  const std::size_t offset = std::min(location.offset, text.size());
  const SourceFile::Mark& mark =
      *std::prev(std::ranges::upper_bound(marks_of(*location.file), offset, {}, &SourceFile::Mark::offset));
  return {mark.place.line,
          mark.place.column + count_characters(text.substr(mark.offset, offset - mark.offset))};
}

SourceLocation location_of(const SourceFile& file, LineColumn place) {
  const std::vector<SourceFile::Mark>& marks = marks_of(file);
  const std::size_t line = std::clamp<std::size_t>(place.line, 1, marks.back().place.line);
  std::size_t at =
      std::ranges::lower_bound(marks, line, {}, [](const auto& m) { return m.place.line; })->offset;
  for (std::size_t column = 1; column < place.column && at < file.text.size() && file.text[at] != '\n';
       ++column) {
    ++at;
    while (at < file.text.size() && (static_cast<unsigned char>(file.text[at]) & 0xC0) == 0x80) ++at;
  }
  return {&file, at};
}

std::string describe(SourceLocation location) {
  const LineColumn at = line_and_column(location);
  return fmt::format("{}:{}:{}", location.file->path.string(), at.line, at.column);
}

std::string format_message(SourceLocation location, std::string_view severity, std::string_view message) {
  const std::string where = location.file != nullptr ? visible(describe(location)) + ": " : "";
  return fmt::format("{}{}: {}", where, severity, visible(shortened(message, kMaxMessageBytes)));
}

std::string format_diagnostic(SourceLocation location, std::string_view severity, std::string_view message) {
  const std::string text = format_message(location, severity, message);
  if (location.file == nullptr) return text;
  const std::size_t offset = std::min(location.offset, location.file->text.size());
  std::size_t start = 0;
  std::string_view line = line_at(*location.file, offset, start);
  std::size_t caret = std::min(offset - start, line.size());
  if (line.size() > kMaxShownColumns) {
    std::size_t cut = caret < kMaxShownColumns / 2 ? 0 : caret - kMaxShownColumns / 2;
    while (cut < caret && !starts_code_point(line[cut])) ++cut;
    line = line.substr(cut);
    std::size_t end = std::min(line.size(), kMaxShownColumns);
    while (end < line.size() && !starts_code_point(line[end])) ++end;
    line = line.substr(0, end);
    caret -= cut;
  }
  std::string indent;
  for (const char c : visible(line.substr(0, caret))) {
    if (starts_code_point(c)) indent += c == '\t' ? '\t' : ' ';
  }
  return fmt::format("{}\n  {}\n  {}^", text, visible(line), indent);
}

std::string list_names(std::span<const std::string> names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

std::string known_names(std::string_view name, std::span<const std::string> known, std::string_view these) {
  const std::string hint = suggestion(name, known);
  return fmt::format("{} {}: {}", hint.empty() ? "." : hint, these, list_names(known));
}

void Diagnostics::error(SourceLocation location, std::string_view message) {
  if (!full()) error_text(format_diagnostic(location, "error", message));
}

void Diagnostics::error_text(std::string text) {
  if (!full() && seen_.insert(text).second) errors_.push_back(std::move(text));
}

void Diagnostics::warn(SourceLocation location, std::string_view message) {
  if (warnings_.size() >= kMaxReportedWarnings) {
    ++more_warnings_;
    return;
  }
  std::string text = format_message(location, "warning", message);
  if (seen_.insert(text).second) warnings_.push_back(std::move(text));
}

void Diagnostics::warn_counted(SourceLocation location, std::string_view message) {
  if (const auto known = counted_.find(message); known != counted_.end()) {
    known->second.count += seen_.insert(format_message(location, "warning", message)).second ? 1 : 0;
    return;
  }
  const std::size_t index = warnings_.size();
  warn(location, message);
  if (warnings_.size() > index) counted_.emplace(message, Counted{index, 1});
}

std::vector<std::string> Diagnostics::take_warnings() {
  for (const auto& [message, counted] : counted_)
    if (counted.count > 1) warnings_[counted.warning] += fmt::format(" ({} times)", counted.count);
  counted_.clear();
  if (more_warnings_ > 0) warnings_.push_back(fmt::format("warning: and {} more", more_warnings_));
  return std::move(warnings_);
}

bool Diagnostics::full() const { return errors_.size() >= kMaxReportedErrors; }

Error Diagnostics::error() const {
  return Error{fmt::format("{}{}", fmt::join(errors_, "\n"), full() ? "\n… and perhaps more" : "")};
}

}  // namespace penumbra
