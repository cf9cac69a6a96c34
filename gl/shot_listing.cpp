#include "gl/shot_listing.h"

#include <algorithm>
#include <map>

#include "scheduler/run/output_files.h"
#include "scheduler/sets/set_summary.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFrames = 1'000'000;

FrameState state_of(SetState state) {
  if (state == SetState::kDone || state == SetState::kUnchanged) return FrameState::kThere;
  return state == SetState::kFailed ? FrameState::kFailed : FrameState::kWaiting;
}

/// What the summaries in the folder say of frames.
std::map<int, FrameState> summarised(const FrameFiles& files) {
  std::map<int, FrameState> states;
  std::error_code error;
  for (fs::directory_iterator entry(files.folder(), error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name != "jobs.json" && !name.ends_with(".jobs.json")) continue;
    for (const SetEntry& listed : read_set_summary(entry->path()))
      for (const fs::path file : listed.files)
        for (const fs::path& image : {file, denoised_name(file)})
          if (const auto frame = files.frame_of(image)) states.emplace(*frame, state_of(listed.state));
  }
  return states;
}

}  // namespace

std::vector<ListedFrame> list_shot(const FrameFiles& files) {
  std::map<int, ListedFrame> frames;
  for (const auto& [number, state] : summarised(files))
    // What is done and has no file any more is missing.
    frames[number] = {number, state == FrameState::kThere ? FrameState::kMissing : state};
  for (const int number : files.find()) {
    const FileStamp stamp = stamp_of(files.file(number));
    if (stamp == FileStamp{}) continue;
    ListedFrame& frame = frames.try_emplace(number, ListedFrame{number}).first->second;
    if (frame.state == FrameState::kMissing) frame.state = FrameState::kThere;
    frame.has_file = true;
    frame.stamp = stamp;
  }
  if (frames.empty()) return {};
  int step = 0;
  for (auto frame = frames.begin(), next = std::next(frame); next != frames.end(); frame = next++)
    step = step == 0 ? next->first - frame->first : std::min(step, next->first - frame->first);
  std::vector<ListedFrame> all;
  for (const auto& [number, frame] : frames) {
    while (step > 0 && !all.empty() && all.back().number + step < number && all.size() < kMostFrames)
      all.push_back({all.back().number + step, FrameState::kMissing});
    all.push_back(frame);
  }
  return all;
}

}  // namespace penumbra
