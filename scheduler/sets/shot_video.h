// The video of a shot, which the program ffmpeg makes.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/image/contact_sheet.h"

namespace penumbra {

/// The program in PATH. Error: it is not there; the message says how to install it.
Expected<std::filesystem::path> find_ffmpeg();

/// What became of the frames of a video.
struct VideoEnd {
  std::size_t held = 0;  ///< frames without a picture, for which another is shown
  std::string text;      ///< for users: frames, rate, and which have no picture
};

/// `fps` over the smallest step between frames, so that a video of every second frame runs at the same speed.
double video_rate(std::span<const SheetFrame> frames, double fps);

/// Writes the pictures in their order as H.264 (yuv420p, Rec. 709, crf 18) at `rate` frames a second. Alpha
/// lies over black; odd sizes get a row or column of black. A frame without a picture shows that before, the
/// first ones that which comes. The file appears once it is complete. Errors: no frame has a picture; what
/// ffmpeg says.
Expected<VideoEnd> write_video(const std::filesystem::path& ffmpeg, std::span<const SheetFrame> frames,
                               double rate, const std::filesystem::path& file);

}  // namespace penumbra
