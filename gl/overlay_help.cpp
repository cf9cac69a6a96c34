#include "gl/overlay_help.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gl/actions.h"
#include "gl/overlay_text.h"
#include "gl/overlay_widgets.h"

namespace penumbra {
namespace {

constexpr auto kMouse = std::to_array<std::pair<const char*, const char*>>({
    {"left drag", "turn about the target"},
    {"middle drag", "move across the view"},
    {"shift + left drag", "the same"},
    {"wheel", "closer, farther; larger and smaller where the camera cannot move"},
    {"ctrl + wheel", "larger, smaller"},
    {"right drag", "move the picture"},
    {"ctrl + left drag", "the same"},
    {"right click", "on a slider: back to its usual value"},
});

constexpr float kHelpStep = 0.98f;       // a little smaller than the heights say, which do not all scale
constexpr float kLeastHelpScale = 0.5f;  // smaller text cannot be read; then it scrolls

/// Draws a key cap.
void key_cap(const std::string& text, float scale) {
  const float unit = overlay_unit() * scale;
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 end{corner.x + size.x + 10 * unit, corner.y + size.y + 2 * unit};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(corner, end, ImGui::GetColorU32(ImGuiCol_Button), 3 * unit);
  list.AddRect(corner, end, ImGui::GetColorU32(ImGuiCol_Border), 3 * unit, 0, unit);
  list.AddText({corner.x + 5 * unit, corner.y + unit}, ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
  ImGui::Dummy({end.x - corner.x, end.y - corner.y});
}

void help_row(const std::string& key, const std::string& help, bool cap, float scale) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  if (cap) {
    key_cap(key, scale);
  } else {
    ImGui::TextUnformatted(key.c_str());
  }
  ImGui::TableNextColumn();
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(help.c_str());
  ImGui::PopTextWrapPos();
}

void heading(const char* text) { ImGui::TextColored(overlay_color::kAccent, "%s", text); }

bool begin_columns(const char* name, float first_width) {
  if (!ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingFixedFit)) return false;
  ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, first_width);
  ImGui::TableSetupColumn("help", ImGuiTableColumnFlags_WidthStretch);
  return true;
}

void keys_of(std::span<const ActionInfo> actions, const char* name, float scale) {
  if (!begin_columns(name, 88 * overlay_unit())) return;
  for (const ActionInfo& info : actions) help_row(key_text(info.key), std::string(info.help), true, scale);
  ImGui::EndTable();
}

}  // namespace

bool draw_help(DisplaySettings& settings, const ImVec2& free) {
  if (!settings.help) return false;
  const float unit = overlay_unit();
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const bool wide = display.x >= 600 * unit;
  const float width = std::min((wide ? 740 : 400) * unit, display.x);
  const float middle = 0.5f * (width <= free.x ? free.x : display.x);
  ImGui::SetNextWindowPos({middle, 0.5f * display.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, display.y});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 5 * unit);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, unit);
  bool open = true, is_smaller = false;
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize |
                                      ImGuiWindowFlags_NoSavedSettings;
  if (ImGui::Begin("Help", &open, kFlags)) {
    // As large as fits: where lines wrap is known only once they are laid out.
    float& scale = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("scale"), 1);
    if (ImGui::IsWindowAppearing()) scale = 1;
    ImGui::SetWindowFontScale(scale);
    const ImVec2 padding = ImGui::GetStyle().CellPadding;
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {padding.x, padding.y * scale});
    const auto actions = all_actions();
    heading("Keys");
    if (wide) {
      // Keeps the camera's keys together.
      const auto camera = std::ranges::find(actions, Action::kForward, &ActionInfo::action);
      const auto half = std::size_t(camera - actions.begin());
      if (ImGui::BeginTable("halves", 2, ImGuiTableFlags_SizingStretchSame)) {
        ImGui::TableNextColumn();
        keys_of(actions.first(half), "left keys", scale);
        ImGui::TableNextColumn();
        keys_of(actions.subspan(half), "right keys", scale);
        ImGui::EndTable();
      }
    } else {
      keys_of(actions, "keys", scale);
    }
    heading("Mouse");
    if (begin_columns("mouse", 130 * unit)) {
      for (const auto& [what, help] : kMouse) help_row(what, help, false, scale);
      ImGui::EndTable();
    }
    ImGui::PopStyleVar();
    const ImGuiStyle& style = ImGui::GetStyle();
    const float height = ImGui::GetCursorPosY() + style.WindowPadding.y;
    const float room = display.y - 2 * style.DisplaySafeAreaPadding.y;
    if (height > room) {
      // Letters of whole pixels: lines of fractions would leave a bit to scroll.
      const float letter = ImGui::GetFontSize() / scale;
      const float fitting = std::floor(kHelpStep * scale * room / height * letter) / letter;
      is_smaller = fitting >= kLeastHelpScale;
      if (is_smaller) scale = fitting;
    }
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
  if (!open) settings.help = false;
  return is_smaller;
}

ImVec4 connection_color(const ViewStatus& status) {
  switch (status.connection) {
    case ConnectionState::kStarting:
      return overlay_color::kWarning;
    case ConnectionState::kConnected:
    case ConnectionState::kEnded:
    case ConnectionState::kFile:
      return overlay_color::kGood;
    case ConnectionState::kLost:
      return overlay_color::kWarning;
    case ConnectionState::kRefused:
      break;
  }
  return overlay_color::kBad;
}

void draw_banner(const ViewStatus& status, const ImVec2& corner, const ImVec2& size) {
  if (status.connection == ConnectionState::kConnected || status.connection == ConnectionState::kEnded ||
      status.connection == ConnectionState::kFile)
    return;
  const float unit = overlay_unit();
  const std::string text = connection_text(status) + (status.address.empty() ? "" : ": ") + status.address;
  const float width = std::min(ImGui::CalcTextSize(text.c_str()).x + 24 * unit, size.x - 8 * unit);
  if (width < 40 * unit) return;
  ImGui::SetNextWindowPos({corner.x + 0.5f * size.x, corner.y + 12 * unit}, ImGuiCond_Always, {0.5f, 0});
  ImGui::SetNextWindowSize({width, 0});
  ImGui::SetNextWindowBgAlpha(0.9f);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 4 * unit);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, unit);
  ImGui::PushStyleColor(ImGuiCol_Border, connection_color(status));
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav;
  if (ImGui::Begin("Connection", nullptr, kFlags)) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::End();
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(2);
}

}  // namespace penumbra
