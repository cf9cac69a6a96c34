// The syntax that OBJ and MTL files share: one statement per line, tokens separated by blanks, comments after
// '#', and a backslash at the end of a line that continues on the next.
#pragma once

#include <span>
#include <string_view>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"

namespace penumbra {

class StatementScanner {
 public:
  explicit StatementScanner(const SourceFile& file) : file_(file), text_(file.text) {}

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }

  /// The next token of the statement; empty at the end of the statement.
  std::string_view token() {
    const std::string_view text = token_text();
    start_ = at_ - text.size();
    return text;
  }

  /// The rest of the line, for names that may contain blanks. Leading and trailing blanks and a comment (a
  /// '#' after a blank) are removed. Continuation lines are skipped.
  std::string_view rest() {
    skip_blanks();
    start_ = at_;
    std::size_t end = start_;
    for (; at_ < text_.size() && text_[at_] != '\n'; ++at_) {
      if (text_[at_] == '#' && (at_ == start_ || is_blank(text_[at_ - 1]))) break;
      if (const std::size_t after = continuation(at_); after != at_) {
        at_ = after;
        while (!token_text().empty()) {
        }
        break;
      }
      if (!is_blank(text_[at_])) end = at_ + 1;
    }
    return text_.substr(start_, end - start_);
  }

  /// Like rest(), but without advancing.
  std::string_view rest_of_line() {
    const std::size_t at = at_, start = start_;
    const std::string_view text = rest();
    at_ = at;
    start_ = start;
    return text;
  }

  /// Advances to the next statement.
  void next() {
    while (!token_text().empty()) {
    }
    const std::size_t end = text_.find('\n', at_);
    at_ = end == text_.npos ? text_.size() : end + 1;
  }

  /// The location of the last token.
  [[nodiscard]] SourceLocation location() const { return {&file_, start_}; }

  [[nodiscard]] std::unexpected<Error> wrong(std::string_view message) const {
    return fail(format_diagnostic(location(), "error", message));
  }

  /// Reads all remaining numbers of the statement into `values`: between `least` and `most`, where most <=
  /// values.size(). Returns their count. Errors: another count; tokens that are not finite numbers.
  Expected<int> numbers(std::string_view statement, int least, int most, std::span<double> values);

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  static bool is_end(char c) { return is_blank(c) || c == '\n' || c == '#'; }

  std::string_view token_text() {
    skip_blanks();
    const std::size_t start = at_;
    while (at_ < text_.size() && !is_end(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }

  void skip_blanks() {
    for (;;) {
      while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
      const std::size_t after = continuation(at_);
      if (after == at_) return;
      at_ = after;
    }
  }

  /// The start of the next line if a backslash at `at` ends this line, else `at`.
  [[nodiscard]] std::size_t continuation(std::size_t at) const {
    if (at >= text_.size() || text_[at] != '\\') return at;
    std::size_t end = at + 1;
    if (end < text_.size() && text_[end] == '\r') ++end;
    return end < text_.size() && text_[end] == '\n' ? end + 1 : at;
  }

  const SourceFile& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t start_ = 0;
};

}  // namespace penumbra
