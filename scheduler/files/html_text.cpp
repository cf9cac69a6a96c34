#include "scheduler/files/html_text.h"

#include <fmt/format.h>

#include <cmath>

namespace penumbra {
namespace {

constexpr const char* kBaseStyle = R"css(
:root { color-scheme: light dark; --page: #ffffff; --text: #1b1d21; --quiet: #59606a; --line: #d8dbe0;
  --soft: #f3f4f6; --link: #0b57a4; --warn: #fff4d6; --good: #1d7a35; --bad: #b3202a; }
@media (prefers-color-scheme: dark) { :root { --page: #15181c; --text: #e4e6ea; --quiet: #a5acb6; --line: #383e47;
  --soft: #22272e; --link: #86bcff; --warn: #3b3013; --good: #74d190; --bad: #ff9a97; } }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; }
body { font: 15px/1.5 system-ui, sans-serif; color: var(--text); background: var(--page); margin: 0 auto; padding: 16px;
  overflow-wrap: break-word; }
@media (min-width: 700px) { body { padding: 28px 32px; } }
h1 { font-size: 27px; line-height: 1.25; margin: 0 0 8px; } h2 { font-size: 21px; line-height: 1.3; }
h3 { font-size: 17px; } a, summary { color: var(--link); } summary { cursor: pointer; }
img, svg { max-width: 100%; height: auto; }
code { font: 13px/1.5 ui-monospace, monospace; background: var(--soft); padding: 1px 4px; border-radius: 3px; overflow-wrap: anywhere; }
.quiet { color: var(--quiet); } .scroll { overflow-x: auto; max-width: 100%; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 14px; }
)css";

}  // namespace

std::string html_page(std::string_view title, std::string_view style, std::string_view head,
                      std::string_view body) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\">\n{}<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n{}</"
      "body>\n</html>\n",
      head, title, kBaseStyle, style, body);
}

std::string_view html_base_style() { return kBaseStyle; }

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t word = std::uint32_t(bytes[i]) << 16 |
                               (left > 1 ? std::uint32_t(bytes[i + 1]) << 8 : 0) |
                               (left > 2 ? std::uint32_t(bytes[i + 2]) : 0);
    out += kDigits[word >> 18];
    out += kDigits[word >> 12 & 63];
    out += left > 1 ? kDigits[word >> 6 & 63] : '=';
    out += left > 2 ? kDigits[word & 63] : '=';
  }
  return out;
}

std::string png_uri(std::span<const std::uint8_t> png) { return "data:image/png;base64," + base64(png); }

std::string inline_svg(std::string_view svg, std::string_view prefix) {
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string_view::npos) return {};
  std::string out;
  std::string_view rest = svg.substr(begin);
  for (std::size_t at = 0; at < rest.size();) {
    const auto starts = [&](std::string_view word) { return rest.substr(at).starts_with(word); };
    if (starts("<!--")) {
      const std::size_t end = rest.find("-->", at);
      at = end == std::string_view::npos ? rest.size() : end + 3;
      continue;
    }
    bool named = false;
    for (const std::string_view word :
         {std::string_view(" id=\""), std::string_view(" id='"), std::string_view("url(#"),
          std::string_view("href='#"), std::string_view("href=\"#")}) {
      if (!starts(word)) continue;
      out += word;
      out += prefix;
      at += word.size();
      named = true;
      break;
    }
    if (!named) out += rest[at++];
  }
  return out;
}

std::string number_text(double value) {
  if (!std::isfinite(value)) return "–";
  if (value != 0 && std::abs(value) < 1e-3) return fmt::format("{:.2e}", value);
  return fmt::format("{:.3g}", value);
}

std::string seconds_text(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  if (seconds < 120) return fmt::format("{:.3g} s", seconds);
  if (seconds < 7200)
    return fmt::format("{:.0f} min {:02.0f} s", std::floor(seconds / 60), std::floor(std::fmod(seconds, 60)));
  return fmt::format("{:.1f} h", seconds / 3600);
}

HtmlTable::HtmlTable(const std::string& label, const std::vector<std::string>& header) {
  // What scrolls can be reached with the keyboard.
  text_ = fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table><thead><tr>", label);
  for (const std::string& cell : header) text_ += "<th scope=\"col\">" + cell + "</th>";
  text_ += "</tr></thead><tbody>\n";
}

void HtmlTable::add(const std::vector<std::string>& cells) {
  text_ += "<tr>";
  for (const std::string& cell : cells) text_ += "<td>" + cell + "</td>";
  text_ += "</tr>\n";
}

std::string HtmlTable::text() const { return text_ + "</tbody></table></div>\n"; }

}  // namespace penumbra
