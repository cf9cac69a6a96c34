#include "scenes/mitsuba/xml_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "kernels/host/text.h"

namespace penumbra::mitsuba {
namespace {

constexpr int kMaxDepth = 64;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

struct AttributePlace {
  std::size_t name = 0, value = 0;
};

/// Finds an attribute in the start tag whose name is at `offset`. The text must be well-formed.
AttributePlace find_attribute(std::string_view text, std::size_t offset, std::string_view wanted) {
  const AttributePlace fallback{offset, offset};
  std::size_t at = offset;
  const auto skip_space = [&] {
    while (at < text.size() && is_space(text[at])) ++at;
  };
  while (at < text.size() && !is_space(text[at]) && text[at] != '>' && text[at] != '/') ++at;
  for (;;) {
    skip_space();
    const std::size_t name = at;
    while (at < text.size() && !is_space(text[at]) && std::strchr("=>/", text[at]) == nullptr) ++at;
    const std::string_view found = text.substr(name, at - name);
    skip_space();
    if (found.empty() || at >= text.size() || text[at] != '=') return fallback;
    ++at;
    skip_space();
    if (at >= text.size() || (text[at] != '"' && text[at] != '\'')) return fallback;
    const std::size_t value = at + 1;
    const std::size_t end = text.find(text[at], value);
    if (found == wanted) return {name, value};
    if (end == text.npos) return fallback;
    at = end + 1;
  }
}

/// The offset of the first byte that is invalid UTF-8 or NUL. Ids and names are put into reports, which must
/// be UTF-8.
std::optional<std::size_t> find_bad_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text, i);
    if (length == 0 || text[i] == '\0') return i;
    i += length;
  }
  return std::nullopt;
}

Expected<void> check_document(const SourceFile& file, const pugi::xml_node& root) {
  const auto wrong = [&](const pugi::xml_node& node, std::string_view message) {
    return fail(format_diagnostic(locate(file, node), "error", message));
  };
  pugi::xml_node node = root;
  int depth = 0;
  // Traverses depth first without recursion, so that deep nesting cannot overflow the stack.
  while (node) {
    if (node.type() == pugi::node_doctype && std::strchr(node.value(), '[') != nullptr) {
      return wrong(
          node,
          "a document type with declarations of its own is not read: entities can expand without bound");
    }
    if (node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata) {
      return wrong(node, "text between elements means nothing in a scene; values are attributes");
    }
    if (depth > kMaxDepth)
      return wrong(node, fmt::format("elements are nested more than {} deep", kMaxDepth));
    if (node.first_child()) {
      node = node.first_child();
      ++depth;
      continue;
    }
    while (node && !node.next_sibling()) {
      node = node.parent();
      --depth;
      if (node == root) return {};
    }
    node = node.next_sibling();
  }
  return {};
}

}  // namespace

SourceLocation locate(const SourceFile& file, const pugi::xml_node& element) {
  const std::ptrdiff_t offset = element.offset_debug();
  return {&file, offset < 0 ? 0 : std::size_t(offset)};
}

SourceLocation locate_value(const SourceFile& file, const pugi::xml_node& element,
                            std::string_view attribute) {
  return {&file, find_attribute(file.text, locate(file, element).offset, attribute).value};
}

SourceLocation locate_attribute(const SourceFile& file, const pugi::xml_node& element,
                                std::string_view attribute) {
  return {&file, find_attribute(file.text, locate(file, element).offset, attribute).name};
}

Expected<void> parse_xml(const SourceFile& file, pugi::xml_document& document) {
  if (const auto bad = find_bad_utf8(file.text)) {
    return fail(format_diagnostic({&file, *bad}, "error", "the file is not UTF-8 text from here on"));
  }
  constexpr unsigned kOptions = pugi::parse_default | pugi::parse_doctype;
  const pugi::xml_parse_result result =
      document.load_buffer(file.text.data(), file.text.size(), kOptions, pugi::encoding_utf8);
  if (!result) {
    const auto offset =
        std::size_t(std::clamp<std::ptrdiff_t>(result.offset, 0, std::ptrdiff_t(file.text.size())));
    return fail(format_diagnostic({&file, offset}, "error",
                                  fmt::format("not well-formed XML: {}", result.description())));
  }
  return check_document(file, document);
}

}  // namespace penumbra::mitsuba
