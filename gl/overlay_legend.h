// The colour scale of the layer that is shown.
#pragma once

#include "gl/view_model.h"

namespace penumbra {

/// For the difference and the standard error; nothing for other layers. Requires a frame of ImGui.
void draw_legend(const DisplaySettings& settings);

}  // namespace penumbra
