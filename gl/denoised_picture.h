// Denoises the picture on a thread of its own, so that the window goes on meanwhile.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace penumbra {

/// Linear values of a picture, row by row from the top.
struct NoisyPicture {
  std::uint64_t view = 0;     ///< changes with the camera; a result of an older view is not shown
  std::uint64_t version = 0;  ///< changes with every sample
  int width = 0, height = 0;
  std::vector<float> values;          ///< red, green and blue
  std::vector<float> standard_error;  ///< one per pixel; NaN: unknown
};

class DenoisedPicture {
 public:
  DenoisedPicture();
  ~DenoisedPicture();

  /// Whether a picture of that version would be taken: nothing is being denoised, and it is a new one.
  [[nodiscard]] bool wants(std::uint64_t view, std::uint64_t version) const;
  void submit(NoisyPicture picture);
  /// The newest denoised values of the view; empty if there are none.
  [[nodiscard]] std::span<const float> values(std::uint64_t view);
  /// Whether values() are those of that version.
  [[nodiscard]] bool shows(std::uint64_t view, std::uint64_t version) const;
  /// Whether there is a result that values() has not returned yet.
  [[nodiscard]] bool has_news() const { return has_news_; }
  /// Why the last picture could not be denoised; empty: it could.
  [[nodiscard]] std::string take_error();

 private:
  void work(const std::stop_token& stop);

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<NoisyPicture> waiting_;
  bool is_busy_ = false;
  std::uint64_t last_view_ = 0, last_version_ = 0;  // submitted
  std::uint64_t result_view_ = 0, result_version_ = 0;
  std::vector<float> result_;  // finished
  std::uint64_t shown_view_ = 0, shown_version_ = 0;
  std::vector<float> shown_;  // returned by values()
  std::string error_;
  std::atomic<bool> has_news_ = false;
  std::jthread thread_;
};

}  // namespace penumbra
