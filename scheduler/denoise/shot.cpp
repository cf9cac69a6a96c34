#include "scheduler/denoise/shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "kernels/host/parallel.h"

namespace penumbra {
namespace {

/// Whether the file is what denoising the image with these options gives, blended or not. It is so only for
/// images whose film is known by its hash.
bool is_denoised_of(const Image& denoised, const Image& noisy, const DenoiseOptions& options) {
  const std::string hash = metadata_text(noisy, kFilmHash);
  return !hash.empty() && metadata_text(denoised, kFilmHash) == hash &&
         metadata_text(denoised, kDenoisedBy) == denoiser_name(options);
}

/// Why an image cannot be beside another; empty: it can.
std::string problem_beside(const Expected<FrameInTime>& frame, const Image& own) {
  if (!frame) return frame.error().message;
  const Image& image = frame->image;
  if (image.data != own.data)
    return fmt::format("it has {} x {} pixels, not {} x {}", image.data.width, image.data.height,
                       own.data.width, own.data.height);
  const std::string lacks = lacks_for_time(image);
  return lacks.empty() ? "" : "it lacks " + lacks;
}

/// What denoising gives: the noisy image with R, G, B and error of its blend with other frames.
Image with_own_layers(Image denoised, const Image& noisy) {
  const auto rgb = noisy.beauty_channels();
  std::vector<std::pair<std::size_t, std::size_t>> channels;  // of both
  for (std::size_t k = 0; k < noisy.channels.size(); ++k) {
    if (rgb && std::ranges::find(*rgb, k) != rgb->end()) continue;
    auto channel = denoised.channel(noisy.channels[k]);
    if (!channel) channel = denoised.channel("noisy_" + noisy.channels[k]);
    if (channel) channels.emplace_back(k, *channel);
  }
  for (std::size_t i = 0; i < noisy.pixels(); ++i)
    for (const auto& [from, to] : channels)
      denoised.values[i * denoised.channels.size() + to] = noisy.values[i * noisy.channels.size() + from];
  return denoised;
}

}  // namespace

ShotDenoiser::ShotDenoiser(std::vector<NoisyFrame> frames, DenoiseOptions options, int time_radius)
    : frames_(std::move(frames)), options_(std::move(options)), time_radius_(time_radius) {}

std::vector<std::size_t> ShotDenoiser::beside(std::size_t index, int direction) const {
  std::vector<std::size_t> found;
  for (int k = 1; k <= time_radius_; ++k) {
    const std::size_t other = index + std::size_t(k * direction);  // wraps around before the first
    if (other >= frames_.size() || frames_[other].number != frames_[index].number + k * direction ||
        frames_[other].noisy.empty())
      break;
    found.push_back(other);
  }
  return found;
}

bool ShotDenoiser::is_up_to_date(std::size_t index) const {
  const auto denoised = read_image_header(frames_[index].denoised);
  const auto noisy = read_image_header(frames_[index].noisy);
  if (!denoised || !noisy || !is_denoised_of(*denoised, *noisy, options_)) return false;
  std::error_code ignored;
  if (const auto& picture = frames_[index].picture;
      !picture.empty() && !std::filesystem::exists(picture, ignored))
    return false;
  const bool is_by_itself = !lacks_for_time(*noisy).empty();
  for (const auto& [name, direction] : {std::pair(kFramesBefore, -1), {kFramesAfter, 1}}) {
    std::vector<Image> headers;
    std::vector<const Image*> images;
    for (const std::size_t other : is_by_itself ? std::vector<std::size_t>() : beside(index, direction)) {
      auto header = read_image_header(frames_[other].noisy);
      if (!header) return false;
      headers.push_back(std::move(*header));
    }
    for (const Image& header : headers) images.push_back(&header);
    if (metadata_text(*denoised, name) != hashes_of(images)) return false;
  }
  return true;
}

const Expected<FrameInTime>& ShotDenoiser::frame(std::size_t index) {
  const auto found = images_.find(index);
  if (found != images_.end()) return found->second;
  const auto made = [&]() -> Expected<FrameInTime> {
    auto noisy = read_image(frames_[index].noisy);
    if (!noisy) return std::unexpected(noisy.error());
    if (time_radius_ == 0 || !lacks_for_time(*noisy).empty()) return FrameInTime{.image = std::move(*noisy)};
    return frame_in_time(std::move(*noisy));
  };
  return images_.emplace(index, made()).first->second;
}

FrameOutcome ShotDenoiser::denoise(std::size_t index) {
  const auto fails = [](std::string text) {
    return FrameOutcome{.kind = FrameOutcome::Kind::kFailed, .error = std::move(text)};
  };
  if (is_up_to_date(index)) return {.kind = FrameOutcome::Kind::kKept};
  std::erase_if(images_, [&](const auto& entry) {
    return std::abs(frames_[entry.first].number - frames_[index].number) > time_radius_;
  });
  const Expected<FrameInTime>& own = frame(index);
  if (!own) return fails(own.error().message);
  const std::string lacks = time_radius_ > 0 ? lacks_for_time(own->image) : "";
  FrameOutcome outcome;
  FramesBeside beside;
  if (lacks.empty()) beside = frames_beside(index, *own, outcome.remarks);
  const bool is_alone = beside.before.empty() && beside.after.empty();
  const std::size_t threads =
      options_.device.threads > 0 ? std::size_t(options_.device.threads) : core_count();
  const auto denoised =
      denoise_image(is_alone ? own->image : blended_in_time(*own, beside, threads), options_);
  if (!denoised) return fails(fmt::format("{}: {}", frames_[index].noisy.string(), denoised.error().message));
  outcome.image = with_own_layers(denoised->image, own->image);
  outcome.remarks.insert(outcome.remarks.begin(), denoised->remarks.begin(), denoised->remarks.end());
  if (!lacks.empty()) outcome.remarks.push_back("it is denoised by itself, since it lacks " + lacks);
  if (!lacks.empty() || time_radius_ == 0) return outcome;
  for (const auto& [name, frames] :
       {std::pair(kFramesBefore, &beside.before), {kFramesAfter, &beside.after}}) {
    std::vector<const Image*> images;
    for (const FrameInTime* frame : *frames) images.push_back(&frame->image);
    outcome.image.metadata.emplace_back(name, hashes_of(images));
  }
  return outcome;
}

FramesBeside ShotDenoiser::frames_beside(std::size_t index, const FrameInTime& own,
                                         std::vector<std::string>& remarks) {
  FramesBeside found;
  for (const auto& [direction, side] : {std::pair(-1, &found.before), {1, &found.after}})
    for (const std::size_t other : beside(index, direction)) {
      const Expected<FrameInTime>& next = frame(other);
      const std::string problem = problem_beside(next, own.image);
      if (!problem.empty()) {
        remarks.push_back(fmt::format("without frame {}: {}", frames_[other].number, problem));
        break;  // points are followed from frame to frame
      }
      side->push_back(&*next);
    }
  return found;
}

}  // namespace penumbra
