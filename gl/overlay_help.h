// Overlays on the picture: the help, and the banner while the connection is missing or broken.
#pragma once

#include <imgui.h>

#include "gl/view_model.h"

namespace penumbra {

/// Draws all keys and mouse actions, in the middle of the free area if they fit there (its size is `free`,
/// from the window's upper left corner in ImGui units), else of the window. Closing it clears
/// `settings.help`. The text gets smaller until it fits into the window; returns whether it has just got so,
/// and another frame is needed.
bool draw_help(DisplaySettings& settings, const ImVec2& free);

/// Draws the connection's state at the middle of the area's upper edge (in ImGui units), unless the
/// connection is good.
void draw_banner(const ViewStatus& status, const ImVec2& corner, const ImVec2& size);

/// The colour of a connection's state.
ImVec4 connection_color(const ViewStatus& status);

}  // namespace penumbra
