#include "gl/overlay.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "gl/overlay_help.h"
#include "gl/overlay_picture.h"
#include "gl/overlay_strip.h"
#include "gl/overlay_text.h"
#include "gl/overlay_widgets.h"
#include "gl/tile_outlines.h"
#include "gl/view_model.h"
#include "kernels/host/text.h"

namespace penumbra {
namespace {

constexpr float kPanelWidth = 348;     // in pixels of a plain display
constexpr float kLeastPicture = 0.4f;  // of the window's width; below it the panel is drawn over the picture

void draw_connection(const ViewStatus& status) {
  const float unit = overlay_unit(), line = ImGui::GetTextLineHeight();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::GetWindowDrawList()->AddCircleFilled({corner.x + 5 * unit, corner.y + 0.5f * line}, 4.5f * unit,
                                              ImGui::GetColorU32(connection_color(status)));
  ImGui::Dummy({12 * unit, line});
  ImGui::SameLine();
  const bool plain = status.connection == ConnectionState::kConnected;
  wrapped(plain ? overlay_color::kText : connection_color(status), connection_text(status));
  if (!status.address.empty()) wrapped(overlay_color::kDim, status.address);
  ImGui::Dummy({0, 2 * unit});
  if (!status.scene.empty()) wrapped(overlay_color::kText, status.scene);
  std::string about = status.integrator;
  if (status.film_width > 0)
    about +=
        fmt::format("{}{} × {} pixels", about.empty() ? "" : ", ", status.film_width, status.film_height);
  if (!about.empty()) wrapped(overlay_color::kDim, about);
}

/// Against what the scene asks for, so that the end does not move while a window refines.
struct ProgressText {
  std::string text;
  double share = 0;
  bool done = false;
};

ProgressText progress_text(const DisplaySettings& settings, const ViewStatus& status) {
  const bool keeps_refining = settings.automatic && status.interactive && status.scene_spp > 0;
  if (keeps_refining) {
    const double share = double(status.spp_done) / status.scene_spp;
    if (share < 1) return {fmt::format("{} of {} samples", status.spp_done, status.scene_spp), share, false};
    return {fmt::format("{} samples, {} asked for", status.spp_done, status.scene_spp), 1, true};
  }
  if (status.spp_wanted == 0) return {"no samples yet", 0, false};
  const double share =
      status.samples_total > 0 ? double(status.samples_done) / double(status.samples_total) : 0.0;
  return {fmt::format("{} of {}{}", status.spp_done, counted(status.spp_wanted, "sample"),
                      status.finished ? ", finished" : ""),
          share, status.finished};
}

void draw_progress(DisplaySettings& settings, const ViewStatus& status, OverlayResult& result) {
  if (!section("Progress")) return;
  const auto [label, share, done] = progress_text(settings, status);
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, done ? ImVec4{0.25f, 0.52f, 0.29f, 1}
                                                     : ImGui::GetStyle().Colors[ImGuiCol_PlotHistogram]);
  ImGui::ProgressBar(float(std::clamp(share, 0.0, 1.0)), {-1, 0}, "");
  ImGui::PopStyleColor();
  // Centred; ImGui would place it at the bar's end.
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const ImVec2 size = ImGui::CalcTextSize(label.c_str());
  ImGui::GetWindowDrawList()->AddText(
      {std::floor(0.5f * (low.x + high.x - size.x)), std::floor(0.5f * (low.y + high.y - size.y))},
      ImGui::GetColorU32(ImGuiCol_Text), label.c_str());
  tooltip(fmt::format("{} of {} samples of pixels are merged; {} in every pixel.",
                      count_text(double(status.samples_done)), count_text(double(status.samples_total)),
                      status.spp_done));
  if (ImGui::BeginTable("facts", 2)) {
    ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthFixed, 132 * overlay_unit());
    ImGui::TableSetupColumn("how much", ImGuiTableColumnFlags_WidthStretch);
    fact("samples a second", status.samples_per_second > 0 ? count_text(status.samples_per_second) : "none");
    fact("time left", status.finished ? "none" : duration_text(status.seconds_left));
    fact("relative error", percent_text(status.relative_error));
    fact("first tile after",
         std::isnan(status.latency_seconds) ? "none yet" : duration_text(status.latency_seconds));
    fact("frames a second", count_text(std::round(status.frames_per_second)));
    if (status.hybrid) {
      fact("antialiasing",
           fmt::format("{} {}", status.analytic_frames, status.analytic_frames == 1 ? "frame" : "frames"));
      tooltip("Frames of the closed form that are averaged");
    }
    ImGui::EndTable();
  }
  const DisabledWhile more(why_no_more_samples(status));
  if (ImGui::Button("one more sample")) result.actions.push_back(Action::kOneMoreSample);
  more.tooltip(with_key("One more sample for every pixel", Action::kOneMoreSample));
  ImGui::SameLine();
  ImGui::Checkbox("keep refining", &settings.automatic);
  more.tooltip(with_key("Ask for more samples as soon as the last are there", Action::kToggleAutomatic));
}

void draw_buttons(DisplaySettings& settings, const ViewStatus& status, OverlayResult& result) {
  const float space = ImGui::GetStyle().ItemInnerSpacing.x;
  const float width = std::floor((ImGui::GetContentRegionAvail().x - 2 * space) / 3);
  const auto button = [&](const char* name, const std::string& why, const std::string& about, Action action) {
    const DisabledWhile off(why);
    const bool pressed = ImGui::Button(name, {width, 0});
    off.tooltip(with_key(about, action));
    return pressed;
  };
  ImGui::Dummy({0, 3 * overlay_unit()});
  if (button("save", why_no_save(status), "The view as numbered EXR and PNG, with its camera", Action::kSave))
    result.actions.push_back(Action::kSave);
  ImGui::SameLine(0, space);
  if (button("reload", why_no_reload(status), "Read the scene again", Action::kReload))
    result.actions.push_back(Action::kReload);
  ImGui::SameLine(0, space);
  if (button("reset camera", why_no_camera(status), "Back to the scene's own camera", Action::kResetCamera))
    result.actions.push_back(Action::kResetCamera);
  if (button("copy view", why_no_copy(status), "The camera as settings of a render", Action::kCopyView))
    result.actions.push_back(Action::kCopyView);
  if (ImGui::BeginPopupContextItem("formats")) {
    for (const CameraFormat format :
         {CameraFormat::kSettings, CameraFormat::kMitsuba, CameraFormat::kTinyRender})
      if (ImGui::MenuItem(kCameraFormatNames[int(format)])) result.copy = format;
    ImGui::EndPopup();
  }
  ImGui::SameLine(0, space);
  if (button("help", "", "All keys, and what the mouse does", Action::kToggleHelp))
    settings.help = !settings.help;
  ImGui::SameLine(0, space);
  if (button("hide", "", "The picture alone; the same key brings the panel back", Action::kTogglePanel))
    settings.panel = false;
}

void draw_messages(const ViewStatus& status) {
  if (!section("Messages")) return;
  const float least = 4 * ImGui::GetTextLineHeightWithSpacing();
  const float height = std::max(ImGui::GetContentRegionAvail().y, least);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {6 * overlay_unit(), 4 * overlay_unit()});
  if (ImGui::BeginChild("messages", {0, height}, false, ImGuiWindowFlags_AlwaysUseWindowPadding)) {
    const bool at_end = ImGui::GetScrollY() >= ImGui::GetScrollMaxY();
    if (status.messages.empty()) wrapped(overlay_color::kDim, "none");
    for (const std::string& message : status.messages) {
      const MessageKind kind = message_kind(message);
      wrapped(kind == MessageKind::kError     ? overlay_color::kBad
              : kind == MessageKind::kWarning ? overlay_color::kWarning
                                              : overlay_color::kText,
              message);
    }
    if (at_end) ImGui::SetScrollHereY(1);
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

/// Filled while the worker has a tile.
void draw_color(const WorkerView& worker) {
  const float unit = overlay_unit(), line = ImGui::GetTextLineHeight();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 low{corner.x, corner.y + 0.5f * line - 5 * unit}, high{low.x + 10 * unit, low.y + 10 * unit};
  const ImU32 color = packed(worker_color(worker.number));
  if (worker.width > 0)
    ImGui::GetWindowDrawList()->AddRectFilled(low, high, color, 2 * unit);
  else
    ImGui::GetWindowDrawList()->AddRect(low, high, color, 2 * unit, 0, 1.5f * unit);
}

/// The panel's list of workers.
void draw_workers(DisplaySettings& settings, const ViewStatus& status) {
  if (!section(fmt::format("Workers: {}###Workers", status.workers.size()).c_str())) return;
  ImGui::Checkbox("outline the tiles in hand", &settings.outlines);
  tooltip(with_key("Each worker's tile in its colour", Action::kToggleOutlines));
  if (status.workers.empty()) return wrapped(overlay_color::kDim, "none has come yet");
  const float unit = overlay_unit(), line = ImGui::GetTextLineHeight();
  constexpr int kLines = 9;
  const float height = line * float(std::min(std::size_t(kLines), 3 * status.workers.size())) + 2 * unit;
  constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit;
  if (!ImGui::BeginTable("workers", 3, kFlags, {0, height})) return;
  ImGui::TableSetupColumn("colour", 0, 12 * unit);
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("units", 0, 48 * unit);
  for (const WorkerView& worker : status.workers) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    draw_color(worker);
    ImGui::TableNextColumn();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
    wrapped(overlay_color::kText, worker.name);
    wrapped(overlay_color::kDim, worker.device);
    ImGui::PopStyleVar();
    tooltip(fmt::format("{} of work done, {}", counted(worker.units, "unit"),
                        worker.width > 0 ? fmt::format("{} × {} pixels at {}, {} in hand", worker.width,
                                                       worker.height, worker.x, worker.y)
                                         : "idle"));
    ImGui::TableNextColumn();
    const std::string units = count_text(double(worker.units));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() +
                         std::max(0.0f, 46 * unit - ImGui::CalcTextSize(units.c_str()).x));
    ImGui::TextUnformatted(units.c_str());
  }
  ImGui::EndTable();
}

void draw_panel(DisplaySettings& settings, const ViewStatus& status, const ShownAs& shown, float left,
                float width, OverlayResult& result) {
  ImGui::SetNextWindowPos({left, 0});
  ImGui::SetNextWindowSize({width, ImGui::GetIO().DisplaySize.y});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus;
  // NoDecoration would remove the scroll bar.
  if (ImGui::Begin("Panel", nullptr, kFlags & ~ImGuiWindowFlags_NoScrollbar)) {
    draw_connection(status);
    if (status.connection != ConnectionState::kFile) draw_progress(settings, status, result);
    draw_picture_settings(settings, status, shown, result);
    draw_comparison(settings, status, result);
    result.shows_histogram = draw_histogram(status);
    if (status.connection != ConnectionState::kFile) draw_workers(settings, status);
    draw_buttons(settings, status, result);
    draw_messages(status);
  }
  ImGui::End();
}

/// What opens the panel, in the corner where it was; only while the mouse is in the window.
void draw_handle(DisplaySettings& settings) {
  if (!ImGui::IsMousePosValid()) return;
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize;
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x, 0}, ImGuiCond_Always, {1, 0});
  ImGui::SetNextWindowBgAlpha(0);
  if (ImGui::Begin("Handle", nullptr, kFlags)) {
    if (ImGui::Button("panel")) settings.panel = true;
    tooltip(with_key("Show the panel", Action::kTogglePanel));
  }
  ImGui::End();
}

}  // namespace

OverlayResult draw_overlay(DisplaySettings& settings, const ViewStatus& status, const ShownAs& shown) {
  OverlayResult result;
  const ImGuiIO& io = ImGui::GetIO();
  const float width = std::min(std::floor(kPanelWidth * overlay_unit()), io.DisplaySize.x);
  const bool beside = settings.panel && io.DisplaySize.x - width >= kLeastPicture * io.DisplaySize.x;
  const float left = io.DisplaySize.x - width;
  const float free_width = beside ? left : io.DisplaySize.x;
  const bool panel = settings.panel;
  draw_banner(status, {0, 0}, {panel ? std::max(left, 1.0f) : free_width, io.DisplaySize.y});
  if (panel) draw_panel(settings, status, shown, left, width, result);
  const float free_height = std::max(io.DisplaySize.y - strip_height(status), 1.0f);
  draw_strip(status, free_width, result);
  if (!panel || beside) draw_pixel(status, {free_width, free_height});
  if (!panel) draw_handle(settings);
  result.again = draw_help(settings, {free_width, io.DisplaySize.y});
  const float pixels = io.DisplayFramebufferScale.x;
  result.picture_area = {0, 0, int(std::lround(free_width * pixels)), int(std::lround(free_height * pixels))};
  return result;
}

}  // namespace penumbra
