// The tokens of pbrt's files: names, quoted strings, numbers, brackets. Comments run from '#' to the end of
// the line. Include and similar directives insert other files.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/reader_report.h"

namespace penumbra::pbrt {

enum class TokenKind { kEnd, kWord, kText, kOpen, kClose };

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string_view text;  ///< of a quoted string: without the quotes, escapes resolved
  SourceLocation location;
};

class TokenReader {
 public:
  TokenReader(const FileAccess& files, ReaderReport& report) : files_(files), report_(report) {}

  /// Continues with a file, and after its end with the rest of the current one. Relative names are searched
  /// in the folder of the scene's first file. Errors are reported; then the file is skipped.
  void enter(const std::filesystem::path& file, SourceLocation named_at);
  void include(std::string_view name, SourceLocation location);

  Token next();
  const Token& peek();

  /// The number of open files.
  [[nodiscard]] std::size_t depth() const { return open_.size(); }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Open {
    const SourceFile* file;
    std::size_t at = 0;
  };
  Token scan();
  Token quoted(Open& open);

  const FileAccess& files_;
  ReaderReport& report_;
  std::filesystem::path folder_;
  std::vector<std::unique_ptr<SourceFile>> sources_;
  std::vector<Open> open_;
  std::deque<std::string> resolved_;  ///< strings that had escapes
  std::size_t bytes_ = 0;
  Token ahead_;
  bool has_ahead_ = false;
};

}  // namespace penumbra::pbrt
