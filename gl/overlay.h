// The panel beside the picture, the help over it, and the banner about the connection.
#pragma once

#include <optional>
#include <vector>

#include "gl/actions.h"
#include "gl/camera_text.h"
#include "gl/shown_as.h"
#include "gl/tile_outlines.h"
#include "gl/view_model.h"

namespace penumbra {

/// What the user requested with the mouse. What only needs settings (layer, exposure, tone map, outlines,
/// automatic, panel, help) is already in the settings.
struct OverlayResult {
  std::vector<Action> actions;       ///< those that settings do not tell: kOneMoreSample, kReload, kSave, …
  std::optional<CameraFormat> copy;  ///< the view is to be copied in this form
  std::optional<int> frame;          ///< of the shot, to go to
  bool shows_histogram = false;
  bool again = false;           ///< another frame is needed: something had to be laid out to know its size
  bool alpha_changed = false;   ///< settings.alpha has changed since the last frame
  PixelRectangle picture_area;  ///< the part of the framebuffer beside the panel, in pixels
};

/// To be called between Window::begin_frame and Window::end_frame. The panel is as high as the window, on its
/// right. If the picture would get less than two fifths of the width, the panel is drawn over it.
/// `shown`: how the picture is shown, for the legend.
OverlayResult draw_overlay(DisplaySettings& settings, const ViewStatus& status, const ShownAs& shown = {});

}  // namespace penumbra
