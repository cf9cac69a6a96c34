#include "gl/overlay_widgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gl/overlay_text.h"

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

bool section(const char* title, bool open) {
  ImGui::Dummy({0, 2 * overlay_unit()});
  ImGui::PushStyleColor(ImGuiCol_Text, overlay_color::kAccent);
  ImGui::PushStyleColor(ImGuiCol_Header, {0, 0, 0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0, 2 * overlay_unit()});
  const bool is_open = ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  ImGui::PopStyleVar();
  ImGui::PopStyleColor(2);
  return is_open;
}

bool number_slider(const char* name, float& value, float low, float high, const char* format, float usual) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float before = value;
  const float field = ImGui::CalcTextSize("+00.00").x + 2 * style.FramePadding.x;
  const float slider = ImGui::GetContentRegionAvail().x - field - style.ItemInnerSpacing.x;
  ImGui::PushID(name);
  ImGui::BeginGroup();
  if (slider > 2 * field / 3) {
    ImGui::SetNextItemWidth(slider);
    ImGui::SliderFloat("##slider", &value, low, high, "", ImGuiSliderFlags_NoInput);
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) value = usual;
    ImGui::SameLine(0, style.ItemInnerSpacing.x);
  }
  ImGui::SetNextItemWidth(std::min(field, ImGui::GetContentRegionAvail().x));
  ImGui::InputFloat("##number", &value, 0, 0, format);
  ImGui::EndGroup();
  ImGui::PopID();
  if (!std::isfinite(value)) value = usual;  // it may have been typed
  return value != before;
}

void wrapped(const ImVec4& color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

std::string with_key(std::string text, Action action) {
  return fmt::format("{} (key: {})", text, key_text(info_of(action).key));
}

void labelled(const char* label) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(overlay_color::kDim, "%s", label);
  ImGui::SameLine(80 * overlay_unit() + ImGui::GetStyle().WindowPadding.x);
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
