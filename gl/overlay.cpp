#include "gl/overlay.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "gl/overlay_help.h"
#include "gl/overlay_legend.h"
#include "gl/overlay_text.h"
#include "gl/overlay_widgets.h"
#include "gl/worker_colors.h"

namespace penumbra {
namespace {

constexpr float kPanelWidth = 336;     // in pixels of a plain display
constexpr float kLeastPicture = 0.4f;  // of the window's width; below it the panel is drawn over the picture
constexpr float kLeastAlpha = -1, kMostAlpha = 2;
constexpr float kAlphaSnap = 0.05f;  // a drag that ends this close to 0 or 1 snaps to it
constexpr float kMostStops = 20;

std::string with_key(std::string text, Action action) {
  return fmt::format("{} (key: {})", text, key_text(info_of(action).key));
}

void wrapped(const ImVec4& color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

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

void draw_progress(DisplaySettings& settings, const ViewStatus& status, OverlayResult& result) {
  section("Progress");
  const double share =
      status.samples_total > 0 ? double(status.samples_done) / double(status.samples_total) : 0.0;
  const std::string text = status.spp_wanted > 0
                               ? fmt::format("{} of {} {}", status.spp_done, status.spp_wanted,
                                             status.spp_wanted == 1 ? "sample" : "samples")
                               : "no samples yet";
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, status.finished
                                                    ? ImVec4{0.25f, 0.52f, 0.29f, 1}
                                                    : ImGui::GetStyle().Colors[ImGuiCol_PlotHistogram]);
  ImGui::ProgressBar(float(std::clamp(share, 0.0, 1.0)), {-1, 0}, "");
  ImGui::PopStyleColor();
  // Centred; ImGui would place it at the bar's end.
  const std::string label = status.finished ? text + ", finished" : text;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const ImVec2 size = ImGui::CalcTextSize(label.c_str());
  ImGui::GetWindowDrawList()->AddText(
      {std::floor(0.5f * (low.x + high.x - size.x)), std::floor(0.5f * (low.y + high.y - size.y))},
      ImGui::GetColorU32(ImGuiCol_Text), label.c_str());
  tooltip(fmt::format("{} of {} samples of pixels are merged; {} in every pixel.",
                      count_text(double(status.samples_done)), count_text(double(status.samples_total)),
                      status.spp_done));
  if (ImGui::BeginTable("facts", 2)) {
    ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthFixed, 118 * overlay_unit());
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

void layer_button(DisplaySettings& settings, const ViewStatus& status, Layer layer, const char* name,
                  const char* about, Action action) {
  const bool needs_closed_form = layer == Layer::kAnalytic || layer == Layer::kDifference;
  const DisabledWhile off(needs_closed_form ? why_no_closed_form(status) : "");
  if (ImGui::RadioButton(name, settings.layer == layer)) settings.layer = layer;
  off.tooltip(with_key(about, action));
}

/// A slider that a right click resets to `usual`.
bool slider(const char* name, float& value, float low, float high, const char* format, float usual) {
  const bool changed = ImGui::SliderFloat(name, &value, low, high, format);
  if (ImGui::IsItemClicked(ImGuiMouseButton_Right) && value != usual) {
    value = usual;
    return true;
  }
  if (changed && !std::isfinite(value)) value = usual;  // it may have been typed
  return changed;
}

void draw_alpha(DisplaySettings& settings, const ViewStatus& status, OverlayResult& result) {
  const DisabledWhile off(why_no_alpha(status));
  const ImGuiStyle& style = ImGui::GetStyle();
  const float button = ImGui::CalcTextSize("0").x + 2 * style.FramePadding.x;
  labelled("alpha");
  ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - 2 * (button + style.ItemInnerSpacing.x),
                                   30 * overlay_unit()));
  const float before = settings.alpha;
  result.alpha_changed |= slider("##alpha", settings.alpha, kLeastAlpha, kMostAlpha, "%.2f", 1);
  if (ImGui::IsItemActive() && !ImGui::GetIO().WantTextInput) {
    for (const float round : {0.0f, 1.0f}) {
      if (std::abs(settings.alpha - round) < kAlphaSnap) settings.alpha = round;
    }
    result.alpha_changed = settings.alpha != before;
  }
  off.tooltip(with_key(
      "How much of the closed form the estimate leans on: 0 is plain samples, 1 the usual control variate",
      Action::kAlphaUp));
  for (const float round : {0.0f, 1.0f}) {
    ImGui::SameLine(0, style.ItemInnerSpacing.x);
    if (ImGui::Button(round == 0 ? "0" : "1")) {
      result.alpha_changed |= settings.alpha != round;
      settings.alpha = round;
    }
    off.tooltip("");
  }
}

void draw_picture_settings(DisplaySettings& settings, const ViewStatus& status, OverlayResult& result) {
  section("Picture");
  const float second = 0.5f * (ImGui::GetWindowContentRegionMin().x + ImGui::GetWindowContentRegionMax().x);
  layer_button(settings, status, Layer::kComposite, "image", "What is rendered", Action::kShowComposite);
  ImGui::SameLine(second);
  layer_button(settings, status, Layer::kAnalytic, "closed form",
               "Light without shadows and without noise, drawn here", Action::kShowAnalytic);
  layer_button(settings, status, Layer::kDifference, "difference",
               "What samples add to the closed form: grey is nothing", Action::kShowDifference);
  ImGui::SameLine(second);
  layer_button(settings, status, Layer::kError, "standard error",
               "Of the mean of each pixel, from two samples on", Action::kShowError);
  {
    const DisabledWhile off(settings.layer == Layer::kComposite ? "" : "Only the image is denoised.");
    ImGui::Checkbox("denoise", &settings.denoise);
    off.tooltip(with_key("Non-local means, by the standard error of each pixel", Action::kToggleDenoising));
  }
  draw_legend(settings);
  if (settings.layer == Layer::kError) {
    if (ImGui::RadioButton("relative", settings.relative_error)) settings.relative_error = true;
    tooltip("Over the brightness of the pixel");
    ImGui::SameLine(second);
    if (ImGui::RadioButton("absolute", !settings.relative_error)) settings.relative_error = false;
    tooltip("In units of radiance; the scale goes with the exposure");
  }
  labelled("exposure");
  ImGui::SetNextItemWidth(-1);
  slider("##exposure", settings.exposure, -10, 10, "%+.2f stops", 0);
  settings.exposure = std::clamp(settings.exposure, -kMostStops, kMostStops);
  tooltip(fmt::format("Radiance times 2^exposure (keys: {} and {})", key_text(info_of(Action::kBrighter).key),
                      key_text(info_of(Action::kDarker).key)));
  {
    static constexpr std::array<const char*, 3> kNames{"clamp", "Reinhard", "filmic"};
    const DisabledWhile off(settings.layer == Layer::kComposite || settings.layer == Layer::kAnalytic
                                ? ""
                                : "Tone maps are for the image and the closed form.");
    labelled("tone map");
    int chosen = int(settings.tone_map);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::Combo("##tone map", &chosen, kNames.data(), int(kNames.size())))
      settings.tone_map = ToneMap(chosen);
    off.tooltip(with_key("How bright values fit the display", Action::kNextToneMap));
  }
  draw_alpha(settings, status, result);
}

void draw_workers(DisplaySettings& settings, const ViewStatus& status) {
  section(fmt::format("Workers: {}", status.workers.size()).c_str());
  ImGui::Checkbox("outline the tiles in hand", &settings.outlines);
  tooltip(with_key("Each worker's tile in its colour", Action::kToggleOutlines));
  if (status.workers.empty()) return wrapped(overlay_color::kDim, "none has come yet");
  const float unit = overlay_unit(), line = ImGui::GetTextLineHeight();
  constexpr int kRows = 6;
  const float row = line + 2 * ImGui::GetStyle().CellPadding.y;
  const float height = row * float(std::min(std::size_t(kRows), status.workers.size())) + 2 * unit;
  constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit;
  if (!ImGui::BeginTable("workers", 4, kFlags, {0, height})) return;
  ImGui::TableSetupColumn("colour", 0, 12 * unit);
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 3);
  ImGui::TableSetupColumn("device", ImGuiTableColumnFlags_WidthStretch, 3);
  ImGui::TableSetupColumn("units", 0, 44 * unit);
  ImGuiListClipper clipper;
  clipper.Begin(int(status.workers.size()), row);
  while (clipper.Step()) {
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const WorkerView& worker = status.workers[std::size_t(i)];
      ImGui::TableNextRow(0, row);
      ImGui::TableNextColumn();
      const ImVec2 corner = ImGui::GetCursorScreenPos();
      const ImVec2 low{corner.x, corner.y + 0.5f * line - 5 * unit},
          high{low.x + 10 * unit, low.y + 10 * unit};
      const ImU32 color = packed(worker_color(worker.number));
      if (worker.width > 0) {
        ImGui::GetWindowDrawList()->AddRectFilled(low, high, color, 2 * unit);
      } else {  // idle
        ImGui::GetWindowDrawList()->AddRect(low, high, color, 2 * unit, 0, 1.5f * unit);
      }
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(worker.name.c_str());
      tooltip(fmt::format("{}, {}: {} units of work done, {}", worker.name, worker.device, worker.units,
                          worker.width > 0 ? fmt::format("{} × {} pixels at {}, {} in hand", worker.width,
                                                         worker.height, worker.x, worker.y)
                                           : "idle"));
      ImGui::TableNextColumn();
      ImGui::TextColored(overlay_color::kDim, "%s", worker.device.c_str());
      ImGui::TableNextColumn();
      const std::string units = count_text(double(worker.units));
      ImGui::SetCursorPosX(ImGui::GetCursorPosX() +
                           std::max(0.0f, 42 * unit - ImGui::CalcTextSize(units.c_str()).x));
      ImGui::TextUnformatted(units.c_str());
    }
  }
  ImGui::EndTable();
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
  if (button("save", why_no_save(status), "The image as EXR and PNG", Action::kSave))
    result.actions.push_back(Action::kSave);
  ImGui::SameLine(0, space);
  if (button("reload", why_no_reload(status), "Read the scene again", Action::kReload))
    result.actions.push_back(Action::kReload);
  ImGui::SameLine(0, space);
  if (button("reset camera", why_no_camera(status), "Back to the scene's own camera", Action::kResetCamera))
    result.actions.push_back(Action::kResetCamera);
  if (button("help", "", "All keys, and what the mouse does", Action::kToggleHelp))
    settings.help = !settings.help;
  ImGui::SameLine(0, space);
  if (button("hide", "", "The picture alone; the same key brings the panel back", Action::kTogglePanel))
    settings.panel = false;
  ImGui::SameLine(0, space);
  if (button("quit", "", "Close the window", Action::kQuit)) result.quit = true;
}

void draw_messages(const ViewStatus& status) {
  section("Messages");
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

void draw_panel(DisplaySettings& settings, const ViewStatus& status, float left, float width,
                OverlayResult& result) {
  ImGui::SetNextWindowPos({left, 0});
  ImGui::SetNextWindowSize({width, ImGui::GetIO().DisplaySize.y});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus;
  // NoDecoration would remove the scroll bar.
  if (ImGui::Begin("Panel", nullptr, kFlags & ~ImGuiWindowFlags_NoScrollbar)) {
    draw_connection(status);
    draw_progress(settings, status, result);
    draw_picture_settings(settings, status, result);
    draw_workers(settings, status);
    draw_buttons(settings, status, result);
    draw_messages(status);
  }
  ImGui::End();
}

}  // namespace

OverlayResult draw_overlay(DisplaySettings& settings, const ViewStatus& status) {
  OverlayResult result;
  const ImGuiIO& io = ImGui::GetIO();
  const float width = std::min(std::floor(kPanelWidth * overlay_unit()), io.DisplaySize.x);
  const bool beside = settings.panel && io.DisplaySize.x - width >= kLeastPicture * io.DisplaySize.x;
  const float left = io.DisplaySize.x - width;
  const float free_width = beside ? left : io.DisplaySize.x;
  const bool panel = settings.panel;
  draw_banner(status, {0, 0}, {panel ? std::max(left, 1.0f) : free_width, io.DisplaySize.y});
  if (panel) draw_panel(settings, status, left, width, result);
  draw_help(settings, {free_width, io.DisplaySize.y});
  const float pixels = io.DisplayFramebufferScale.x;
  result.picture_area = {0, 0, int(std::lround(free_width * pixels)),
                         int(std::lround(io.DisplaySize.y * pixels))};
  return result;
}

}  // namespace penumbra
