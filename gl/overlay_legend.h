// The colour scale of the layer that is shown.
#pragma once

#include "gl/shown_as.h"

namespace penumbra {

/// For colour maps and differences; nothing for other layers. Requires a frame of ImGui.
void draw_legend(const DisplaySettings& settings, const ShownAs& shown);

}  // namespace penumbra
