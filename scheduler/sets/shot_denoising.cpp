#include "scheduler/sets/shot_denoising.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "kernels/host/console.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/run/render_outputs.h"

namespace penumbra {

ShotDenoising::ShotDenoising(const SetPlan& plan, int time_radius)
    : time_radius_(time_radius), frames_(plan.members.size()) {
  if (time_radius == 0) return;
  for (const SetShot& shot : plan.shots) {
    std::vector<std::size_t> members;
    for (const auto& [number, member] : shot.frames) {
      const OutputFiles& files = plan.members[member].files;
      if (!files.exr || !files.denoised_exr) continue;
      frames_[member] =
          Frame{.shot = shots_.size(), .index = members.size(), .number = number, .files = files};
      members.push_back(member);
    }
    if (!members.empty()) shots_.push_back(std::move(members));
  }
  denoisers_.resize(shots_.size());
}

void ShotDenoising::ended(std::size_t member, const std::optional<Film>& film) {
  std::optional<Frame>& frame = frames_[member];
  if (!frame) return;
  frame->is_over = true;
  frame->film = film;
}

std::vector<const ShotDenoising::Frame*> ShotDenoising::around(const Frame& frame) const {
  const std::vector<std::size_t>& members = shots_[frame.shot];
  const auto radius = std::size_t(time_radius_);
  std::vector<const Frame*> found;
  for (std::size_t i = frame.index - std::min(frame.index, radius);
       i < members.size() && i <= frame.index + radius; ++i)
    if (const Frame& other = *frames_[members[i]]; std::abs(other.number - frame.number) <= time_radius_)
      found.push_back(&other);
  return found;
}

std::vector<int> ShotDenoising::numbers_beside(std::size_t member) const {
  std::vector<int> numbers;
  for (const Frame* frame : around(*frames_[member]))
    if (frame->number != frames_[member]->number) numbers.push_back(frame->number);
  return numbers;
}

bool ShotDenoising::is_ready(const Frame& frame) const {
  return frame.film && !frame.is_denoised && std::ranges::all_of(around(frame), &Frame::is_over);
}

std::size_t ShotDenoising::left() const {
  return std::size_t(std::ranges::count_if(
      frames_, [](const auto& frame) { return frame && frame->film && !frame->is_denoised; }));
}

bool ShotDenoising::denoise() {
  bool good = true;
  for (const auto& members : shots_)
    for (const std::size_t member : members)
      if (Frame& frame = *frames_[member]; is_ready(frame)) {
        frame.is_denoised = true;
        good = denoise(frame) && good;
      }
  return good;
}

bool ShotDenoising::denoise(const Frame& frame) {
  const std::vector<std::size_t>& members = shots_[frame.shot];
  std::optional<ShotDenoiser>& denoiser = denoisers_[frame.shot];
  if (!denoiser) {
    std::vector<NoisyFrame> frames;
    for (const std::size_t member : members) {
      const OutputFiles& files = frames_[member]->files;
      frames.push_back(
          {frames_[member]->number, *files.exr, *files.denoised_exr, files.denoised_png.value_or("")});
    }
    denoiser.emplace(std::move(frames), denoise_options(*frame.film), time_radius_);
  }
  for (const Frame* other : around(frame))
    if (!other->film) denoiser->leave_out(other->index);
  const auto written = write_denoised_frame(denoiser->denoise(frame.index), *frame.film, frame.files);
  if (!written) print_error(written.error());
  return written.has_value();
}

Expected<void> write_denoised_frame(const FrameOutcome& outcome, const Film& film, const OutputFiles& files) {
  for (const std::string& remark : outcome.remarks)
    print_warning(fmt::format("{}: {}", files.denoised_exr->string(), remark));
  if (outcome.kind == FrameOutcome::Kind::kKept) return {};
  if (outcome.kind == FrameOutcome::Kind::kFailed) return fail(outcome.error);
  OutputBatch batch;
  // In this order: where the EXR is up to date, the PNG is, too.
  add_images(outcome.image, film, {}, files.denoised_png, batch);
  add_images(outcome.image, film, files.denoised_exr, {}, batch);
  return batch.finish();
}

}  // namespace penumbra
