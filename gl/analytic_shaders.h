// The preprocessed shaders of the analytic pass, embedded in the binary.
#pragma once

#include <span>
#include <string_view>

#include "worker/embedded_kernels.h"

namespace penumbra {

/// Names are like "triangles.vert".
std::span<const EmbeddedFile> analytic_shaders();

/// Empty if there is no shader of that name.
std::string_view analytic_shader(std::string_view name);

}  // namespace penumbra
