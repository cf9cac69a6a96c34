// pbrt's directives of transforms.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scenes/pbrt/tokens.h"
#include "scenes/reader_report.h"

namespace penumbra::pbrt {

/// That many numbers, in brackets or without; nothing, and an error, where there are others.
std::optional<std::vector<double>> read_numbers(std::size_t count, TokenReader& tokens, ReaderReport& report);

/// What Translate, Scale, Rotate, LookAt, Transform or ConcatTransform says, by the numbers that follow it;
/// nothing, and an error, where that is no transform.
std::optional<glm::dmat4> read_transform(const Token& directive, TokenReader& tokens, ReaderReport& report);

}  // namespace penumbra::pbrt
