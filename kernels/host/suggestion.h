// What a misspelt name was meant to be.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace penumbra {

/// The candidate with the fewest edits (insertions, deletions, replacements, swaps of neighbours; case
/// ignored) to `name`, if it is near enough to be a likely misspelling.
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> candidates);

/// "; did you mean 'x'?" or nothing.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

}  // namespace penumbra
