// What several parts of the panel are made of; needs a frame of ImGui.
#pragma once

#include <imgui.h>

#include <array>
#include <string>

#include "gl/overlay_style.h"

namespace penumbra {

/// While it lives, what is drawn is disabled if `why` says something; `tooltip` then shows it at the item
/// drawn last.
class DisabledWhile {
 public:
  explicit DisabledWhile(const std::string& why) : why_(why) { ImGui::BeginDisabled(!why.empty()); }
  ~DisabledWhile() { ImGui::EndDisabled(); }
  DisabledWhile(const DisabledWhile&) = delete;
  DisabledWhile& operator=(const DisabledWhile&) = delete;
  /// Why the last item is disabled, else `text` (nothing if empty), while the mouse is over it.
  void tooltip(const std::string& text) const;

 private:
  std::string why_;
};

/// While the mouse is over the last item, disabled or not.
void tooltip(const std::string& text);
void section(const char* title);
/// A dim label, then what comes next in a column of its own that ends at the panel's edge.
void labelled(const char* label);
/// A label and a value below each other in columns.
void fact(const char* label, const std::string& value);
ImU32 packed(const std::array<float, 3>& srgb);

}  // namespace penumbra
