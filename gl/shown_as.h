// How numbers of the picture become colours, and the range of the colour map; for the picture and its legend.
#pragma once

#include "gl/picture_layers.h"
#include "gl/view_model.h"

namespace penumbra {

/// kColor: by exposure and tone map. kSigned: 0 is mid grey. kHeat: log10 of the luminance by a colour map.
/// kNormal: 0.5 + 0.5 n. kIdentity: a colour for each value.
enum class Display { kColor, kSigned, kHeat, kNormal, kIdentity };

struct ShownAs {
  Display display = Display::kColor;
  bool over_brightness = false;         ///< kHeat: of the value over the brightness of the pixel
  bool is_share = false;                ///< kHeat: values are relative
  float log10_low = 0, log10_high = 1;  ///< kHeat: the ends of the colour map
};

/// `named`: the layer of Layer::kNamed, else null.
///   relative errors: 0.001 to 1
///   absolute errors: 0.0001 to 1 of the radiance that is white at this exposure
///   quantities: their own range
///   false colour: a thousandth to a hundred times the radiance that is white
ShownAs shown_as(const DisplaySettings& settings, const PictureLayer* named);

}  // namespace penumbra
