// The panel's parts about the picture: layers, tone map, comparison, histogram; and the line about the pixel
// below the mouse.
#pragma once

#include <imgui.h>

#include "gl/overlay.h"
#include "gl/shown_as.h"
#include "gl/view_model.h"

namespace penumbra {

void draw_picture_settings(DisplaySettings& settings, const ViewStatus& status, const ShownAs& shown,
                           OverlayResult& result);
void draw_comparison(DisplaySettings& settings, const ViewStatus& status, OverlayResult& result);
/// Returns whether it is shown.
bool draw_histogram(const ViewStatus& status);
/// At the lower left of the picture, whose size is `free`. Nothing without a pixel.
void draw_pixel(const ViewStatus& status, const ImVec2& free);

}  // namespace penumbra
