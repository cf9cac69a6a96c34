// Which channels of an image are its colours, by their names.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// The channels R, G, B, A or Y by one of their usual names: 'R', 'r', 'Red', in any case. Empty for all
/// others, among them those of layers ("diffuse.R").
char colour_of(std::string_view channel);

/// The index of this colour. The name of one letter comes before others.
std::optional<std::size_t> index_of_colour(const std::vector<std::string>& channels, char colour);

/// Whether a texture can be made of these channels: R, G and B, or Y, or a single channel of any name.
bool has_colours(const std::vector<std::string>& channels);

/// For an error: the channels that there are, and those that a texture has.
std::string no_colours_text(const std::vector<std::string>& channels);

}  // namespace penumbra
