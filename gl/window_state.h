// Shared by the files that make up Window; nothing else includes it.
#pragma once

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <string>
#include <vector>

#include "gl/gl_objects.h"
#include "gl/window.h"

struct ImGuiContext;

namespace penumbra {

enum class Drag { kNone, kOrbit, kPan };

struct Window::State {
  GLFWwindow* window = nullptr;
  ImGuiContext* imgui = nullptr;
  bool visible = true;
  bool fixed_scale = false;  ///< given, not the desktop's
  float scale = 1;
  bool fonts_outdated = true;
  int width = 0, height = 0;  ///< of the framebuffer
  bool debug_output = false;
  std::vector<std::string> gl_errors;

  WindowEvents events;
  Drag drag = Drag::kNone;
  int drag_button = -1;
  double cursor_x = 0, cursor_y = 0;  ///< as GLFW counts, when the drag was last looked at

  Texture picture;
  Framebuffer target;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();
  /// Pixels of the framebuffer for one of GLFW's coordinates.
  [[nodiscard]] double pixels_per_coordinate() const;
};

/// GLFW's callbacks; ImGui's, installed later, call them first.
void install_input_callbacks(Window::State& state);

}  // namespace penumbra
