#include "scheduler/blender/blender_export.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scheduler/blender/blender_program.h"
#include "scheduler/files/run_program.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/render/frames.h"

namespace penumbra {
namespace {

constexpr std::chrono::hours kForEver{24 * 365};
constexpr std::chrono::milliseconds kBetweenLooks{5};
constexpr std::size_t kMostOutput = 2000;      // characters of Blender's in an error
constexpr std::size_t kLongestWord = 100'000;  // less than Linux's limit for one argument

/// As --frames of the script, in this order where that is not too long for a command line.
std::string frames_word(const std::vector<int>& frames) {
  if (std::ranges::is_sorted(frames)) return frames_text(frames);
  std::string text = fmt::format("{}", fmt::join(frames, ","));
  return text.size() <= kLongestWord ? text : frames_text(frames);
}

/// The end of a program's output, from the start of a line.
std::string last_lines(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  if (text.size() <= kMostOutput) return text;
  const std::size_t line = text.find('\n', text.size() - kMostOutput);
  return text.substr(line != text.npos ? line + 1 : text.size() - kMostOutput);
}

}  // namespace

BlenderExport::BlenderExport(const BlenderShot& shot, std::vector<int> frames, std::filesystem::path folder,
                             int number)
    : frames_(std::move(frames)),
      folder_(std::move(folder)),
      results_(folder_ / fmt::format("results.{}", number)),
      blender_([this, shot] {
        run(shot);
        is_over_ = true;
      }) {}

BlenderExport::~BlenderExport() { is_unwanted_ = true; }

void BlenderExport::run(const BlenderShot& shot) {
  const auto script = find_export_script();
  const auto blender = script ? find_blender(shot.program) : std::unexpected(script.error());
  if (!blender) {
    ended_ = std::unexpected(blender.error());
    return;
  }
  std::vector<std::string> words{std::filesystem::absolute(shot.file).string(), "--out=" + folder_.string(),
                                 "--result=" + results_.string()};
  if (!frames_.empty()) words.push_back("--frames=" + frames_word(frames_));
  for (const auto& [option, value] : {std::pair("scene", shot.scene), std::pair("camera", shot.camera),
                                      std::pair("view-layer", shot.layer)})
    if (!value.empty()) words.push_back(fmt::format("--{}={}", option, value));
  // Blender's own temporary files go with the folder, also where it is killed.
  std::vector<std::string> all = blender->arguments(*script, std::move(words));
  all.insert(all.begin(), {"TMPDIR=" + folder_.string(), blender->path.string()});
  const auto end = run_program("/usr/bin/env", std::move(all),
                               {.errors_too = true, .limit = kForEver, .stop = &is_unwanted_});
  if (!end)
    ended_ = std::unexpected(end.error());
  else if (!end->succeeded)
    ended_ = fail(fmt::format("Blender ({}) ended early, {}{}{}", blender->path.string(), end->how,
                              end->output.empty() ? "" : ":\n", last_lines(end->output)));
  else
    ended_ = fail(fmt::format("Blender ({}) did not export the frame{}{}", blender->path.string(),
                              end->output.empty() ? "" : ":\n", last_lines(end->output)));
}

void BlenderExport::read_results() {
  std::ifstream file(results_, std::ios::binary);
  file.seekg(std::streamoff(read_));
  for (std::string line; std::getline(file, line) && !file.eof();) {
    read_ += line.size() + 1;
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (!json.is_object()) continue;
    reported_ = json.value("error", reported_);
    if (!json.contains("frame")) continue;
    const int frame = json.value("frame", 0);
    scenes_[frame] = {.file = json.value("path", ""),
                      .left_out = json.value("report", std::vector<std::string>()),
                      .fps = json.contains("fps") ? std::optional(json.value("fps", 0.0)) : std::nullopt};
  }
}

bool BlenderExport::promises(std::optional<int> frame) const {
  return frame ? std::ranges::find(frames_, *frame) != frames_.end() : frames_.empty();
}

bool BlenderExport::ended_at(std::optional<int> frame) {
  const auto first = std::ranges::find_if(frames_, [this](int each) { return !has(each); });
  return frame && first != frames_.end() && *first == *frame;
}

bool BlenderExport::has(std::optional<int> frame) {
  read_results();
  return frame ? scenes_.contains(*frame) : frames_.empty() && !scenes_.empty();
}

Expected<ExportedScene> BlenderExport::frame(std::optional<int> frame) {
  for (;;) {
    const bool is_last = is_over_;  // read first, so that everything before it is found
    if (has(frame)) return frame ? scenes_.at(*frame) : scenes_.begin()->second;
    if (!reported_.empty()) return fail(reported_);
    if (is_last) return std::unexpected(ended_.error());
    if (stop_signal()) {
      is_unwanted_ = true;
      return fail("stopped by a signal while Blender exported it");
    }
    std::this_thread::sleep_for(kBetweenLooks);
  }
}

}  // namespace penumbra
