// Denoises the frames of a shot one after the other, each with the samples of those beside it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/denoise/in_time.h"

namespace penumbra {

/// A frame's image, and the one that becomes of it. An image without a name is not there.
struct NoisyFrame {
  int number = 0;
  std::filesystem::path noisy, denoised;
  std::filesystem::path picture = {};  ///< of the denoised image, if any; it is written before that
};

/// What became of a frame.
struct FrameOutcome {
  enum class Kind {
    kKept,  ///< the denoised file is there, of the same images and options
    kMade,
    kFailed
  };
  Kind kind = Kind::kMade;
  Image image = {};  ///< kMade
  std::vector<std::string> remarks = {};
  std::string error = {};  ///< kFailed
};

/// Frames beside each other have consecutive numbers: what a gap separates is not used.
class ShotDenoiser {
 public:
  /// `frames`: ascending. `time_radius`: frames on each side, at most kMostTimeRadius.
  ShotDenoiser(std::vector<NoisyFrame> frames, DenoiseOptions options, int time_radius);

  /// The outcome of frame `index`. In ascending order each image is read and prepared once, and at most
  /// 2 time_radius + 1 are in memory. It is a function of the images of the frame and those beside it,
  /// whatever came before.
  FrameOutcome denoise(std::size_t index);
  /// From now on frame `index` is beside no other.
  void leave_out(std::size_t index) { frames_[index].noisy.clear(); }

 private:
  /// The indices of the frames beside one, nearest first, in a direction of 1 or -1.
  [[nodiscard]] std::vector<std::size_t> beside(std::size_t index, int direction) const;
  [[nodiscard]] bool is_up_to_date(std::size_t index) const;
  /// An image that is read and, unless it lacks something for that, prepared.
  const Expected<FrameInTime>& frame(std::size_t index);
  /// Those that `own` can be blended with; says of others why not.
  FramesBeside frames_beside(std::size_t index, const FrameInTime& own, std::vector<std::string>& remarks);

  std::vector<NoisyFrame> frames_;
  DenoiseOptions options_;
  int time_radius_;
  std::map<std::size_t, Expected<FrameInTime>> images_;
};

}  // namespace penumbra
