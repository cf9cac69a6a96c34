// Reads pbrt's transform directives.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scenes/pbrt/tokens.h"
#include "scenes/reader_report.h"

namespace penumbra::pbrt {

/// Reads `count` numbers, with or without brackets. Nothing, and an error, if there is another number of
/// them.
std::optional<std::vector<double>> read_numbers(std::size_t count, TokenReader& tokens, ReaderReport& report);

/// The transform of a Translate, Scale, Rotate, LookAt, Transform or ConcatTransform directive, from the
/// numbers after it. Nothing, and an error, if they are not valid.
std::optional<glm::dmat4> read_transform(const Token& directive, TokenReader& tokens, ReaderReport& report);

}  // namespace penumbra::pbrt
