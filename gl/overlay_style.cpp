#include "gl/overlay_style.h"

#include <imgui_freetype.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace penumbra {
namespace {

constexpr float kFontSize = 15;
/// The font's place where this was built, and where distributions put it.
constexpr std::array kFontFiles{PENUMBRA_FONT, "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                                "/usr/share/fonts/TTF/DejaVuSans.ttf"};
/// Pairs of first and last character: Latin, Greek, Cyrillic, punctuation, arrows, mathematics, shapes.
constexpr std::array<ImWchar, 15> kCharacters{0x20,   0x24f,  0x370,  0x52f,  0x2010, 0x205e, 0x20a0, 0x20bf,
                                              0x2190, 0x21ff, 0x2200, 0x22ff, 0x25a0, 0x25ff, 0};

/// ImGui's own font, which has square pixels and Latin letters only, if there is no other.
void add_font(ImFontAtlas& fonts, float pixels) {
  ImFontConfig font;
  font.SizePixels = pixels;
  fonts.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
  for (const char* file : kFontFiles) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) continue;
    if (fonts.AddFontFromFileTTF(file, pixels, &font, kCharacters.data()) != nullptr) return;
  }
  fonts.AddFontDefault(&font);
}

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

  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  add_font(*io.Fonts, std::round(kFontSize * content_scale));
  io.FontGlobalScale = 1 / pixels_per_coordinate;
}

float overlay_unit() {
  const ImGuiIO& io = ImGui::GetIO();
  return io.Fonts->Fonts.empty() ? 1 : io.Fonts->Fonts[0]->FontSize * io.FontGlobalScale / kFontSize;
}

}  // namespace penumbra
