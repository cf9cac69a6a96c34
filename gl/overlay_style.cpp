#include "gl/overlay_style.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

constexpr float kFontSize = 13;  // of ImGui's font, whose pixels match the display's at this size

void set_colors(ImGuiStyle& style) {
  const ImVec4 field{0.17f, 0.18f, 0.21f, 1}, hovered{0.24f, 0.25f, 0.29f, 1}, active{0.31f, 0.32f, 0.37f, 1};
  ImGui::StyleColorsDark(&style);
  style.Colors[ImGuiCol_Text] = overlay_color::kText;
  style.Colors[ImGuiCol_TextDisabled] = overlay_color::kDim;
  style.Colors[ImGuiCol_WindowBg] = {0.105f, 0.11f, 0.125f, 1};
  style.Colors[ImGuiCol_ChildBg] = {0.08f, 0.084f, 0.096f, 1};
  style.Colors[ImGuiCol_PopupBg] = {0.14f, 0.15f, 0.17f, 1};
  style.Colors[ImGuiCol_Border] = {0.23f, 0.24f, 0.28f, 1};
  style.Colors[ImGuiCol_Separator] = {0.23f, 0.24f, 0.28f, 1};
  style.Colors[ImGuiCol_FrameBg] = field;
  style.Colors[ImGuiCol_FrameBgHovered] = hovered;
  style.Colors[ImGuiCol_FrameBgActive] = active;
  style.Colors[ImGuiCol_Button] = field;
  style.Colors[ImGuiCol_ButtonHovered] = hovered;
  style.Colors[ImGuiCol_ButtonActive] = active;
  style.Colors[ImGuiCol_Header] = field;
  style.Colors[ImGuiCol_HeaderHovered] = hovered;
  style.Colors[ImGuiCol_HeaderActive] = active;
  style.Colors[ImGuiCol_TitleBg] = {0.14f, 0.15f, 0.17f, 1};
  style.Colors[ImGuiCol_TitleBgActive] = {0.17f, 0.18f, 0.21f, 1};
  style.Colors[ImGuiCol_CheckMark] = overlay_color::kAccent;
  style.Colors[ImGuiCol_SliderGrab] = {0.62f, 0.46f, 0.22f, 1};
  style.Colors[ImGuiCol_SliderGrabActive] = {0.72f, 0.53f, 0.25f, 1};
  style.Colors[ImGuiCol_PlotHistogram] = {0.62f, 0.46f, 0.22f, 1};
  style.Colors[ImGuiCol_ScrollbarBg] = {0.08f, 0.084f, 0.096f, 1};
}

}  // namespace

void apply_overlay_style(float content_scale, float pixels_per_coordinate) {
  ImGuiStyle style;
  style.WindowPadding = {12, 10};
  style.WindowRounding = 0;
  style.WindowBorderSize = 0;
  style.ChildRounding = 3;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.PopupRounding = 3;
  style.FramePadding = {6, 3};
  style.ItemSpacing = {8, 5};
  style.ItemInnerSpacing = {6, 4};
  style.ScrollbarSize = 11;
  style.ScrollbarRounding = 3;
  style.GrabMinSize = 12;
  style.CellPadding = {4, 2};
  style.DisabledAlpha = 0.42f;
  style.WindowMinSize = {16, 16};
  set_colors(style);
  const float unit = content_scale / pixels_per_coordinate;
  style.ScaleAllSizes(unit);
  // Dear ImGui aborts if these are smaller, which happens at the smallest scales.
  style.WindowMinSize = {std::max(style.WindowMinSize.x, 1.0f), std::max(style.WindowMinSize.y, 1.0f)};
  ImGui::GetStyle() = style;

  ImFontConfig font;
  font.SizePixels = std::round(kFontSize * content_scale);
  // At other sizes than integer multiples the font's square pixels need antialiasing.
  const bool whole = content_scale == std::round(content_scale);
  font.OversampleH = font.OversampleV = whole ? 1 : 3;
  font.PixelSnapH = true;
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  io.Fonts->AddFontDefault(&font);
  io.FontGlobalScale = 1 / pixels_per_coordinate;
}

float overlay_unit() {
  const ImGuiIO& io = ImGui::GetIO();
  return io.Fonts->Fonts.empty() ? 1 : io.Fonts->Fonts[0]->FontSize * io.FontGlobalScale / kFontSize;
}

}  // namespace penumbra
