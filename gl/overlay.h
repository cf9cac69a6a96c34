// The panel beside the picture, the help over it and the banner that says when nothing comes in.
#pragma once

#include <vector>

#include "gl/actions.h"
#include "gl/tile_outlines.h"
#include "gl/view_model.h"

namespace penumbra {

/// What the person asked for with the mouse. What needs nothing but the settings (layer, exposure, tone map,
/// outlines, automatic, panel, help) is in the settings already.
struct OverlayResult {
  std::vector<Action> actions;  ///< kOneMoreSample, kReload, kSave, kResetCamera
  bool alpha_changed = false;   ///< settings.alpha, since the last frame
  bool quit = false;
  PixelRectangle picture_area;  ///< pixels of the framebuffer that the panel leaves to the picture
};

/// Between Window::begin_frame and Window::end_frame. The panel is as high as the window, on its right; where
/// that would leave less than two fifths to the picture, it lies over it.
OverlayResult draw_overlay(DisplaySettings& settings, const ViewStatus& status);

}  // namespace penumbra
