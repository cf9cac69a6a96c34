#include "gl/overlay_legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gl/overlay_text.h"
#include "gl/overlay_widgets.h"
#include "scheduler/image/metrics/color_map.h"
#include "scheduler/image/tone_map.h"

namespace penumbra {
namespace {

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

}  // namespace

void draw_legend(const DisplaySettings& settings, const ShownAs& shown) {
  if (shown.display == Display::kHeat) draw_heat_legend(shown);
  if (shown.display == Display::kSigned) draw_difference_legend(settings);
}

}  // namespace penumbra
