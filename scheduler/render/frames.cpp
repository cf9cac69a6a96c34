#include "scheduler/render/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <ranges>
#include <set>

#include "scenes/number.h"

namespace penumbra {
namespace {

constexpr std::size_t kMostFrames = 1'000'000;

struct FrameRange {
  std::int64_t first = 0, last = 0, step = 1;
};

/// The range of a text without commas. Nothing if it is none.
std::optional<FrameRange> range_of_frames(std::string_view text) {
  const std::size_t dots = text.find(".."), dash = text.find('-');
  const std::size_t split = dots != text.npos ? dots : dash;
  if (split == text.npos) {
    const auto only = parse_integer(text, 0, kLastFrame);
    return only ? std::optional(FrameRange{*only, *only}) : std::nullopt;
  }
  const std::string_view rest = text.substr(split + (dots != text.npos ? 2 : 1));
  const std::size_t cross = std::min(rest.find('x'), rest.size());
  const auto first = parse_integer(text.substr(0, split), 0, kLastFrame),
             last = parse_integer(rest.substr(0, cross), 0, kLastFrame),
             step = parse_integer(cross == rest.size() ? "1" : rest.substr(cross + 1), 1, kLastFrame);
  if (!first || !last || !step || *last < *first) return std::nullopt;
  return FrameRange{*first, *last, *step};
}

}  // namespace

Expected<std::vector<std::string>> frames_of(std::string_view text) {
  std::vector<std::string> frames;
  std::set<std::int64_t> seen;
  for (const auto& part : std::views::split(text.empty() ? " " : text, ',')) {
    const std::string_view word(part.begin(), part.end());
    const auto range = range_of_frames(word);
    if (!range)
      return fail(
          fmt::format("frames are whole numbers from 0, as in 300, 1-250, 1-250x2 or 1-10,50-60, not "
                      "'{}'",
                      word));
    if (std::size_t((range->last - range->first) / range->step) + frames.size() >= kMostFrames)
      return fail(fmt::format("'{}' has more than {} frames", text, kMostFrames));
    for (std::int64_t frame = range->first; frame <= range->last; frame += range->step) {
      if (!seen.insert(frame).second)
        return fail(fmt::format("frame {} is there twice in '{}'", frame, text));
      frames.push_back(fmt::to_string(frame));
    }
  }
  return frames;
}

std::string frames_text(std::vector<int> frames) {
  std::ranges::sort(frames);
  frames.erase(std::ranges::unique(frames).begin(), frames.end());
  std::string text;
  for (std::size_t at = 0; at < frames.size();) {
    std::size_t end = at + 1;  // of the frames at equal distances
    const int step = end < frames.size() ? frames[end] - frames[at] : 0;
    while (end < frames.size() && frames[end] - frames[end - 1] == step) ++end;
    if (step != 1 && end - at < 3) end = at + 1;  // two that are apart are no range
    text += fmt::format("{}{}", text.empty() ? "" : ",", frames[at]);
    if (end - at > 1) text += fmt::format("-{}", frames[end - 1]);
    if (end - at > 1 && step > 1) text += fmt::format("x{}", step);
    at = end;
  }
  return text;
}

double frames_per_second(const SceneOptions& options) { return options.fps.value_or(kFramesPerSecond); }

double frame_seconds(const SceneOptions& options) {
  return (double(options.frame.value_or(0)) + options.frame_offset) / frames_per_second(options);
}

std::uint32_t frame_in_seed(const SceneOptions& options) {
  return options.seed_by_frame ? std::uint32_t(options.frame.value_or(0)) : 0;
}

std::vector<std::string> preview_order(const std::vector<std::string>& frames) {
  if (frames.size() < 3) return frames;
  std::vector<std::string> order{frames.front(), frames.back()};
  // Breadth first: the middles of all intervals of a level before those of the next.
  std::vector<std::pair<std::size_t, std::size_t>> level{{0, frames.size() - 1}};
  while (!level.empty()) {
    std::vector<std::pair<std::size_t, std::size_t>> next;
    for (const auto& [low, high] : level) {
      if (high - low < 2) continue;
      const std::size_t middle = (low + high) / 2;
      order.push_back(frames[middle]);
      next.emplace_back(low, middle);
      next.emplace_back(middle, high);
    }
    level = std::move(next);
  }
  return order;
}

std::string with_frame_field(const std::string& name) {
  const std::size_t folder_end = name.find_last_of('/') + 1;  // npos + 1 is 0
  const std::size_t last =
      std::max(name.rfind('#') + 1, folder_end) > folder_end ? name.rfind('#') : name.rfind("##");
  if (last != name.npos) {
    const std::size_t end = std::min(name.find_first_not_of('#', last), name.size());
    const std::size_t begin = end == 0 ? 0 : name.find_last_not_of('#', end - 1) + 1;
    return name.substr(0, begin) + fmt::format("{{frame:0{}}}", end - begin) + name.substr(end);
  }
  if (name.contains("{frame")) return name;
  const std::filesystem::path path = name;
  return (path.parent_path() / (path.stem().string() + ".{frame:04}" + path.extension().string())).string();
}

}  // namespace penumbra
