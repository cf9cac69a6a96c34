#include "gl/overlay_widgets.h"

#include <algorithm>

namespace penumbra {

void tooltip(const std::string& text) {
  if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const float width = std::min(260 * overlay_unit(), ImGui::GetIO().DisplaySize.x - 24 * overlay_unit());
  // The tooltip of a disabled item must not be dimmed.
  ImGui::PushStyleVar(ImGuiStyleVar_Alpha, 1.0f);
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(std::max(width, 40 * overlay_unit()));
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
  ImGui::PopStyleVar();
}

void DisabledWhile::tooltip(const std::string& text) const { penumbra::tooltip(why_.empty() ? text : why_); }

void section(const char* title) {
  ImGui::Dummy({0, 3 * overlay_unit()});
  ImGui::TextColored(overlay_color::kAccent, "%s", title);
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const float y = 0.5f * (low.y + high.y);
  const float right = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  const float left = high.x + 8 * overlay_unit();
  if (left < right) {
    ImGui::GetWindowDrawList()->AddLine({left, y}, {right, y}, ImGui::GetColorU32(ImGuiCol_Separator),
                                        std::max(1.0f, overlay_unit()));
  }
}

void labelled(const char* label) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(overlay_color::kDim, "%s", label);
  ImGui::SameLine(74 * overlay_unit() + ImGui::GetStyle().WindowPadding.x);
}

void fact(const char* label, const std::string& value) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextColored(overlay_color::kDim, "%s", label);
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(value.c_str());
}

ImU32 packed(const std::array<float, 3>& srgb) {
  return ImGui::ColorConvertFloat4ToU32({srgb[0], srgb[1], srgb[2], 1});
}

}  // namespace penumbra
