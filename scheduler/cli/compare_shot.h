// `penumbra compare` of the frames of shots.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/compare.h"
#include "scheduler/render/frame_files.h"

namespace penumbra {

/// What is measured of one frame.
struct FrameError {
  int frame = 0;
  std::string error;  ///< why nothing is known; then all others are nothing
  std::optional<double> relative_mse, flip;
  std::optional<double> flicker;  ///< from the frame before to this one
  std::string no_flicker;         ///< why it is not known, though the frame before is there
};

/// The frames of both shots, ascending: what is in only one of them has an error. At most two frames of each
/// are in memory. `check` is called for each comparison with the name of the image.
std::vector<FrameError> compare_shots(
    const FrameFiles& images, const FrameFiles& reference, const CompareOptions& options,
    const std::function<void(const std::string& image, const Comparison&)>& check);

/// A line for each frame and one of means.
std::string shot_text(const std::vector<FrameError>& frames);
nlohmann::ordered_json shot_json(const std::vector<FrameError>& frames);

/// Draws the errors over the frames: NAME.svg, NAME.png, and NAME.gp for gnuplot. Errors: gnuplot's.
Expected<void> plot_shot(const std::vector<FrameError>& frames, const std::string& name);

}  // namespace penumbra
