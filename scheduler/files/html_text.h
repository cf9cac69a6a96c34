// Building blocks of HTML pages.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// A page with this title, style sheet, additional head elements and body. It is readable from 320 pixels
/// width on, in light and dark. Style sheets of pages use its colours: --page, --text, --quiet, --line,
/// --soft, --link, --warn, --good, --bad.
std::string html_page(std::string_view title, std::string_view style, std::string_view head,
                      std::string_view body);

/// The style sheet that all pages share.
std::string_view html_base_style();

/// Base64 with padding (RFC 4648).
std::string base64(std::span<const std::uint8_t> bytes);

/// The image as a URI: data:image/png;base64,…
std::string png_uri(std::span<const std::uint8_t> png);

/// Only the <svg> element, without XML declaration, document type and comments. IDs get `prefix`, so that a
/// page can contain several.
std::string inline_svg(std::string_view svg, std::string_view prefix);

/// A number for display: three or four digits, "1.23e-05" below a thousandth; "–" for NaN.
std::string number_text(double value);
/// "0.0123 s", "12.3 s", "2 min 05 s".
std::string seconds_text(double seconds);

/// A table whose cells are HTML.
class HtmlTable {
 public:
  /// `label` names the table for screen readers.
  HtmlTable(const std::string& label, const std::vector<std::string>& header);
  void add(const std::vector<std::string>& cells);
  [[nodiscard]] std::string text() const;

 private:
  std::string text_;
};

}  // namespace penumbra
