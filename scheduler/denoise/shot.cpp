#include "scheduler/denoise/shot.h"

#include <fmt/format.h>

#include <cstdlib>
#include <utility>

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
std::string problem_beside(const Expected<Image>& image, const Image& own) {
  if (!image) return image.error().message;
  if (image->data != own.data) return "it has another size";
  const std::string lacks = lacks_for_time(*image);
  return lacks.empty() ? "" : "it lacks " + lacks;
}

}  // namespace

ShotDenoiser::ShotDenoiser(std::vector<NoisyFrame> frames, DenoiseOptions options, int time_radius)
    : frames_(std::move(frames)), options_(std::move(options)), time_radius_(time_radius) {
  options_.estimates_error = true;
}

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
  for (const auto& [name, direction] : {std::pair(kFramesBefore, -1), {kFramesAfter, 1}}) {
    std::vector<Image> headers;
    std::vector<const Image*> images;
    for (const std::size_t other : beside(index, direction)) {
      auto header = read_image_header(frames_[other].noisy);
      if (!header) return false;
      headers.push_back(std::move(*header));
    }
    for (const Image& header : headers) images.push_back(&header);
    if (metadata_text(*denoised, name) != hashes_of(images)) return false;
  }
  return true;
}

ShotDenoiser::Still ShotDenoiser::make_still(const NoisyFrame& frame) const {
  const auto fails = [&](const std::string& text) -> Still {
    return {fail(fmt::format("{}: {}", frame.noisy.string(), text)), {}};
  };
  if (const auto header = read_image_header(frame.noisy), known = read_image_header(frame.denoised);
      header && known && is_denoised_of(*known, *header, options_))
    if (auto denoised = read_image(frame.denoised)) return {std::move(*denoised), {}};
  const auto noisy = read_image(frame.noisy);
  if (!noisy) return {std::unexpected(noisy.error()), {}};
  auto outcome = denoise_image(*noisy, options_);
  if (!outcome) return fails(outcome.error().message);
  return {std::move(outcome->image), std::move(outcome->remarks)};
}

const ShotDenoiser::Still& ShotDenoiser::still(std::size_t index) {
  const auto found = stills_.find(index);
  return found != stills_.end() ? found->second
                                : stills_.emplace(index, make_still(frames_[index])).first->second;
}

FrameOutcome ShotDenoiser::denoise(std::size_t index) {
  if (is_up_to_date(index)) return {.kind = FrameOutcome::Kind::kKept};
  std::erase_if(stills_, [&](const auto& entry) {
    return std::abs(frames_[entry.first].number - frames_[index].number) > time_radius_;
  });
  const Still& own = still(index);
  if (!own.image) return {.kind = FrameOutcome::Kind::kFailed, .error = own.image.error().message};
  FrameOutcome outcome{.remarks = own.remarks};
  const std::string lacks = time_radius_ > 0 ? lacks_for_time(*own.image) : "";
  if (!lacks.empty()) outcome.remarks.push_back("it is denoised by itself, since it lacks " + lacks);
  if (!lacks.empty() || time_radius_ == 0) {
    outcome.image = *own.image;
    return outcome;
  }
  FramesBeside images;
  for (const auto& [direction, side] : {std::pair(-1, &images.before), {1, &images.after}})
    for (const std::size_t other : beside(index, direction)) {
      const Still& next = still(other);
      const std::string problem = problem_beside(next.image, *own.image);
      if (!problem.empty()) {
        outcome.remarks.push_back(fmt::format("without frame {}: {}", frames_[other].number, problem));
        break;  // points are followed from frame to frame
      }
      side->push_back(&*next.image);
    }
  auto blended = blended_in_time(*own.image, images);
  if (!blended) return {.kind = FrameOutcome::Kind::kFailed, .error = blended.error().message};
  outcome.image = std::move(*blended);
  return outcome;
}

}  // namespace penumbra
