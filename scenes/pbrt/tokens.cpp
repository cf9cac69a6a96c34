#include "scenes/pbrt/tokens.h"

#include <fmt/format.h>

#include <array>

namespace penumbra::pbrt {
namespace {

constexpr std::size_t kMostDepth = 16, kMostFiles = 4096;
constexpr std::size_t kMostBytes = std::size_t{4} << 30;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// The character that pbrt's strings write as a backslash and `c`; 0: none.
char escaped(char c) {
  constexpr std::string_view kWritten = "bfnrt\\'\"", kMeant = "\b\f\n\r\t\\'\"";
  const std::size_t at = kWritten.find(c);
  return at == kWritten.npos ? '\0' : kMeant[at];
}

}  // namespace

void TokenReader::enter(const std::filesystem::path& file, SourceLocation named_at) {
  if (open_.size() >= kMostDepth || sources_.size() >= kMostFiles)
    return report_.error(named_at, fmt::format("too many files: at most {} within each other, {} in all",
                                               kMostDepth, kMostFiles));
  auto source = files_.read(file, kMaxMeshFileBytes);
  if (!source) return report_.error(named_at, source.error().message);
  bytes_ += (*source)->text.size();
  if (bytes_ > kMostBytes)
    return report_.error(named_at, fmt::format("the scene's files have more than {} bytes", kMostBytes));
  if (sources_.empty()) folder_ = file.parent_path();
  sources_.push_back(std::move(*source));
  open_.push_back({sources_.back().get()});
}

void TokenReader::include(std::string_view name, SourceLocation location) {
  const std::array<std::filesystem::path, 1> folders = {folder_};
  const auto path = files_.find(name, folders);
  if (!path) return report_.error(location, path.error().message);
  enter(*path, location);
}

const Token& TokenReader::peek() {
  if (!has_ahead_) ahead_ = scan();
  has_ahead_ = true;
  return ahead_;
}

Token TokenReader::next() {
  if (!has_ahead_) return scan();
  has_ahead_ = false;
  return ahead_;
}

/// A string in quotes, at the first of which `open` stands.
Token TokenReader::quoted(Open& open) {
  const std::string_view text = open.file->text;
  const std::size_t start = open.at;
  const SourceLocation location{open.file, start};
  std::size_t end = start + 1;
  bool escapes = false;
  for (; end < text.size() && text[end] != '"' && text[end] != '\n'; ++end)
    if (text[end] == '\\' && end + 1 < text.size() && text[end + 1] != '\n') {
      escapes = true;
      ++end;
    }
  const bool closed = end < text.size() && text[end] == '"';
  if (!closed) report_.error(location, "this text has no closing quote on its line");
  open.at = closed ? end + 1 : end;
  const std::string_view written = text.substr(start + 1, end - start - 1);
  if (!escapes) return {TokenKind::kText, written, location};
  std::string resolved;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const bool is_escape = written[i] == '\\' && i + 1 < written.size();
    const char meant = is_escape ? escaped(written[i + 1]) : written[i];
    if (is_escape && meant == '\0')
      report_.error(
          {open.file, start + 1 + i},
          fmt::format("'\\{}' is no escape; there are: \\b \\f \\n \\r \\t \\\\ \\' \\\"", written[i + 1]));
    if (is_escape) ++i;
    resolved += meant;
  }
  resolved_.push_back(std::move(resolved));
  return {TokenKind::kText, resolved_.back(), location};
}

Token TokenReader::scan() {
  while (!open_.empty()) {
    Open& open = open_.back();
    const std::string_view text = open.file->text;
    while (open.at < text.size() && (is_space(text[open.at]) || text[open.at] == '#')) {
      if (text[open.at] == '#') {
        const std::size_t end = text.find('\n', open.at);
        open.at = end == text.npos ? text.size() : end;
      } else {
        ++open.at;
      }
    }
    if (open.at >= text.size()) {
      if (open_.size() == 1) return {TokenKind::kEnd, "", {open.file, text.size()}};
      open_.pop_back();
      continue;
    }
    const std::size_t start = open.at;
    const SourceLocation location{open.file, start};
    const char first = text[start];
    if (first == '[' || first == ']') {
      ++open.at;
      return {first == '[' ? TokenKind::kOpen : TokenKind::kClose, text.substr(start, 1), location};
    }
    if (first == '"') return quoted(open);
    while (open.at < text.size() && !is_space(text[open.at]) &&
           std::string_view("[]\"#").find(text[open.at]) == std::string_view::npos)
      ++open.at;
    return {TokenKind::kWord, text.substr(start, open.at - start), location};
  }
  return {};
}

}  // namespace penumbra::pbrt
