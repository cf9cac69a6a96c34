// An image as a display shows it: sRGB signals, as in a PNG, instead of linear light.
#pragma once

#include "scheduler/image/image.h"

namespace penumbra {

/// The beauty layer as it is read from the PNG that `encode_png` makes of a linear image: R, G, B from 0 to 1
/// in steps of 1/255, multiplied by alpha. Values that are NaN or infinite stay so, while a PNG marks them.
/// The values of a display-referred image are rounded to those steps. Error: there is no beauty layer.
Expected<Image> display_image(const Image& image);

}  // namespace penumbra
