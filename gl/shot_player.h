// Plays the image files of a shot, and follows them while they are rendered.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "gl/frame_cache.h"
#include "gl/shot_listing.h"
#include "gl/view_model.h"
#include "scheduler/render/frame_files.h"

namespace penumbra {

/// Memory for pictures that have been read.
constexpr std::size_t kShotBytes = std::size_t(1) << 30;
/// How often the folder is looked at.
constexpr std::chrono::milliseconds kBetweenFolderLooks{1000};

struct ShotOptions {
  std::optional<int> first = {};   ///< the frame that is shown first; else the first that is there
  std::optional<double> fps = {};  ///< else that of the files, else 24
  std::size_t most_bytes = kShotBytes;
  /// How a frame's file is read; the layers are those of FrameWish and set_layers.
  std::function<FramePicture(const std::filesystem::path&, const std::vector<std::string>& layers,
                             bool whole)>
      read = {};
};

class ShotPlayer {
 public:
  using Clock = std::chrono::steady_clock;

  /// Looks at the folder once before it returns. `wake` is called on other threads when update() has news.
  ShotPlayer(FrameFiles files, const ShotOptions& options, std::function<void()> wake);
  ~ShotPlayer();

  /// Moves on to `now` and takes what has been read. Returns the picture to show, if it is another one than
  /// that of the last time.
  std::shared_ptr<const FramePicture> update(Clock::time_point now);
  /// Whether status() has changed since the last call.
  bool take_change() { return std::exchange(changed_, false); }
  /// Until the next frame while it plays; nothing if only news matter.
  [[nodiscard]] std::optional<double> seconds_to_next(Clock::time_point now) const;

  void play(bool plays, Clock::time_point now);
  /// Stops at that frame, which need not have a file.
  void go_to(int number);
  /// Stops, and moves by so many frames of the list.
  void step(int by);
  void go_to_first();
  void go_to_last();
  /// The layers that pictures have while the shot plays; where it stands they have all.
  void set_layers(std::vector<std::string> layers);
  /// Reads everything again.
  void reload();

  [[nodiscard]] const ShotStatus& status() const { return status_; }
  [[nodiscard]] std::filesystem::path file(int frame) const { return files_.file(frame); }

 private:
  /// `last`: what it has seen before.
  void look(const std::stop_token& stop, std::vector<ListedFrame> last);
  bool take_listing();
  [[nodiscard]] std::shared_ptr<const FramePicture> play_on(Clock::time_point now);
  [[nodiscard]] std::shared_ptr<const FramePicture> stand();
  [[nodiscard]] std::shared_ptr<const FramePicture> show(int frame, std::shared_ptr<const FramePicture> read);
  /// Seconds since it plays, in frames.
  [[nodiscard]] double frames_played(Clock::time_point now) const;
  /// The frame at which it stands in time while it plays, whether it has a file or not.
  [[nodiscard]] int number_at(Clock::time_point now) const;
  /// Numbers from the first frame to that after the last.
  [[nodiscard]] int span() const;
  /// The index of the last frame with a file up to that number, or of the first; nothing if none has.
  [[nodiscard]] std::optional<std::size_t> with_file_up_to(int number) const;
  [[nodiscard]] std::size_t index_of_current() const;
  void want_from(std::size_t index);
  void want_around();
  void note_read();

  const FrameFiles files_;
  const std::function<void()> wake_;
  ShotStatus status_;
  std::optional<double> given_fps_;
  std::vector<ListedFrame> listing_;
  std::shared_ptr<const FramePicture> shown_;
  bool changed_ = true;
  Clock::time_point began_{};  // of playing, with the frame below
  int began_at_ = 0;
  Clock::time_point second_began_{};
  int shown_this_second_ = 0;

  std::mutex mutex_;  // protects what follows
  std::condition_variable_any look_now_;
  bool wants_look_ = false;
  std::optional<std::vector<ListedFrame>> new_listing_;
  std::vector<std::string> layers_{std::string(kImageLayer)};

  FrameCache cache_;
  std::jthread looker_;
};

/// Reads a file for a ShotPlayer.
FramePicture read_frame(const std::filesystem::path& file, const std::vector<std::string>& layers,
                        bool whole);

}  // namespace penumbra
