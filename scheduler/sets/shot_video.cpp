#include "scheduler/sets/shot_video.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "kernels/host/atomic_file.h"
#include "kernels/host/text.h"
#include "scenes/number.h"
#include "scheduler/files/program_path.h"
#include "scheduler/files/run_program.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::hours kTimeToEncode{12};
constexpr std::size_t kMostNamed = 10;  // frames that a message names

/// A text in a list of ffmpeg's concat demuxer.
std::string concat_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Removes a file at the end, whether it is there or not.
struct RemovedAtEnd {
  fs::path path;
  ~RemovedAtEnd() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
};

std::vector<std::string> ffmpeg_arguments(const fs::path& list, const fs::path& file, double rate) {
  // Each picture is a frame, whatever the demuxer takes for its duration. Rec. 709, as players assume. The
  // filter that multiplies by alpha wants planes.
  const std::string filters = fmt::format(
      "setpts=N/({}*TB),format=gbrap,premultiply=inplace=1,pad=ceil(iw/2)*2:ceil(ih/2)*2,"
      "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
      rate);
  return {
      "-v",    "error",      "-nostdin",     "-y",           "-f",          "concat",    "-safe",
      "0",     "-i",         list.string(),  "-vf",          filters,       "-r",        fmt::to_string(rate),
      "-c:v",  "libx264",    "-crf",         "18",           "-colorspace", "bt709",     "-color_primaries",
      "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv",          "-movflags", "+faststart",
      "-f",    "mp4",        file.string()};
}

}  // namespace

Expected<fs::path> find_ffmpeg() {
  if (auto found = find_program("ffmpeg")) return found;
  return fail("--video needs the program ffmpeg, which is not in PATH (Debian: apt-get install ffmpeg)");
}

double video_rate(std::span<const SheetFrame> frames, double fps) {
  int step = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const int distance = frames[i].frame - frames[i - 1].frame;
    step = step == 0 ? distance : std::min(step, distance);
  }
  return fps / std::max(step, 1);
}

Expected<VideoEnd> write_video(const fs::path& ffmpeg, std::span<const SheetFrame> frames, double rate,
                               const fs::path& file) {
  const auto first =
      std::ranges::find_if(frames, [](const SheetFrame& frame) { return !frame.picture.empty(); });
  if (first == frames.end()) return fail("no frame has a picture");
  std::string list = "ffconcat version 1.0\n";
  std::vector<int> held;
  fs::path picture = first->picture;
  for (const SheetFrame& frame : frames) {
    if (frame.picture.empty())
      held.push_back(frame.frame);
    else
      picture = frame.picture;
    list += "file " + concat_quoted(fs::absolute(picture).string()) + "\nduration 1\n";
  }
  if (const auto made = make_folders(file); !made) return std::unexpected(made.error());
  const auto hidden = [&](const char* ending) {
    return file.parent_path() / fmt::format(".{}.{}{}", file.filename().string(), getpid(), ending);
  };
  const RemovedAtEnd list_file{hidden(".txt")}, part{hidden(".part")};
  if (const auto written = write_file_atomically(list_file.path, bytes_of(list)); !written)
    return std::unexpected(written.error());
  const auto end = run_program(ffmpeg.string(), ffmpeg_arguments(list_file.path, part.path, rate),
                               {.errors_too = true, .limit = kTimeToEncode});
  if (!end) return std::unexpected(end.error());
  if (!end->succeeded) return fail(fmt::format("ffmpeg failed: {}", trim(end->output)));
  std::error_code error;
  fs::rename(part.path, file, error);
  if (error) return fail(fmt::format("cannot write {}: {}", file.string(), error.message()));
  VideoEnd ended{.held = held.size(),
                 .text = fmt::format("{} at {:g} fps", counted(frames.size(), "frame"), rate)};
  if (held.empty()) return ended;
  const bool names_all = held.size() <= kMostNamed;
  if (!names_all) held.resize(kMostNamed);
  ended.text += fmt::format("; {} without a picture hold that before: {}{}", counted(ended.held, "frame"),
                            fmt::join(held, ", "), names_all ? "" : ", …");
  return ended;
}

}  // namespace penumbra
