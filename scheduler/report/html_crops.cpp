#include <fmt/format.h>

#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"
#include "scheduler/image/metrics/color_map.h"
#include "scheduler/image/tone_map.h"
#include "scheduler/report/html.h"

namespace penumbra {
namespace {

/// The colours of the error maps from 0 to 1 as a CSS gradient.
std::string ramp_html() {
  constexpr int kSteps = 8;
  std::string stops;
  for (int i = 0; i <= kSteps; ++i) {
    const auto color = heat_color(double(i) / kSteps);
    stops += fmt::format(",#{:02x}{:02x}{:02x}", display_byte(color[0]), display_byte(color[1]),
                         display_byte(color[2]));
  }
  return fmt::format("<span class=\"ramp\" style=\"background:linear-gradient(to right{})\"></span>", stops);
}

std::string overview_html(const CropSet& crops) {
  const auto percent = [](int part, int whole) { return 100.0 * part / whole; };
  return fmt::format(
      "<figure><div class=\"overview\"><img alt=\"reference, whole image\" src=\"{}\"><div class=\"frame\" "
      "style=\"left:{:.2f}%;top:{:.2f}%;width:{:.2f}%;height:{:.2f}%\"></div></div>"
      "<figcaption>whole image</figcaption></figure>\n",
      png_uri(crops.overview_png), percent(crops.x - crops.film_x, crops.overview_width),
      percent(crops.y - crops.film_y, crops.overview_height), percent(crops.width, crops.overview_width),
      percent(crops.height, crops.overview_height));
}

std::string picture_html(const CropPicture& picture) {
  const std::string spp = picture.spp > 0 ? fmt::format(", {} spp", picture.spp) : "";
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"{1}\"><img alt=\"error of {0}\" "
      "src=\"{2}\"><figcaption><b>{0}</b><br>{3}{4}<br>"
      "relMSE {5}, MSE {6}<br>whole image: relMSE {7}{8}</figcaption></figure>\n",
      html_escaped(picture.label), png_uri(picture.png), png_uri(picture.heat_png),
      seconds_text(picture.seconds), spp, number_text(picture.relmse), number_text(picture.mse),
      number_text(picture.image_relmse), picture.flip ? fmt::format(", FLIP {:.3f}", *picture.flip) : "");
}

}  // namespace

std::string scene_crops_html(const SceneReport& scene) {
  if (!scene.crops) return {};
  const CropSet& crops = *scene.crops;
  std::string html = fmt::format(
      "<h3>At equal time: {}</h3>\n<p>Each method's image nearest to that time; pixels {},{} to {},{}, {}{}. "
      "Below "
      "each, its relative squared error per pixel: 0{}{} and more.</p>\n<div class=\"crops\">\n",
      seconds_text(crops.seconds), crops.x, crops.y, crops.x + crops.width, crops.y + crops.height,
      crops.why_here, crops.exposure != 0 ? fmt::format("; exposure {:+g} stops", crops.exposure) : "",
      ramp_html(), number_text(crops.heat_high));
  html += overview_html(crops);
  html += fmt::format(
      "<figure><img alt=\"reference\" src=\"{}\"><figcaption><b>reference</b></figcaption></figure>\n",
      png_uri(crops.reference_png));
  for (const CropPicture& picture : crops.pictures) html += picture_html(picture);
  return html + "</div>\n";
}

}  // namespace penumbra
