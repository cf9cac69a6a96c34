// Layers of images as planes, and back.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scheduler/denoise/denoise.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// The channels of a layer: those whose name ends in "LAYER.C" for each of the letters, whatever case, and
/// whatever stands before a dot. Empty: there is no such layer.
std::vector<std::size_t> find_layer(const Image& image, std::initializer_list<std::string_view> layers,
                                    std::initializer_list<std::string_view> letters);

/// The channels as planes, as they are.
Planes planes_of(const Image& image, std::span<const std::size_t> channels);

/// The same; zeros in `count` planes without channels.
Planes planes_of_layer(const Image& image, std::span<const std::size_t> channels, int count);

/// The image with more channels at the end, before those that are exact.
Image with_channels(const Image& image, std::span<const std::string> names, const Planes& values);

/// Overwrites the channels.
void set_channels(Image& image, std::span<const std::size_t> channels, const Planes& values);

}  // namespace penumbra
