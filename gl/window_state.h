// State shared by the files that implement Window; nothing else includes it.
#pragma once

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gl/gl_objects.h"
#include "gl/window.h"

struct ImGuiContext;

namespace penumbra {

enum class Drag { kNone, kOrbit, kPan, kPicture };

struct Window::State {
  GLFWwindow* window = nullptr;
  ImGuiContext* imgui = nullptr;
  bool visible = true;
  bool fixed_scale = false;  ///< the scale was given, it is not the desktop's
  float scale = 1;
  bool fonts_outdated = true;
  int width = 0, height = 0;  ///< of the framebuffer
  bool debug_output = false;
  std::vector<std::string> gl_errors;

  WindowEvents events;
  Drag drag = Drag::kNone;
  int drag_button = -1;
  double cursor_x = 0, cursor_y = 0;  ///< in GLFW's coordinates, at the last event
  std::optional<std::array<double, 2>> given_pointer = {};

  Texture picture;
  Framebuffer target;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();
  /// Framebuffer pixels per GLFW coordinate.
  [[nodiscard]] double pixels_per_coordinate() const;
};

/// Installs GLFW's callbacks. ImGui's are installed later and call these first.
void install_input_callbacks(Window::State& state);

}  // namespace penumbra
