#include "scenes/image/colour_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "scenes/diagnostic.h"

namespace penumbra {

char colour_of(std::string_view channel) {
  std::string name(channel);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  for (const std::string_view colour : {"red", "green", "blue", "alpha"})
    if (name == colour || name == colour.substr(0, 1)) return char(std::toupper(colour[0]));
  return name == "y" ? 'Y' : '\0';
}

std::optional<std::size_t> index_of_colour(const std::vector<std::string>& channels, char colour) {
  auto found = std::ranges::find(channels, std::string(1, colour));
  if (found == channels.end())
    found =
        std::ranges::find_if(channels, [&](const std::string& name) { return colour_of(name) == colour; });
  return found == channels.end() ? std::nullopt : std::optional(std::size_t(found - channels.begin()));
}

bool has_colours(const std::vector<std::string>& channels) {
  const auto has = [&](char colour) { return index_of_colour(channels, colour).has_value(); };
  return channels.size() == 1 || (has('R') && has('G') && has('B')) || has('Y');
}

std::string no_colours_text(const std::vector<std::string>& channels) {
  return fmt::format("has {} channels ({}); a texture has Y, or R, G and B, each with A or without",
                     channels.size(), list_names(channels));
}

}  // namespace penumbra
