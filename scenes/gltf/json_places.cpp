#include "scenes/gltf/json_places.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

namespace penumbra::gltf {
namespace {

constexpr int kMaxDepth = 64;

/// Scans well-formed JSON without building a document.
class Scanner {
 public:
  Scanner(std::string_view text, std::size_t at) : text_(text), at_(at) { skip_space(); }

  [[nodiscard]] std::size_t at() const { return at_; }

  /// Advances to the member or element, if it exists.
  bool enter(const JsonStep& step) {
    const bool is_member = std::holds_alternative<std::string_view>(step);
    if (at_ >= text_.size() || text_[at_] != (is_member ? '{' : '[')) return false;
    take(1);
    for (std::size_t i = 0; at_ < text_.size() && text_[at_] != '}' && text_[at_] != ']'; ++i) {
      bool found = false;
      if (is_member) {
        const std::size_t start = at_;
        skip_string();
        found = text_.substr(start + 1, at_ - start - 2) == std::get<std::string_view>(step);
        skip_space();
        take(1);  // the colon
      } else {
        found = i == std::get<std::size_t>(step);
      }
      if (found) return true;
      skip_value();
      skip_space();
      if (at_ < text_.size() && text_[at_] == ',') take(1);
    }
    return false;
  }

 private:
  void skip_space() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
  }
  void take(std::size_t characters) {
    at_ += characters;
    skip_space();
  }
  void skip_string() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    at_ = std::min(at_ + 1, text_.size());
  }
  /// Skips a value by counting brackets outside of strings.
  void skip_value() {
    int depth = 0;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"') {
        skip_string();
      } else if (c == '{' || c == '[') {
        ++depth;
        ++at_;
      } else if (c == '}' || c == ']') {
        if (depth == 0) return;
        --depth;
        ++at_;
      } else if (depth == 0 && c == ',') {
        return;
      } else {
        ++at_;
      }
      if (depth == 0 && (c == '"' || c == '}' || c == ']')) return;
    }
  }

  std::string_view text_;
  std::size_t at_;
};

/// Checks JSON without building a document, and records where something is wrong.
class Checker : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return deeper(); }
  bool end_object() override { return --depth_, true; }
  bool start_array(std::size_t) override { return deeper(); }
  bool end_array() override { return --depth_, true; }
  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& what) override {
    at = position > 0 ? position - 1 : 0;
    // "[json.exception.parse_error.101] parse error at line 1, column 2: …"
    const std::string_view text = what.what();
    const std::size_t colon = text.find(": ");
    message = fmt::format("not JSON: {}", colon == text.npos ? text : text.substr(colon + 2));
    return false;
  }

  std::size_t at = 0;
  std::string message;
  bool too_deep = false;

 private:
  bool deeper() {
    too_deep = ++depth_ > kMaxDepth;
    return !too_deep;
  }
  int depth_ = 0;
};

/// Where brackets are nested too deep.
std::size_t deep_place(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quoted && text[i] == '\\') {
      ++i;
    } else if (text[i] == '"') {
      quoted = !quoted;
    } else if (!quoted && (text[i] == '{' || text[i] == '[')) {
      if (++depth > kMaxDepth) return i;
    } else if (!quoted && (text[i] == '}' || text[i] == ']')) {
      --depth;
    }
  }
  return text.size();
}

}  // namespace

SourceLocation json_place(const SourceFile& file, std::initializer_list<JsonStep> path) {
  Scanner scanner(file.text, 0);
  std::size_t at = scanner.at();
  for (const JsonStep& step : path) {
    if (!scanner.enter(step)) break;
    at = scanner.at();
  }
  return {&file, at};
}

Expected<void> check_json(const SourceFile& file) {
  Checker checker;
  if (nlohmann::json::sax_parse(file.text, &checker)) return {};
  if (checker.too_deep)
    return fail(format_diagnostic({&file, deep_place(file.text)}, "error",
                                  fmt::format("values are nested more than {} deep", kMaxDepth)));
  return fail(format_diagnostic({&file, checker.at}, "error", checker.message));
}

}  // namespace penumbra::gltf
