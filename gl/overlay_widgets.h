// Widgets that several parts of the panel share. They require a frame of ImGui.
#pragma once

#include <imgui.h>

#include <array>
#include <string>

#include "gl/actions.h"
#include "gl/overlay_style.h"

namespace penumbra {

/// Disables what is drawn during its lifetime if `why` is not empty; `tooltip` then shows it at the item
/// drawn last.
class DisabledWhile {
 public:
  explicit DisabledWhile(const std::string& why) : why_(why) { ImGui::BeginDisabled(!why.empty()); }
  ~DisabledWhile() { ImGui::EndDisabled(); }
  DisabledWhile(const DisabledWhile&) = delete;
  DisabledWhile& operator=(const DisabledWhile&) = delete;
  /// While the mouse is over the last item: shows why the item is disabled, else `text` if it is not empty.
  void tooltip(const std::string& text) const;

 private:
  std::string why_;
};

/// Shown while the mouse is over the last item, disabled or not.
void tooltip(const std::string& text);
/// A heading that folds what follows; returns whether it is open. What follows `###` in the title identifies
/// it.
bool section(const char* title, bool open = true);
/// A dim label; the next item is in a column of its own that ends at the panel's edge.
void labelled(const char* label);
/// A slider without a number on it, and a field for the number beside it. A right click on the slider resets
/// it to `usual`. Returns whether the value has changed.
bool number_slider(const char* name, float& value, float low, float high, const char* format, float usual);
/// Text in a colour, wrapped at the panel's edge.
void wrapped(const ImVec4& color, const std::string& text);
/// A tooltip's text and the key of the action.
std::string with_key(std::string text, Action action);
/// A label and a value in columns.
void fact(const char* label, const std::string& value);
ImU32 packed(const std::array<float, 3>& srgb);

}  // namespace penumbra
