// Reads the pictures of frames in the background and keeps as many as memory is given for.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "gl/picture_layers.h"

namespace penumbra {

struct FramePicture {
  LayeredPicture picture;                ///< with the layers that were asked for
  std::vector<std::string> layer_names;  ///< all of the file
  std::string integrator;
  double fps = 0;          ///< that the file tells; 0: none
  bool is_whole = false;   ///< it has all layers
  std::string error = {};  ///< why it cannot be read
  [[nodiscard]] std::size_t bytes() const;
};

struct FrameWish {
  int frame = 0;
  bool whole = false;  ///< with all layers
};

/// To be used on one thread; files are read on others.
class FrameCache {
 public:
  using Read = std::function<FramePicture(const FrameWish&)>;

  /// `news` is called on any thread when a picture has been read. Pictures take at most `most_bytes`, but for
  /// the most urgent, which is kept however large it is.
  FrameCache(Read read, std::function<void()> news, std::size_t most_bytes, int threads);
  ~FrameCache();
  FrameCache(const FrameCache&) = delete;
  FrameCache& operator=(const FrameCache&) = delete;

  /// What is to be read, the most urgent first. Replaces earlier wishes. Of the pictures that are not wished
  /// for, the longest unused go first when memory is short; what would not fit is not read.
  void want(std::vector<FrameWish> wishes);
  /// The picture, whole or not; null: it has not been read.
  [[nodiscard]] std::shared_ptr<const FramePicture> get(int frame);
  [[nodiscard]] bool has(int frame) const;
  /// All frames that have been read, ascending.
  [[nodiscard]] std::vector<int> there() const;
  /// The file has changed. Also what is being read of it now counts for nothing.
  void forget(int frame);
  void forget_all();
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Kept {
    std::shared_ptr<const FramePicture> picture;
    std::size_t bytes = 0;
    std::uint64_t used = 0;
  };
  void work(const std::stop_token& stop);
  /// The first wish that is not fulfilled, not being read and fits. The caller holds mutex_.
  [[nodiscard]] const FrameWish* next_wish() const;
  void make_room();

  const Read read_;
  const std::function<void()> news_;
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<FrameWish> wishes_;
  std::map<int, Kept> kept_;
  std::map<int, bool> being_read_;  // whether it still counts
  std::size_t bytes_ = 0;
  std::size_t usual_bytes_ = 0;  // of the largest picture without all layers
  std::uint64_t uses_ = 0;
  std::vector<std::jthread> threads_;
};

}  // namespace penumbra
