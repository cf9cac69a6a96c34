// Denoises the frames of a set's shots, each as soon as those beside it are there.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "scenes/scene_description.h"
#include "scheduler/denoise/shot.h"
#include "scheduler/sets/set_plan.h"

namespace penumbra {

/// Of shots whose frames write an EXR and a denoised EXR. The frames beside one are those of the set that
/// have an image.
class ShotDenoising {
 public:
  ShotDenoising(const SetPlan& plan, int time_radius);

  /// Whether a member of the plan is denoised here.
  [[nodiscard]] bool has(std::size_t member) const { return frames_[member].has_value(); }
  /// Which frames of its shot such a member is denoised with: ascending.
  [[nodiscard]] std::vector<int> numbers_beside(std::size_t member) const;
  /// The number of such a member's shot.
  [[nodiscard]] std::size_t shot_of(std::size_t member) const { return frames_[member]->shot; }
  /// A member of the plan is over. `film`: of its image; nothing where there is none.
  void ended(std::size_t member, const std::optional<Film>& film);
  /// Denoises the frames that are ready and writes them. Prints what goes wrong; returns whether nothing did.
  bool denoise();
  /// How many frames with an image are not denoised.
  [[nodiscard]] std::size_t left() const;

 private:
  struct Frame {
    std::size_t shot = 0, index = 0;  // in its shot
    int number = 0;
    OutputFiles files;
    std::optional<Film> film = {};
    bool is_over = false, is_denoised = false;
  };
  /// The frame and those within the radius. Frames are ascending, so they are that near in the shot, too.
  [[nodiscard]] std::vector<const Frame*> around(const Frame& frame) const;
  [[nodiscard]] bool is_ready(const Frame& frame) const;
  bool denoise(const Frame& frame);

  int time_radius_;
  std::vector<std::optional<Frame>> frames_;            // of members
  std::vector<std::vector<std::size_t>> shots_;         // their members, ascending
  std::vector<std::optional<ShotDenoiser>> denoisers_;  // of shots
};

/// Prints the remarks, and writes the denoised files of one that was made. Error: why there are none.
Expected<void> write_denoised_frame(const FrameOutcome& outcome, const Film& film, const OutputFiles& files);

}  // namespace penumbra
