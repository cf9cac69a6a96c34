#include "scheduler/sets/shot_video.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
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

/// Removes a file or a folder at the end, whether it is there or not.
struct RemovedAtEnd {
  fs::path path;
  ~RemovedAtEnd() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

constexpr const char* kList = "frames.txt";

/// For a folder with the list.
std::vector<std::string> ffmpeg_arguments(const fs::path& file, double rate) {
  const std::string output = "file:" + fs::absolute(file).string();  // else "a:" in a name were a protocol
  // Each picture is a frame, whatever the demuxer takes for its duration. Rec. 709, as players assume. The
  // filter that multiplies by alpha wants planes.
  const std::string filters = fmt::format(
      "setpts=N/({}*TB),format=gbrap,premultiply=inplace=1,pad=ceil(iw/2)*2:ceil(ih/2)*2,"
      "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
      rate);
  return {
      "-v",    "error",      "-nostdin",     "-y",           "-f",          "concat",    "-safe",
      "0",     "-i",         kList,          "-vf",          filters,       "-r",        fmt::to_string(rate),
      "-c:v",  "libx264",    "-crf",         "18",           "-colorspace", "bt709",     "-color_primaries",
      "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv",          "-movflags", "+faststart",
      "-f",    "mp4",        output};
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
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  std::string folder = (temporary / "penumbra-video-XXXXXX").string();
  if (error || mkdtemp(folder.data()) == nullptr)
    return fail(fmt::format("cannot make a folder in {}", temporary.string()));
  const RemovedAtEnd removed{folder};
  // ffmpeg takes a name with % for a pattern of names, so it gets other names of the pictures.
  std::string list = "ffconcat version 1.0\n";
  std::vector<int> held;
  fs::path picture = first->picture;
  for (const SheetFrame& frame : frames) {
    if (frame.picture.empty())
      held.push_back(frame.frame);
    else
      picture = frame.picture;
    const std::string name = fmt::format("{}{}", frame.frame, picture.extension().string());
    fs::create_symlink(fs::absolute(picture), fs::path(folder) / name, error);
    if (error) return fail(fmt::format("cannot make a link in {}: {}", folder, error.message()));
    list += "file " + name + "\nduration 1\n";
  }
  if (const auto made = make_folders(file); !made) return std::unexpected(made.error());
  const RemovedAtEnd part{file.parent_path() /
                          fmt::format(".{}.{}.part", file.filename().string(), getpid())};
  if (const auto written = write_file_atomically(fs::path(folder) / kList, bytes_of(list)); !written)
    return std::unexpected(written.error());
  const auto end = run_program(fs::absolute(ffmpeg).string(), ffmpeg_arguments(part.path, rate),
                               {.folder = folder, .errors_too = true, .limit = kTimeToEncode});
  if (!end) return std::unexpected(end.error());
  if (!end->succeeded) return fail(fmt::format("ffmpeg failed: {}", trim(end->output)));
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
