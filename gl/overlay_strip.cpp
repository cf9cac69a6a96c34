#include "gl/overlay_strip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gl/overlay_text.h"
#include "gl/overlay_widgets.h"
#include "kernels/host/text.h"

namespace penumbra {
namespace {

constexpr float kBar = 14, kTextGap = 6;  // in pixels of a plain display
constexpr float kMostOfWindow = 0.4f;     // of its height; in a lower window there is no strip
// From the most to the least that is to be seen where several frames share a pixel.
enum class Mark { kFailed, kMissing, kWaiting, kThere, kRead };

Mark mark_of(const ShotFrame& frame) {
  if (frame.state == FrameState::kFailed) return Mark::kFailed;
  if (!frame.has_file) return Mark::kMissing;
  if (frame.state == FrameState::kWaiting) return Mark::kWaiting;
  return frame.is_read ? Mark::kRead : Mark::kThere;
}

ImU32 color_of(Mark mark) {
  switch (mark) {
    case Mark::kFailed:
      return ImGui::GetColorU32({0.80f, 0.27f, 0.23f, 1});
    case Mark::kMissing:
      return ImGui::GetColorU32({0.32f, 0.33f, 0.37f, 1});
    case Mark::kWaiting:
      return ImGui::GetColorU32({0.50f, 0.38f, 0.16f, 1});
    case Mark::kThere:
      return ImGui::GetColorU32({0.27f, 0.39f, 0.54f, 1});
    case Mark::kRead:
      break;
  }
  return ImGui::GetColorU32({0.42f, 0.62f, 0.86f, 1});
}

std::string words_of(const ShotFrame& frame) {
  switch (mark_of(frame)) {
    case Mark::kFailed:
      return frame.has_file ? "failed; there is an older file" : "failed";
    case Mark::kMissing:
      return frame.state == FrameState::kWaiting ? "not rendered yet" : "missing";
    case Mark::kWaiting:
      return "not rendered yet; there is an older file";
    case Mark::kThere:
      return "there";
    case Mark::kRead:
      break;
  }
  return "there, and in memory";
}

const ShotFrame* find_frame(const ShotStatus& shot, int number) {
  const auto found = std::ranges::lower_bound(shot.frames, number, {}, &ShotFrame::number);
  return found == shot.frames.end() || found->number != number ? nullptr : &*found;
}

/// "frame 12 of 1 to 250", and what is to be said of it.
std::string place_text(const ShotStatus& shot) {
  if (shot.frames.empty()) return "no frame yet";
  std::string text = fmt::format("frame {} of {} to {}", shot.current, shot.frames.front().number,
                                 shot.frames.back().number);
  const ShotFrame* current = find_frame(shot, shot.current);
  if (current == nullptr || !current->has_file) {
    text += current != nullptr && current->state == FrameState::kFailed ? ": failed" : ": missing";
    if (shot.shown) text += fmt::format(", the picture is that of {}", *shot.shown);
  } else if (shot.shown != shot.current && !shot.plays) {
    text += ", being read";
  }
  return text;
}

std::string state_text(const ShotStatus& shot) {
  std::string text;
  const auto missing = std::ranges::count_if(shot.frames, [](const ShotFrame& frame) {
    return !frame.has_file && frame.state != FrameState::kFailed;
  });
  const auto failed = std::ranges::count(shot.frames, FrameState::kFailed, &ShotFrame::state);
  if (missing > 0) text += fmt::format("{} missing   ", missing);
  if (failed > 0) text += fmt::format("{} failed   ", failed);
  if (shot.plays && shot.skipped > 0) {
    text += fmt::format("{} skipped   ", counted(shot.skipped, "frame"));
    if (shot.shown_per_second > 0) text += fmt::format("{:.1f} shown a second   ", shot.shown_per_second);
  }
  return text + fmt::format("{:g} fps", shot.fps);
}

void draw_play_button(const ShotStatus& shot, float size, OverlayResult& result) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  if (ImGui::InvisibleButton("play", {size, size})) result.actions.push_back(Action::kOneMoreSample);
  const ImU32 color =
      ImGui::GetColorU32(ImGui::IsItemHovered() ? overlay_color::kAccent : overlay_color::kText);
  tooltip(with_key(shot.plays ? "Stop" : "Play", Action::kOneMoreSample));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float inset = 0.2f * size;
  if (shot.plays) {
    const float bar = 0.2f * size;
    for (const float x : {corner.x + inset, corner.x + size - inset - bar})
      list.AddRectFilled({x, corner.y + inset}, {x + bar, corner.y + size - inset}, color);
  } else {
    list.AddTriangleFilled({corner.x + inset, corner.y + inset},
                           {corner.x + size - inset, corner.y + 0.5f * size},
                           {corner.x + inset, corner.y + size - inset}, color);
  }
}

void draw_bar(const ShotStatus& shot, OverlayResult& result) {
  const float unit = overlay_unit(), height = kBar * unit;
  const float width = std::floor(ImGui::GetContentRegionAvail().x);
  if (width < 1 || shot.frames.empty()) return;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const std::size_t count = shot.frames.size();
  ImGui::InvisibleButton("frames", {width, height});
  const float cell = width / float(count);
  const auto at_mouse = [&] {
    const float x = (ImGui::GetIO().MousePos.x - corner.x) / cell;
    return std::size_t(std::clamp(x, 0.0f, float(count) - 1));
  };
  if (ImGui::IsItemActive()) result.frame = shot.frames[at_mouse()].number;
  if (ImGui::IsItemHovered()) {
    const ShotFrame& frame = shot.frames[at_mouse()];
    tooltip(fmt::format("frame {}: {}", frame.number, words_of(frame)));
  }
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float gap = cell >= 4 * unit ? std::max(1.0f, std::floor(unit)) : 0;
  // Cells narrower than a pixel share one, which shows what is most to be seen.
  const std::size_t columns = std::min(count, std::size_t(width));
  for (std::size_t column = 0; column < columns; ++column) {
    const std::size_t first = column * count / columns, end = (column + 1) * count / columns;
    Mark mark = Mark::kRead;
    for (std::size_t i = first; i < end; ++i) mark = std::min(mark, mark_of(shot.frames[i]));
    const float left = corner.x + std::floor(float(first) * cell);
    const float right = std::max(left + 1, corner.x + std::floor(float(end) * cell) - gap);
    if (mark == Mark::kMissing && gap > 0) {  // empty, so that it is told without colours too
      list.AddRect({left, corner.y}, {right, corner.y + height}, color_of(mark), 0, 0, gap);
    } else {
      list.AddRectFilled({left, corner.y}, {right, corner.y + height}, color_of(mark));
    }
  }
  const auto current = std::ranges::lower_bound(shot.frames, shot.current, {}, &ShotFrame::number);
  const float left =
      corner.x + std::floor(cell * float(std::min<std::size_t>(current - shot.frames.begin(), count - 1)));
  const float right = std::max(left + 2 * unit, corner.x + std::floor(left - corner.x + cell) - gap);
  list.AddRect({left - unit, corner.y - 2 * unit}, {right + unit, corner.y + height + 2 * unit},
               ImGui::GetColorU32(overlay_color::kAccent), unit, 0, 2 * unit);
}

}  // namespace

float strip_height(const ViewStatus& status) {
  if (!status.shot) return 0;
  const float height = std::ceil(ImGui::GetTextLineHeight() + (kBar + kTextGap + 18) * overlay_unit());
  return height < kMostOfWindow * ImGui::GetIO().DisplaySize.y ? height : 0;
}

void draw_strip(const ViewStatus& status, float width, OverlayResult& result) {
  if (!status.shot) return;
  const ShotStatus& shot = *status.shot;
  const float unit = overlay_unit(), height = strip_height(status);
  if (height <= 0) return;
  ImGui::SetNextWindowPos({0, ImGui::GetIO().DisplaySize.y - height});
  ImGui::SetNextWindowSize({width, height});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {10 * unit, 7 * unit});
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {8 * unit, kTextGap * unit});
  if (ImGui::Begin("Frames", nullptr, kFlags)) {
    draw_play_button(shot, ImGui::GetTextLineHeight(), result);
    ImGui::SameLine();
    ImGui::TextUnformatted(place_text(shot).c_str());
    const std::string state = state_text(shot);
    ImGui::SameLine();
    const float right = ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(state.c_str()).x;
    ImGui::SetCursorPosX(std::max(right, ImGui::GetCursorPosX()));
    ImGui::PushStyleColor(ImGuiCol_Text,
                          shot.plays && shot.skipped > 0 ? overlay_color::kWarning : overlay_color::kDim);
    ImGui::TextUnformatted(state.c_str());
    ImGui::PopStyleColor();
    draw_bar(shot, result);
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

}  // namespace penumbra
