// Frames of a shot: their numbers, times, order and names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"
#include "scheduler/render/render_request.h"

namespace penumbra {

constexpr int kLastFrame = 999'999'999;

/// The frames of "300", "1-250", "1-250x2" (every second), "1..250", and lists of these with commas, in the
/// order of the text. Errors: no such text; a number above kLastFrame; a range that descends; a frame twice;
/// more than a million frames.
Expected<std::vector<std::string>> frames_of(std::string_view text);

/// The same of numbers in any order: "1-12,14-20x2", of each number once. frames_of() has the numbers of it.
std::string frames_text(std::vector<int> frames);

/// The number of frames a second: that of --fps, else kFramesPerSecond.
double frames_per_second(const SceneOptions& options);

/// The time of the frame in seconds: frame / fps, the frame after adding the offset.
double frame_seconds(const SceneOptions& options);

/// What is added to the seed for the frame: nothing unless each frame has a seed of its own.
std::uint32_t frame_in_seed(const SceneOptions& options);

/// First, last, middle, then the middles of the halves and so on: an early look at all of a shot.
std::vector<std::string> preview_order(const std::vector<std::string>& frames);

/// A name of files with the frame's field: #### becomes {frame:04}, as many digits as there are #. The last
/// run of # counts, in names of folders from two on. A name without such a field gets .{frame:04} before its
/// extension.
std::string with_frame_field(const std::string& name);

}  // namespace penumbra
