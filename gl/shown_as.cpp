#include "gl/shown_as.h"

#include <cmath>

namespace penumbra {
namespace {

constexpr float kLog10Of2 = 0.30102999566f;
// Decades of false colour below and above white.
constexpr float kDecadesBelow = 3, kDecadesAbove = 2;

ShownAs shown_quantity(const PictureLayer& layer) {
  ShownAs shown{.display = Display::kHeat};
  if (!(layer.least > 0)) return shown;
  shown.log10_low = std::log10(layer.least);
  shown.log10_high = std::log10(layer.most);
  // A single value is in the middle.
  if (shown.log10_high - shown.log10_low < 1e-3f) {
    shown.log10_low -= kLog10Of2;
    shown.log10_high += kLog10Of2;
  }
  return shown;
}

}  // namespace

ShownAs shown_as(const DisplaySettings& settings, const PictureLayer* named) {
  const float white = -settings.exposure * kLog10Of2;
  if (settings.comparison == ShownComparison::kDifference) return {.display = Display::kSigned};
  if (settings.comparison == ShownComparison::kRelativeError)
    return {.display = Display::kHeat, .is_share = true, .log10_low = -3, .log10_high = 0};
  if (settings.layer == Layer::kDifference) return {.display = Display::kSigned};
  if (settings.layer == Layer::kError && settings.relative_error)
    return {.display = Display::kHeat,
            .over_brightness = true,
            .is_share = true,
            .log10_low = -3,
            .log10_high = 0};
  if (settings.layer == Layer::kError)
    return {.display = Display::kHeat, .log10_low = white - 4, .log10_high = white};
  if (settings.layer == Layer::kNamed && named != nullptr) {
    if (named->kind == LayerKind::kQuantity) return shown_quantity(*named);
    if (named->kind == LayerKind::kNormal) return {.display = Display::kNormal};
    if (named->kind == LayerKind::kIdentity) return {.display = Display::kIdentity};
  }
  if (settings.false_color)
    return {
        .display = Display::kHeat, .log10_low = white - kDecadesBelow, .log10_high = white + kDecadesAbove};
  return {};
}

}  // namespace penumbra
