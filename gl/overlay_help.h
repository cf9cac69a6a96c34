// What lies over the picture: the help, and the banner while nothing comes in.
#pragma once

#include <imgui.h>

#include "gl/view_model.h"

namespace penumbra {

/// All keys and what the mouse does, in the middle of what is free (from the window's left upper corner, in
/// ImGui's units) if it fits there, else of the window; `settings.help` goes when it is closed.
void draw_help(DisplaySettings& settings, const ImVec2& free);

/// The state of the connection, in the middle of the upper edge of the area (in ImGui's units), unless it is
/// there and well.
void draw_banner(const ViewStatus& status, const ImVec2& corner, const ImVec2& size);

/// The colour of a state.
ImVec4 connection_color(const ViewStatus& status);

}  // namespace penumbra
