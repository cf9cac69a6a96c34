// The words of pbrt's files: names, quoted text, numbers, brackets; comments from '#' to the end of a line;
// other files, which Include puts in the place of its name.
#pragma once

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
  std::string_view text;  ///< of a quoted text what is between the quotes
  SourceLocation location;
};

class TokenReader {
 public:
  TokenReader(const FileAccess& files, ReaderReport& report) : files_(files), report_(report) {}

  /// Goes on with a file, and after its end with what followed. Names are looked for beside the scene's first
  /// file. What is wrong is reported; then nothing is read.
  void enter(const std::filesystem::path& file, SourceLocation named_at);
  void include(std::string_view name, SourceLocation location);

  Token next();
  const Token& peek();

  /// How many files are open.
  [[nodiscard]] std::size_t depth() const { return open_.size(); }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Open {
    const SourceFile* file;
    std::size_t at = 0;
  };
  Token scan();

  const FileAccess& files_;
  ReaderReport& report_;
  std::filesystem::path folder_;
  std::vector<std::unique_ptr<SourceFile>> sources_;
  std::vector<Open> open_;
  std::size_t bytes_ = 0;
  Token ahead_;
  bool has_ahead_ = false;
};

}  // namespace penumbra::pbrt
