// Pictures for browsers: PNG files of images that are scaled down.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scheduler/image/image.h"
#include "scheduler/web/live_films.h"

namespace penumbra {

/// A PNG of the film's means as `encode_png` shows an image: clamped, sRGB. It has at most `largest_side`
/// pixels on a side; each is the mean of those that it stands for, in linear light. Where nothing is rendered
/// yet it is transparent.
Expected<std::string> picture_of_film(const LiveFilm& film, int largest_side);

/// The same of an image in a file: its beauty layer. Error: it has none.
Expected<std::string> picture_of_image(const Image& image, int largest_side);

}  // namespace penumbra
