// The strip below the picture with the frames of a shot.
#pragma once

#include <imgui.h>

#include <optional>

#include "gl/overlay.h"

namespace penumbra {

/// In ImGui units; 0 where there is no shot, or no room.
float strip_height(const ViewStatus& status);

/// Draws the strip at the lower edge, so wide. Adds what the user requested to `result`: a frame, or to play.
void draw_strip(const ViewStatus& status, float width, OverlayResult& result);

}  // namespace penumbra
