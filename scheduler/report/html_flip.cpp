#include <fmt/format.h>

#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"
#include "scheduler/report/html.h"

namespace penumbra {
namespace {

/// Makes a viewer of each .flip: shows one image of the stage, with a button for each.
constexpr const char* kScript = R"js(<script>
for (const viewer of document.querySelectorAll(".flip")) {
  const stage = viewer.querySelector(".stage"), images = [...stage.querySelectorAll("img")];
  const choices = viewer.querySelector(".choices");
  let shown = 0;
  const show = i => {
    shown = (i + images.length) % images.length;
    images.forEach((image, k) => image.classList.toggle("shown", k === shown));
    [...choices.children].forEach((button, k) => button.setAttribute("aria-pressed", k === shown));
  };
  images.forEach((image, i) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = (i < 9 ? i + 1 + " " : "") + image.alt;
    button.addEventListener("click", () => show(i));
    choices.append(button);
  });
  stage.addEventListener("click", () => show(shown + 1));
  viewer.addEventListener("keydown", event => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const digit = parseInt(event.key);
    if (event.key === "ArrowRight") show(shown + 1);
    else if (event.key === "ArrowLeft") show(shown - 1);
    else if (digit >= 1 && digit <= images.length) show(digit - 1);
    else return;
    event.preventDefault();
  });
  stage.tabIndex = 0;
  viewer.classList.add("on");
  show(0);
}
</script>
)js";

std::string frame_html(const CropSet& crops) {
  const auto percent = [](int part, int whole) { return 100.0 * part / whole; };
  return fmt::format(
      "<div class=\"frame\" style=\"left:{:.2f}%;top:{:.2f}%;width:{:.2f}%;height:{:.2f}%\"></div>",
      percent(crops.x - crops.film_x, crops.overview_width),
      percent(crops.y - crops.film_y, crops.overview_height), percent(crops.width, crops.overview_width),
      percent(crops.height, crops.overview_height));
}

}  // namespace

std::string flip_html(const CropSet& crops) {
  const auto image = [&](const std::string& label, const std::vector<std::uint8_t>& png) {
    return fmt::format("<img alt=\"{}\" width=\"{}\" height=\"{}\" src=\"{}\">\n", html_escaped(label),
                       crops.overview_width, crops.overview_height, png_uri(png));
  };
  std::string html =
      "<h3>Whole images</h3>\n<p>Click the image, or press ← → or its number, to switch between the images "
      "in "
      "place.</p>\n<div class=\"flip\"><div class=\"choices\"></div>\n<div class=\"stage\" role=\"group\" "
      "aria-label=\"Whole images of reference and methods\">\n";
  html += image("reference", crops.overview_png);
  for (const CropPicture& picture : crops.pictures) html += image(picture.label, picture.whole_png);
  return html + frame_html(crops) + "</div></div>\n";
}

std::string flip_script() { return kScript; }

}  // namespace penumbra
