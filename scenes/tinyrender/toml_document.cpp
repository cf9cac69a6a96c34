#include "scenes/tinyrender/toml_document.h"

#include <fmt/format.h>

#include "scenes/toml/toml_file.h"

namespace penumbra::tinyrender {
namespace {

class Converter {
 public:
  explicit Converter(const SourceFile& file) : file_(file) {}

  [[nodiscard]] SourceLocation location(toml::source_position position) const {
    return toml_location(file_, position);
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
    for (const auto& [name, value] : in_order(node)) result.entries.push_back(entry(*name, *value));
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
};

}  // namespace

std::string describe_kind(const Value& value) {
  static const char* const kNames[] = {"an integer", "a number", "true or false", "text",
                                       "an array of numbers"};
  const auto* other = std::get_if<OtherValue>(&value);
  return other != nullptr ? other->what : kNames[value.index()];
}

Document read_document(const SourceFile& file, Diagnostics& diagnostics) {
  const Converter converter(file);
  const std::optional<toml::table> root = parse_toml(file, diagnostics);
  if (!root) return {};
  Document document;
  for (const auto& [key, node] : in_order(*root)) {
    if (const auto* table = node->as_table()) {
      document.tables.push_back(converter.table(*key, *table));
    } else {
      document.entries.push_back(converter.entry(*key, *node));
    }
  }
  return document;
}

}  // namespace penumbra::tinyrender
