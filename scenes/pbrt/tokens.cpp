#include "scenes/pbrt/tokens.h"

#include <fmt/format.h>

#include <array>

namespace penumbra::pbrt {
namespace {

constexpr std::size_t kMostDepth = 16, kMostFiles = 4096;
constexpr std::size_t kMostBytes = std::size_t{4} << 30;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

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
    if (first == '"') {
      const std::size_t end = text.find_first_of("\"\n", start + 1);
      if (end == text.npos || text[end] == '\n') {
        report_.error(location, "this text has no closing quote on its line");
        open.at = end == text.npos ? text.size() : end;
        return {TokenKind::kText, text.substr(start + 1, open.at - start - 1), location};
      }
      open.at = end + 1;
      return {TokenKind::kText, text.substr(start + 1, end - start - 1), location};
    }
    while (open.at < text.size() && !is_space(text[open.at]) &&
           std::string_view("[]\"#").find(text[open.at]) == std::string_view::npos)
      ++open.at;
    return {TokenKind::kWord, text.substr(start, open.at - start), location};
  }
  return {};
}

}  // namespace penumbra::pbrt
