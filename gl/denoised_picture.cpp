#include "gl/denoised_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scheduler/denoise/denoise_image.h"

namespace penumbra {
namespace {

Expected<std::vector<float>> denoised(const NoisyPicture& picture) {
  Image image;
  image.data = image.display = {0, 0, picture.width, picture.height};
  image.channels = {"R", "G", "B"};
  const bool has_variance =
      std::ranges::none_of(picture.standard_error, [](float e) { return std::isnan(e); });
  if (has_variance) image.channels.insert(image.channels.end(), {"variance.R", "variance.G", "variance.B"});
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const auto first = picture.values.begin() + std::ptrdiff_t(3 * i);
    image.values.insert(image.values.end(), first, first + 3);
    const float error = picture.standard_error[i];
    if (has_variance) image.values.insert(image.values.end(), 3, error * error);
  }
  DenoiseOptions options;
  options.method = Denoise::kNlMeans;  // the window has no layers for a better one
  options.device.threads = 0;
  options.device.isa = best_isa();
  const auto outcome = denoise_image(image, options);
  if (!outcome) return std::unexpected(outcome.error());
  std::vector<float> values;
  values.reserve(3 * image.pixels());
  const std::size_t channels = outcome->image.channels.size();
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const auto first = outcome->image.values.begin() + std::ptrdiff_t(channels * i);
    values.insert(values.end(), first, first + 3);
  }
  return values;
}

}  // namespace

DenoisedPicture::DenoisedPicture() : thread_([this](const std::stop_token& stop) { work(stop); }) {}

DenoisedPicture::~DenoisedPicture() {
  thread_.request_stop();
  changed_.notify_all();
}

bool DenoisedPicture::wants(std::uint64_t view, std::uint64_t version) const {
  const std::lock_guard lock(mutex_);
  return !is_busy_ && !waiting_ && (view != last_view_ || version != last_version_);
}

void DenoisedPicture::submit(NoisyPicture picture) {
  {
    const std::lock_guard lock(mutex_);
    last_view_ = picture.view;
    last_version_ = picture.version;
    waiting_ = std::move(picture);
  }
  changed_.notify_all();
}

std::span<const float> DenoisedPicture::values(std::uint64_t view) {
  const std::lock_guard lock(mutex_);
  if (has_news_.exchange(false)) {
    shown_ = std::move(result_);
    shown_view_ = result_view_;
    shown_version_ = result_version_;
  }
  return shown_view_ == view ? std::span<const float>(shown_) : std::span<const float>();
}

bool DenoisedPicture::shows(std::uint64_t view, std::uint64_t version) const {
  const std::lock_guard lock(mutex_);
  return shown_view_ == view && shown_version_ == version;
}

std::string DenoisedPicture::take_error() {
  const std::lock_guard lock(mutex_);
  return std::exchange(error_, {});
}

void DenoisedPicture::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    NoisyPicture picture;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [this] { return waiting_.has_value(); })) return;
      picture = *std::exchange(waiting_, {});
      is_busy_ = true;
    }
    Expected<std::vector<float>> values = fail("");
    try {
      values = denoised(picture);
    } catch (const std::exception& error) {  // usually out of memory
      values = fail(error.what());
    }
    const std::lock_guard lock(mutex_);
    is_busy_ = false;
    if (values) {
      result_ = std::move(*values);
      result_view_ = picture.view;
      result_version_ = picture.version;
      has_news_ = true;
    } else {
      error_ = values.error().message;
    }
  }
}

}  // namespace penumbra
