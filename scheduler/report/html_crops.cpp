#include <fmt/format.h>

#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"
#include "scheduler/image/metrics/color_bar.h"
#include "scheduler/image/metrics/color_map.h"
#include "scheduler/image/tone_map.h"
#include "scheduler/report/html.h"

namespace penumbra {
namespace {

/// The colours of the error maps as a bar with numbers.
std::string bar_html(const CropSet& crops) {
  constexpr int kSteps = 16;
  std::string stops, numbers;
  for (int i = 0; i <= kSteps; ++i) {
    const auto color = heat_color(double(i) / kSteps);
    stops += fmt::format(",#{:02x}{:02x}{:02x}", display_byte(color[0]), display_byte(color[1]),
                         display_byte(color[2]));
  }
  constexpr int kMostNumbers = 5;
  for (const BarTick& tick : bar_ticks({crops.heat_low, crops.heat_high, true}, kMostNumbers))
    numbers += fmt::format("<span style=\"left:{:.4g}%\">{}</span>", 100 * tick.position, tick.label);
  return fmt::format(
      "<div class=\"bar\"><div class=\"ramp\" style=\"background:linear-gradient(to right{})\"></div>"
      "<div class=\"numbers\">{}</div></div>\n",
      stops, numbers);
}

/// Times within this ratio count as equal.
constexpr double kEqualTimes = 1.1;

std::string time_text(const CropPicture& picture, double common) {
  const double ratio = picture.seconds / common;
  if (!(ratio > kEqualTimes || ratio < 1 / kEqualTimes)) return seconds_text(picture.seconds);
  return fmt::format("{} ({:.2g} × that time)", seconds_text(picture.seconds), ratio);
}

bool all_equal(const CropSet& crops) {
  for (const CropPicture& picture : crops.pictures)
    if (picture.seconds > kEqualTimes * crops.seconds || picture.seconds * kEqualTimes < crops.seconds)
      return false;
  return true;
}

std::string picture_html(const CropPicture& picture, double common) {
  const std::string spp = picture.spp > 0 ? fmt::format(", {} spp", picture.spp) : "";
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"{1}\"><img alt=\"error of {0}\" "
      "src=\"{2}\"><figcaption><b>{0}</b><br>{3}{4}<br>"
      "relMSE {5}, MSE {6}<br>whole image: relMSE {7}{8}</figcaption></figure>\n",
      html_escaped(picture.label), png_uri(picture.png), png_uri(picture.heat_png),
      time_text(picture, common), spp, number_text(picture.relmse), number_text(picture.mse),
      number_text(picture.image_relmse), picture.flip ? fmt::format(", FLIP {:.3f}", *picture.flip) : "");
}

}  // namespace

std::string scene_crops_html(const SceneReport& scene) {
  if (!scene.crops) return {};
  const CropSet& crops = *scene.crops;
  const std::string title = all_equal(crops)
                                ? fmt::format("At equal time: {}", seconds_text(crops.seconds))
                                : fmt::format("Near {}, not at equal time", seconds_text(crops.seconds));
  std::string html = fmt::format(
      "<h3>{}</h3>\n<p>Each method's image nearest to that time; pixels {},{} to {},{}, {}{}. Below each, "
      "its "
      "relative squared error per pixel, on a logarithmic scale:</p>\n{}<div class=\"crops\">\n",
      title, crops.x, crops.y, crops.x + crops.width, crops.y + crops.height, crops.why_here,
      crops.exposure != 0 ? fmt::format("; exposure {:+g} stops", crops.exposure) : "", bar_html(crops));
  html += fmt::format(
      "<figure><img alt=\"reference\" src=\"{}\"><figcaption><b>reference</b></figcaption></figure>\n",
      png_uri(crops.reference_png));
  for (const CropPicture& picture : crops.pictures) html += picture_html(picture, crops.seconds);
  return html + "</div>\n" + flip_html(crops);
}

}  // namespace penumbra
