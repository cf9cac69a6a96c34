#include "worker/cli/text_layout.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

#include "kernels/host/text.h"

namespace penumbra {

int text_columns() {
  constexpr int kFewest = 60, kMost = 200;
  winsize window{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0) return kTextColumns;
  return std::clamp(int(window.ws_col), kFewest, kMost);
}

int columns_of(std::string_view text) {
  int columns = 0;
  for (std::size_t at = 0; at < text.size(); ++columns)
    at += std::max<std::size_t>(1, character_length(text, at));
  return columns;
}

std::string wrapped(std::string_view text, int at, int indent, int columns) {
  std::string lines;
  int column = at;
  bool is_first = true;  // the first word of its line
  const auto begin_line = [&] {
    lines += "\n" + std::string(std::size_t(indent), ' ');
    column = indent;
    is_first = true;
  };
  for (std::size_t from = 0; from < text.size();) {
    if (text[from] == '\n') {
      begin_line();
      ++from;
      continue;
    }
    if (text[from] == ' ') {
      ++from;
      continue;
    }
    const std::size_t to = std::min(text.find_first_of(" \n", from), text.size());
    const std::string_view word = text.substr(from, to - from);
    const int length = columns_of(word);
    if (!is_first && column + 1 + length > columns) begin_line();
    if (!is_first) lines += ' ', ++column;
    lines += word;
    column += length;
    is_first = false;
    from = to;
  }
  return lines;
}

std::string described(std::string_view name, std::string_view text, int indent, int columns) {
  std::string line = "  " + std::string(name);
  const int length = columns_of(line);
  if (text.empty()) return line + "\n";
  if (length + 2 > indent)
    line += "\n" + std::string(std::size_t(indent), ' ');
  else
    line += std::string(std::size_t(indent - length), ' ');
  return line + wrapped(text, indent, indent, columns) + "\n";
}

}  // namespace penumbra
