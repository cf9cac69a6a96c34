#include "scheduler/sets/shot_pictures.h"

#include <algorithm>

#include "kernels/host/atomic_file.h"
#include "kernels/host/console.h"
#include "scheduler/run/output_files.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// The picture of a PNG, or the denoised one beside it; empty: there is none.
fs::path picture_at(const fs::path& png, bool is_denoised) {
  if (const fs::path denoised = denoised_name(png); is_denoised && is_file(denoised)) return denoised;
  return is_file(png) ? png : fs::path();
}

}  // namespace

std::vector<SheetFrame> frames_of_shot(const SetShot& shot, const SetPlan& plan,
                                       const std::vector<SetEntry>& entries) {
  std::vector<SheetFrame> frames;
  for (const auto& [frame, index] : shot.frames) {
    const SetMember& member = plan.members[index];
    const bool has_picture = entries[index].state != SetState::kFailed && member.files.png.has_value();
    frames.push_back({frame, has_picture
                                 ? picture_at(*member.files.png, member.files.denoised_png.has_value())
                                 : fs::path()});
  }
  return frames;
}

std::vector<SheetFrame> frames_of_all_sets(const SetShot& shot, const SetPlan& plan,
                                           const std::vector<SetEntry>& entries) {
  std::vector<SheetFrame> frames = frames_of_shot(shot, plan, entries);
  EarlierRenders others = EarlierRenders::read(plan.summary);
  for (const SetEntry& entry : entries) (void)others.take(entry.files);
  const bool is_denoised = plan.members[shot.frames.front().second].files.denoised_png.has_value();
  for (const SetEntry& other : std::move(others).rest())
    for (const fs::path file : other.files)
      if (const auto frame = shot.pictures.frame_of(file);
          frame && std::ranges::find(frames, *frame, &SheetFrame::frame) == frames.end())
        frames.push_back({*frame, picture_at(file, is_denoised)});
  std::ranges::sort(frames, {}, &SheetFrame::frame);
  return frames;
}

std::vector<std::string> write_contact_sheets(const SetPlan& plan, const std::vector<SetEntry>& entries,
                                              bool& failed) {
  std::vector<std::string> written;
  for (const SetShot& shot : plan.shots) {
    if (shot.sheet.empty()) continue;
    const std::vector<SheetFrame> frames = frames_of_all_sets(shot, plan, entries);
    const auto has_picture = [](const SheetFrame& frame) { return !frame.picture.empty(); };
    if (frames.size() < 2 || std::ranges::none_of(frames, has_picture)) continue;
    const auto png = contact_sheet_png(frames);
    const Expected<void> done =
        png ? write_output(shot.sheet, *png) : Expected<void>(std::unexpected(png.error()));
    if (done) {
      written.push_back(shot.sheet.string());
    } else {
      print_error({shot.sheet.string() + ": " + done.error().message});
      failed = true;
    }
  }
  return written;
}

}  // namespace penumbra
