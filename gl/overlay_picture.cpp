#include "gl/overlay_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gl/overlay_text.h"
#include "gl/overlay_widgets.h"
#include "gl/shown_as.h"
#include "scheduler/image/metrics/color_map.h"
#include "scheduler/image/tone_map.h"

namespace penumbra {
namespace {

/// A mark of a colour scale.
struct Tick {
  double place;  ///< in [0, 1]
  std::string label;
};

using ColorAt = std::function<std::array<float, 3>(double)>;  ///< sRGB signal

void draw_bar(const ColorAt& color_at, const std::vector<Tick>& ticks) {
  const float unit = overlay_unit(), height = 12 * unit;
  const float width = std::max(ImGui::GetContentRegionAvail().x, 20 * unit);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  constexpr int kSteps = 64;
  for (int i = 0; i < kSteps; ++i) {
    const ImU32 left = packed(color_at(double(i) / kSteps)), right = packed(color_at(double(i + 1) / kSteps));
    const float x = corner.x + width * float(i) / kSteps;
    list.AddRectFilledMultiColor({x, corner.y}, {corner.x + width * float(i + 1) / kSteps, corner.y + height},
                                 left, right, right, left);
  }
  for (const Tick& tick : ticks) {
    const float x = corner.x + width * float(tick.place);
    const float text_width = ImGui::CalcTextSize(tick.label.c_str()).x;
    list.AddLine({x, corner.y + height}, {x, corner.y + height + 3 * unit},
                 ImGui::GetColorU32(overlay_color::kDim), unit);
    const float text_x =
        std::clamp(x - 0.5f * text_width, corner.x, std::max(corner.x, corner.x + width - text_width));
    list.AddText({std::floor(text_x), corner.y + height + 3 * unit}, ImGui::GetColorU32(overlay_color::kDim),
                 tick.label.c_str());
  }
  ImGui::Dummy({width, height + 3 * unit + ImGui::GetTextLineHeight()});
}

std::array<float, 3> heat_signal(double t) {
  std::array<float, 3> color = heat_color(t);
  for (float& channel : color) channel = float(srgb_from_linear(std::clamp(double(channel), 0.0, 1.0)));
  return color;
}

void draw_heat_legend(const ShownAs& shown) {
  std::vector<Tick> ticks;
  const double low = double(shown.log10_low), span = double(shown.log10_high) - low;
  const auto label = [&](double log10) {
    const double value = std::pow(10.0, log10);
    return shown.is_share ? percent_text(value) : fmt::format("{:.2g}", value);
  };
  // Decades, if the ends are some; else the ends and the middle.
  const int decades = int(std::lround(span));
  const bool is_whole = decades > 0 && decades <= 6 && std::abs(span - decades) < 1e-3;
  const int steps = is_whole ? decades : 2;
  for (int i = 0; i <= steps; ++i) ticks.push_back({double(i) / steps, label(low + span * i / steps)});
  draw_bar(heat_signal, ticks);
}

void draw_difference_legend(const DisplaySettings& settings) {
  const double white = std::exp2(-double(settings.exposure));
  const ColorAt grey = [](double t) {
    const double side = 2 * t - 1;
    const float signal = float(0.5 + 0.5 * std::copysign(srgb_from_linear(std::abs(side)), side));
    return std::array<float, 3>{signal, signal, signal};
  };
  draw_bar(grey, {{0, fmt::format("{:.2g}", -white)}, {0.5, "0"}, {1, fmt::format("+{:.2g}", white)}});
}

/// For colour maps and differences; nothing for other layers. Requires a frame of ImGui.
void draw_legend(const DisplaySettings& settings, const ShownAs& shown) {
  if (shown.display == Display::kHeat) draw_heat_legend(shown);
  if (shown.display == Display::kSigned) draw_difference_legend(settings);
}

constexpr float kLeastAlpha = -1, kMostAlpha = 2;
constexpr float kAlphaSnap = 0.05f;  // a drag that ends this close to 0 or 1 snaps to it
constexpr float kMostStops = 20;

float second_column() {
  return 0.5f * (ImGui::GetWindowContentRegionMin().x + ImGui::GetWindowContentRegionMax().x);
}

void layer_button(DisplaySettings& settings, const ViewStatus& status, Layer layer, const char* name,
                  const char* about, Action action) {
  const bool needs_closed_form = layer == Layer::kAnalytic || layer == Layer::kDifference;
  const DisabledWhile off(needs_closed_form ? why_no_closed_form(status) : "");
  if (ImGui::RadioButton(name, settings.layer == layer)) settings.layer = layer;
  off.tooltip(with_key(about, action));
}

void draw_layers(DisplaySettings& settings, const ViewStatus& status) {
  layer_button(settings, status, Layer::kComposite, "image", "What is rendered", Action::kShowComposite);
  ImGui::SameLine(second_column());
  layer_button(settings, status, Layer::kError, "standard error",
               "Of the mean of each pixel, from two samples on", Action::kShowError);
  if (status.hybrid) {
    layer_button(settings, status, Layer::kAnalytic, "closed form",
                 "Light without shadows and without noise, drawn here", Action::kShowAnalytic);
    ImGui::SameLine(second_column());
    layer_button(settings, status, Layer::kDifference, "difference",
                 "What samples add to the closed form: grey is nothing", Action::kShowDifference);
  }
  if (status.named_layers.empty()) return;
  labelled("layer");
  ImGui::SetNextItemWidth(-1);
  const bool is_named = settings.layer == Layer::kNamed;
  const bool is_image = settings.layer == Layer::kComposite;
  const char* chosen = is_named ? settings.named.c_str() : is_image ? "image" : "none of these";
  if (ImGui::BeginCombo("##layer", chosen)) {
    if (ImGui::Selectable("image", is_image)) settings.layer = Layer::kComposite;
    for (const std::string& name : status.named_layers)
      if (ImGui::Selectable(name.c_str(), is_named && settings.named == name)) {
        settings.layer = Layer::kNamed;
        settings.named = name;
      }
    ImGui::EndCombo();
  }
  tooltip(with_key("Layers of the render, or of the file", Action::kNextLayer));
}

void draw_tone_map(DisplaySettings& settings, const ShownAs& shown) {
  const bool applies = shown.display == Display::kColor;
  {
    const DisabledWhile off(applies ? "" : "Tone maps are for colours.");
    labelled("tone map");
    ImGui::SetNextItemWidth(-1);
    const int chosen = int(settings.tone_map);
    if (ImGui::BeginCombo("##tone map", kToneOperatorNames[std::size_t(chosen)].data())) {
      for (std::size_t i = 0; i < kToneOperatorNames.size(); ++i)
        if (ImGui::Selectable(kToneOperatorNames[i].data(), int(i) == chosen))
          settings.tone_map = ToneOperator(i);
      ImGui::EndCombo();
    }
    off.tooltip(with_key("How bright values fit the display", Action::kNextToneMap));
  }
  const DisabledWhile off(applies || settings.false_color ? "" : "False colour is for colours.");
  ImGui::Checkbox("false colour", &settings.false_color);
  off.tooltip(with_key("Brightness by a colour map", Action::kToggleFalseColor));
}

void draw_alpha(DisplaySettings& settings, const ViewStatus& status, OverlayResult& result) {
  const DisabledWhile off(why_no_alpha(status));
  labelled("alpha");
  result.alpha_changed |= number_slider("alpha", settings.alpha, kLeastAlpha, kMostAlpha, "%.2f", 1);
  if (result.alpha_changed && !ImGui::GetIO().WantTextInput) {
    for (const float round : {0.0f, 1.0f})
      if (std::abs(settings.alpha - round) < kAlphaSnap) settings.alpha = round;
  }
  off.tooltip(with_key(
      "How much of the closed form the estimate leans on: 0 is plain samples, 1 the usual control variate",
      Action::kAlphaUp));
}

void draw_zoom(DisplaySettings& settings, OverlayResult& result) {
  labelled("size");
  if (ImGui::Button("fit")) settings.view = {};
  tooltip(with_key("As large as fits into the window", Action::kFit));
  ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
  if (ImGui::Button("1:1")) result.actions.push_back(Action::kActualSize);
  tooltip(with_key("One screen pixel per pixel", Action::kActualSize));
  for (const Action action : {Action::kZoomOut, Action::kZoomIn}) {
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    if (ImGui::Button(action == Action::kZoomOut ? "−" : "+")) result.actions.push_back(action);
    tooltip(with_key(std::string(info_of(action).help), action));
  }
}

}  // namespace

void draw_picture_settings(DisplaySettings& settings, const ViewStatus& status, const ShownAs& shown,
                           OverlayResult& result) {
  if (!section("Picture")) return;
  draw_layers(settings, status);
  draw_legend(settings, shown);
  if (settings.layer == Layer::kError) {
    if (ImGui::RadioButton("relative", settings.relative_error)) settings.relative_error = true;
    tooltip("Over the brightness of the pixel");
    ImGui::SameLine(second_column());
    if (ImGui::RadioButton("absolute", !settings.relative_error)) settings.relative_error = false;
    tooltip("In units of radiance; the scale goes with the exposure");
  }
  labelled("exposure");
  number_slider("exposure", settings.exposure, -10, 10, "%+.2f", 0);
  settings.exposure = std::clamp(settings.exposure, -kMostStops, kMostStops);
  tooltip(fmt::format("Radiance times 2^exposure (keys: {} and {})", key_text(info_of(Action::kBrighter).key),
                      key_text(info_of(Action::kDarker).key)));
  draw_tone_map(settings, shown);
  ImGui::SameLine(second_column());
  {
    const DisabledWhile off(settings.layer == Layer::kComposite ? "" : "Only the image is denoised.");
    ImGui::Checkbox("denoise", &settings.denoise);
    off.tooltip(with_key("Non-local means, by the standard error of each pixel", Action::kToggleDenoising));
  }
  draw_zoom(settings, result);
  if (status.hybrid) draw_alpha(settings, status, result);
}

void draw_comparison(DisplaySettings& settings, const ViewStatus& status, OverlayResult& result) {
  if (!section("Comparison", !status.reference.empty())) return;
  if (ImGui::Button("keep as reference")) result.actions.push_back(Action::kKeepReference);
  tooltip(with_key("Keep what is shown now, to compare with later; --reference FILE opens a file",
                   Action::kKeepReference));
  if (status.reference.empty()) return;
  wrapped(overlay_color::kDim, status.reference);
  static constexpr std::array<std::pair<ShownComparison, const char*>, 4> kChoices{
      {{ShownComparison::kNone, "picture"},
       {ShownComparison::kReference, "reference"},
       {ShownComparison::kDifference, "difference"},
       {ShownComparison::kRelativeError, "relative error"}}};
  for (std::size_t i = 0; i < kChoices.size(); ++i) {
    if (i % 2 == 1) ImGui::SameLine(second_column());
    if (ImGui::RadioButton(kChoices[i].second, settings.comparison == kChoices[i].first))
      settings.comparison = kChoices[i].first;
    tooltip(with_key(std::string(kChoices[i].second),
                     i < 2 ? Action::kToggleReference : Action::kNextComparison));
  }
  if (!status.difference) return;
  if (!ImGui::BeginTable("difference", 2)) return;
  ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthFixed, 132 * overlay_unit());
  ImGui::TableSetupColumn("how much", ImGuiTableColumnFlags_WidthStretch);
  fact("relMSE", fmt::format("{:.3g}", status.difference->relmse));
  fact("mean difference", fmt::format("{:+.3g}", status.difference->mean));
  ImGui::EndTable();
}

bool draw_histogram(const ViewStatus& status) {
  if (!section("Histogram", false)) return false;
  const Histogram& histogram = status.histogram;
  const float unit = overlay_unit(), height = 64 * unit;
  const float width = std::max(ImGui::GetContentRegionAvail().x, 20 * unit);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(corner, {corner.x + width, corner.y + height}, ImGui::GetColorU32(ImGuiCol_ChildBg));
  const float most = std::max(*std::ranges::max_element(histogram.counts), 1.0f);
  const float step = width / Histogram::kBins;
  for (int i = 0; i < Histogram::kBins; ++i) {
    const float share = histogram.counts[std::size_t(i)] / most;
    if (share <= 0) continue;
    list.AddRectFilled({corner.x + step * float(i), corner.y + height * (1 - share)},
                       {corner.x + step * float(i + 1), corner.y + height},
                       ImGui::GetColorU32(ImGuiCol_PlotHistogram));
  }
  constexpr float kStops = Histogram::kHighestStop - Histogram::kLowestStop;
  const float white = corner.x + width * -Histogram::kLowestStop / kStops;
  list.AddLine({white, corner.y}, {white, corner.y + height}, ImGui::GetColorU32(overlay_color::kDim), unit);
  ImGui::Dummy({width, height});
  tooltip("Luminance in stops, with the exposure; the line is white");
  std::string text = fmt::format("{:+.0f} to {:+.0f} stops about white", double(Histogram::kLowestStop),
                                 double(Histogram::kHighestStop));
  if (histogram.not_positive > 0)
    text += fmt::format("; {} black", count_text(double(histogram.not_positive)));
  wrapped(overlay_color::kDim, text);
  if (histogram.not_finite > 0)
    wrapped(overlay_color::kBad,
            fmt::format("{} not finite: magenta", count_text(double(histogram.not_finite))));
  return true;
}

void draw_pixel(const ViewStatus& status, const ImVec2& free) {
  if (!status.pixel) return;
  const PixelValue& pixel = *status.pixel;
  std::string text = fmt::format("{}, {}   {:.4g}  {:.4g}  {:.4g}", pixel.x, pixel.y, pixel.value[0],
                                 pixel.value[1], pixel.value[2]);
  if (!pixel.of.empty()) text += fmt::format("   {}", pixel.of);
  if (pixel.standard_error) text += fmt::format("   ± {:.2g}", *pixel.standard_error);
  if (pixel.samples > 0) text += fmt::format("   {} samples", count_text(double(pixel.samples)));
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
                                      ImGuiWindowFlags_AlwaysAutoResize;
  ImGui::SetNextWindowPos({0, free.y}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowBgAlpha(0.85f);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {8 * overlay_unit(), 4 * overlay_unit()});
  if (ImGui::Begin("Pixel", nullptr, kFlags)) ImGui::TextUnformatted(text.c_str());
  ImGui::End();
  ImGui::PopStyleVar();
}

}  // namespace penumbra
