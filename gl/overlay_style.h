// The style of the panel: a font at the display's scale, and colours.
#pragma once

#include <imgui.h>

namespace penumbra {

namespace overlay_color {
inline const ImVec4 kText{0.88f, 0.89f, 0.91f, 1};
inline const ImVec4 kDim{0.55f, 0.57f, 0.62f, 1};
inline const ImVec4 kAccent{1.00f, 0.76f, 0.38f, 1};
inline const ImVec4 kGood{0.42f, 0.82f, 0.47f, 1};
inline const ImVec4 kWarning{1.00f, 0.70f, 0.25f, 1};
inline const ImVec4 kBad{1.00f, 0.42f, 0.38f, 1};
}  // namespace overlay_color

/// Sets style and font of the current ImGui context. `content_scale`: pixels per pixel of a plain display.
/// `pixels_per_coordinate`: framebuffer pixels per ImGui unit. Afterwards the font's texture must be rebuilt.
void apply_overlay_style(float content_scale, float pixels_per_coordinate);

/// ImGui units per pixel of a plain display, as last set.
float overlay_unit();

}  // namespace penumbra
