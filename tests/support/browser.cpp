#include "tests/support/browser.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <sstream>

#include "scheduler/files/run_program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// Runs in the page; tells its parent.
constexpr const char* kTellMeasures = R"js(<script>
window.addEventListener("load", () => {
  const result = (MEASURE)();
  result.script = (SCRIPT);
  parent.postMessage(JSON.stringify(result), "*");
});
</script>
)js";

std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool code = text[i] == '%' && i + 2 < text.size();
    out += code ? char(std::stoi(text.substr(i + 1, 2), nullptr, 16)) : text[i];
    if (code) i += 2;
  }
  return out;
}

}  // namespace

const char* const kMeasurePage = R"js(() => {
  for (const details of document.querySelectorAll("details")) details.open = true;
  const result = {viewport: innerWidth, scroll_width: document.documentElement.scrollWidth, texts: 0, svg_texts: 0,
    contrast: {ratio: 21, text: ""}, svg_font: {size: 1e9, text: ""}, cut_off: []};
  const rgba = color => { const v = color.match(/[\d.]+/g).map(Number); return v.length < 4 ? [...v, 1] : v; };
  const luminance = color => color.slice(0, 3).map(v => v / 255)
    .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const background = element => {
    for (let e = element; e; e = e.parentElement) {
      const color = rgba(getComputedStyle(e).backgroundColor);
      if (color[3] > 0) return color;
    }
    return [255, 255, 255, 1];
  };
  const scrolls = element => {
    for (let e = element; e; e = e.parentElement)
      if (e !== document.body && e !== document.documentElement && getComputedStyle(e).overflowX === "auto") return true;
    return false;
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement, text = node.textContent.trim(), svg = parent.closest("svg");
    if (!text || ["SCRIPT", "STYLE", "title", "desc"].includes(parent.tagName)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    const boxes = [...range.getClientRects()];
    if (!boxes.length) continue;
    ++result.texts;
    const style = getComputedStyle(parent);
    const front = luminance(rgba(svg ? style.fill : style.color)), back = luminance(background(svg ? svg : parent));
    const ratio = (Math.max(front, back) + 0.05) / (Math.min(front, back) + 0.05);
    if (ratio < result.contrast.ratio) result.contrast = {ratio, text};
    const outer = svg ? svg.getBoundingClientRect() : {left: 0, right: innerWidth, top: -1e9, bottom: 1e9};
    if (boxes.some(b => b.left < outer.left - 1 || b.right > outer.right + 1 || b.top < outer.top - 1 ||
                        b.bottom > outer.bottom + 1) && (svg || !scrolls(parent)))
      result.cut_off.push(text);
    if (!svg) continue;
    ++result.svg_texts;
    const scale = parent.getScreenCTM(), size = parseFloat(style.fontSize) * Math.hypot(scale.c, scale.d);
    if (size < result.svg_font.size) result.svg_font = {size, text};
  }
  return result;
})js";

std::optional<fs::path> find_browser() {
  const char* path = std::getenv("PATH");
  std::stringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
      const fs::path program = fs::path(folder) / name;
      if (access(program.c_str(), X_OK) == 0) return program;
    }
  return std::nullopt;
}

Expected<nlohmann::json> view_page(const std::string& html, const PageView& view) {
  const auto browser = find_browser();
  if (!browser) return fail(kNoBrowser);
  const TemporaryFolder folder;
  std::string measure = kTellMeasures, page = html;
  measure.replace(measure.find("SCRIPT)"), 6, view.script);
  measure.replace(measure.find("MEASURE)"), 7, kMeasurePage);
  page.insert(page.rfind("</body>"), measure);
  write_text(folder / "page.html", page);
  // The browser's own window cannot be as narrow as a phone, a frame can.
  write_text(
      folder / "frame.html",
      fmt::format("<!doctype html><iframe src=\"page.html\" width=\"{}\" height=\"2000\" "
                  "style=\"border:0\"></iframe><pre></pre><script>addEventListener('message', event => "
                  "document.querySelector('pre').textContent = encodeURIComponent(event.data))</script>",
                  view.width));
  // Its complaints about services that it does not find are of no interest.
  const auto end =
      run_program("/bin/sh",
                  {"-c", "exec \"$0\" \"$@\" 2>/dev/null", browser->string(), "--headless", "--no-sandbox",
                   "--disable-gpu", "--no-first-run", "--hide-scrollbars",
                   fmt::format("--user-data-dir={}", (folder / "profile").string()),
                   fmt::format("--window-size={},2000", std::max(600, view.width + 40)),
                   fmt::format("--blink-settings=preferredColorScheme={}", view.dark ? 0 : 1),
                   "--virtual-time-budget=20000", "--dump-dom", "file://" + (folder / "frame.html").string()},
                  {.folder = folder.path(), .limit = std::chrono::seconds(100)});
  if (!end) return std::unexpected(end.error());
  const std::size_t begin = end->output.find("<pre>"), stop = end->output.find("</pre>");
  if (begin == std::string::npos || stop == std::string::npos || stop == begin + 5)
    return fail("the browser has measured nothing: " + end->output.substr(0, 2000));
  return nlohmann::json::parse(unescaped(end->output.substr(begin + 5, stop - begin - 5)));
}

}  // namespace penumbra
