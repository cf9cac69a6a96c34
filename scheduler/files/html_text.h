// The small parts that an HTML page is made of.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// A page: its title, its style sheet, further elements of its head, and its body.
std::string html_page(std::string_view title, std::string_view style, std::string_view head,
                      std::string_view body);

/// RFC 4648, with padding.
std::string base64(std::span<const std::uint8_t> bytes);

/// data:image/png;base64,…
std::string png_uri(std::span<const std::uint8_t> png);

/// The <svg> element alone, without XML declaration, document type and comments; ids get `prefix`, so that
/// several can be on one page.
std::string inline_svg(std::string_view svg, std::string_view prefix);

/// For people: three or four digits, "1.23e-05" below a thousandth; "–" for what is not a number.
std::string number_text(double value);
/// "0.0123 s", "12.3 s", "2 min 05 s".
std::string seconds_text(double seconds);

/// A table of cells that are HTML already.
class HtmlTable {
 public:
  explicit HtmlTable(const std::vector<std::string>& header);
  void add(const std::vector<std::string>& cells);
  [[nodiscard]] std::string text() const;

 private:
  std::string text_;
};

}  // namespace penumbra
