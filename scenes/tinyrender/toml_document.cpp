#include "scenes/tinyrender/toml_document.h"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>

#include "scenes/tinyrender/toml_keys.h"

namespace penumbra::tinyrender {
namespace {

class Converter {
 public:
  explicit Converter(const SourceFile& file) : file_(file) {
    const std::string_view text = file.text;
    for (std::size_t at = text.find('\n'); at != text.npos; at = text.find('\n', at + 1))
      line_starts_.push_back(at + 1);
  }

  /// Lines and columns from 1, columns in code points; 0: nowhere, which is the file's start.
  [[nodiscard]] SourceLocation location(toml::source_position position) const {
    if (position.line == 0 || position.column == 0) return {&file_, 0};
    const std::string_view text = file_.text;
    std::size_t at = line_starts_[std::min<std::size_t>(position.line, line_starts_.size()) - 1];
    for (std::uint32_t column = 1; column < position.column && at < text.size() && text[at] != '\n';
         ++column) {
      ++at;
      while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80) ++at;
    }
    return {&file_, at};
  }

  [[nodiscard]] Entry entry(const toml::key& key, const toml::node& node) const {
    Entry result;
    result.key = key.str();
    result.key_location = location(key.source().begin);
    result.value_location = location(node.source().begin);
    if (const auto* integer = node.as_integer()) {
      result.value = integer->get();
      result.text = fmt::format("{}", integer->get());
    } else if (const auto* number = node.as_floating_point()) {
      result.value = number->get();
      result.text = fmt::format("{}", number->get());
    } else if (const auto* boolean = node.as_boolean()) {
      result.value = boolean->get();
      result.text = boolean->get() ? "true" : "false";
    } else if (const auto* text = node.as_string()) {
      result.value = text->get();
      result.text = text->get();
    } else if (const auto* array = node.as_array()) {
      result.value = numbers(*array);
      if (const auto* values = std::get_if<std::vector<double>>(&result.value))
        result.text = fmt::format("{}", fmt::join(*values, " "));
    } else {
      result.value = OtherValue{node.is_table() ? "a table" : "a date or time"};
    }
    return result;
  }

  [[nodiscard]] Table table(const toml::key& key, const toml::table& node) const {
    Table result{std::string(key.str()), location(key.source().begin), {}};
    for (const auto& [name, value] : node) result.entries.push_back(entry(name, value));
    std::ranges::sort(result.entries, {}, [](const Entry& e) { return e.key_location.offset; });
    return result;
  }

 private:
  static Value numbers(const toml::array& array) {
    std::vector<double> values;
    for (const toml::node& node : array) {
      const auto value = node.value<double>();
      if (!node.is_number() || !value) return OtherValue{"an array of other things than numbers"};
      values.push_back(*value);
    }
    return values;
  }

  const SourceFile& file_;
  std::vector<std::size_t> line_starts_ = {0};
};

}  // namespace

std::string describe_kind(const Value& value) {
  static const char* const kNames[] = {"an integer", "a number", "true or false", "text",
                                       "an array of numbers"};
  const auto* other = std::get_if<OtherValue>(&value);
  return other != nullptr ? other->what : kNames[value.index()];
}

Document parse_toml(const SourceFile& file, Diagnostics& diagnostics) {
  const Converter converter(file);
  // Arrays and inline tables have a limit in the parser; keys have none, and overflow the stack.
  if (const auto deep = find_deep_key(file.text)) {
    diagnostics.error({&file, *deep}, fmt::format("a key of more than {} parts", kMaxKeyParts));
    return {};
  }
  toml::table root;
  try {
    root = toml::parse(std::string_view(file.text));
  } catch (const toml::parse_error& error) {
    diagnostics.error(converter.location(error.source().begin),
                      fmt::format("not TOML: {}", error.description()));
    return {};
  }
  Document document;
  for (const auto& [key, node] : root) {
    if (const auto* table = node.as_table()) {
      document.tables.push_back(converter.table(key, *table));
    } else {
      document.entries.push_back(converter.entry(key, node));
    }
  }
  std::ranges::sort(document.tables, {}, [](const Table& t) { return t.location.offset; });
  std::ranges::sort(document.entries, {}, [](const Entry& e) { return e.key_location.offset; });
  return document;
}

}  // namespace penumbra::tinyrender
