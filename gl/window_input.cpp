// Input to the window.
#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <cctype>
#include <utility>

#include "gl/window_state.h"

namespace penumbra {
namespace {

Window::State& state_of(GLFWwindow* window) {
  return *static_cast<Window::State*>(glfwGetWindowUserPointer(window));
}

/// ImGui's context is current as long as the window exists.
bool panel_wants_mouse() { return ImGui::GetIO().WantCaptureMouse; }
bool panel_wants_keyboard() { return ImGui::GetIO().WantCaptureKeyboard || ImGui::GetIO().WantTextInput; }

void on_key(GLFWwindow* window, int key, int scancode, int happened, int modifiers) {
  if (happened == GLFW_RELEASE || panel_wants_keyboard()) return;
  if ((modifiers & (GLFW_MOD_ALT | GLFW_MOD_SUPER)) != 0) return;
  const char* printed = glfwGetKeyName(key, scancode);
  // Letters with Ctrl are named by what they print alone.
  const bool with_control = (modifiers & GLFW_MOD_CONTROL) != 0;
  const std::string name = with_control ? fmt::format("ctrl+{}", printed == nullptr ? "" : printed)
                                        : key_name(key, printed == nullptr ? "" : printed);
  const auto action = action_of_key(name);
  if (!action) return;
  if (happened == GLFW_REPEAT && !info_of(*action).repeats) return;
  state_of(window).events.actions.push_back(*action);
}

void on_mouse_button(GLFWwindow* window, int button, int happened, int modifiers) {
  Window::State& state = state_of(window);
  if (happened == GLFW_RELEASE) {
    if (button == state.drag_button) state.drag = Drag::kNone;
    return;
  }
  if (state.drag != Drag::kNone || panel_wants_mouse()) return;
  const bool shift = (modifiers & GLFW_MOD_SHIFT) != 0, control = (modifiers & GLFW_MOD_CONTROL) != 0;
  if (button == GLFW_MOUSE_BUTTON_RIGHT || (button == GLFW_MOUSE_BUTTON_LEFT && control))
    state.drag = Drag::kPicture;
  else if (button == GLFW_MOUSE_BUTTON_MIDDLE || (button == GLFW_MOUSE_BUTTON_LEFT && shift))
    state.drag = Drag::kPan;
  else if (button == GLFW_MOUSE_BUTTON_LEFT)
    state.drag = Drag::kOrbit;
  state.drag_button = button;
  glfwGetCursorPos(window, &state.cursor_x, &state.cursor_y);
}

void on_cursor(GLFWwindow* window, double x, double y) {
  Window::State& state = state_of(window);
  const double scale = state.pixels_per_coordinate();
  state.events.pointer_moved = true;
  const std::array<double, 2> by{scale * (x - state.cursor_x), scale * (y - state.cursor_y)};
  WindowEvents& events = state.events;
  const auto add = [&by](double& to_x, double& to_y) { to_x += by[0], to_y += by[1]; };
  if (state.drag == Drag::kOrbit) add(events.orbit_x, events.orbit_y);
  if (state.drag == Drag::kPan) add(events.pan_x, events.pan_y);
  if (state.drag == Drag::kPicture) add(events.picture_x, events.picture_y);
  state.cursor_x = x;
  state.cursor_y = y;
}

void on_wheel(GLFWwindow* window, double, double y) {
  if (panel_wants_mouse()) return;
  WindowEvents& events = state_of(window).events;
  const bool control = glfwGetKey(window, GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS ||
                       glfwGetKey(window, GLFW_KEY_RIGHT_CONTROL) == GLFW_PRESS;
  (control ? events.zoom : events.wheel) += y;
}

void on_framebuffer_size(GLFWwindow* window, int width, int height) {
  Window::State& state = state_of(window);
  // Minimised windows have no size: the old one is kept. Hidden windows have the requested size.
  if (!state.visible || width < 1 || height < 1) return;
  if (width == state.width && height == state.height) return;
  state.width = width;
  state.height = height;
  state.events.resized = true;
}

void on_content_scale(GLFWwindow* window, float x, float) {
  Window::State& state = state_of(window);
  if (state.fixed_scale || x <= 0 || x == state.scale) return;
  state.scale = x;
  state.fonts_outdated = true;
}

void on_close(GLFWwindow* window) { state_of(window).events.close = true; }

void on_focus(GLFWwindow* window, int focused) {
  // The button's release is sent to another window.
  if (focused == GLFW_FALSE) state_of(window).drag = Drag::kNone;
}

constexpr auto kKeyNames = std::to_array<std::pair<int, std::string_view>>({
    {GLFW_KEY_SPACE, "space"},
    {GLFW_KEY_LEFT, "left"},
    {GLFW_KEY_RIGHT, "right"},
    {GLFW_KEY_UP, "up"},
    {GLFW_KEY_DOWN, "down"},
    {GLFW_KEY_PAGE_UP, "page_up"},
    {GLFW_KEY_PAGE_DOWN, "page_down"},
    {GLFW_KEY_HOME, "home"},
    {GLFW_KEY_END, "end"},
    {GLFW_KEY_INSERT, "insert"},
    {GLFW_KEY_DELETE, "delete"},
    {GLFW_KEY_BACKSPACE, "backspace"},
    {GLFW_KEY_ENTER, "enter"},
    {GLFW_KEY_KP_ENTER, "enter"},
    {GLFW_KEY_TAB, "tab"},
    {GLFW_KEY_ESCAPE, "escape"},
    {GLFW_KEY_KP_ADD, "kp_add"},
    {GLFW_KEY_KP_SUBTRACT, "kp_subtract"},
});

}  // namespace

std::string key_name(int glfw_key, const std::string& printed) {
  for (const auto& [key, name] : kKeyNames) {
    if (key == glfw_key) return std::string(name);
  }
  if (glfw_key >= GLFW_KEY_F1 && glfw_key <= GLFW_KEY_F25)
    return fmt::format("f{}", glfw_key - GLFW_KEY_F1 + 1);
  if (glfw_key >= GLFW_KEY_KP_0 && glfw_key <= GLFW_KEY_KP_9) return std::to_string(glfw_key - GLFW_KEY_KP_0);
  // Some keyboards type the digits of this row only with shift.
  if (glfw_key >= GLFW_KEY_0 && glfw_key <= GLFW_KEY_9) return std::to_string(glfw_key - GLFW_KEY_0);
  // Accepts what action_of_key() accepts: it knows aliases such as "-" and "[", and ignores case.
  if (!printed.empty() && action_of_key(printed)) return printed;
  // For brackets and similar keys the position on a US keyboard is used if the label gives no action.
  switch (glfw_key) {
    case GLFW_KEY_LEFT_BRACKET:
      return "left_bracket";
    case GLFW_KEY_RIGHT_BRACKET:
      return "right_bracket";
    case GLFW_KEY_MINUS:
      return "minus";
    case GLFW_KEY_EQUAL:
      return "equal";
    default:
      return printed;
  }
}

void install_input_callbacks(Window::State& state) {
  glfwSetWindowUserPointer(state.window, &state);
  glfwSetKeyCallback(state.window, on_key);
  glfwSetMouseButtonCallback(state.window, on_mouse_button);
  glfwSetCursorPosCallback(state.window, on_cursor);
  glfwSetScrollCallback(state.window, on_wheel);
  glfwSetFramebufferSizeCallback(state.window, on_framebuffer_size);
  glfwSetWindowContentScaleCallback(state.window, on_content_scale);
  glfwSetWindowCloseCallback(state.window, on_close);
  glfwSetWindowFocusCallback(state.window, on_focus);
}

WindowEvents Window::poll(double wait_seconds) {
  if (wait_seconds > 0) {
    glfwWaitEventsTimeout(wait_seconds);
  } else {
    glfwPollEvents();
  }
  glfwSetWindowShouldClose(state_->window, GLFW_FALSE);  // the caller decides
  return std::exchange(state_->events, {});
}

void Window::wake() { glfwPostEmptyEvent(); }

std::optional<std::array<double, 2>> Window::pointer() const {
  if (state_->given_pointer) return state_->given_pointer;
  if (!state_->visible || panel_wants_mouse() ||
      glfwGetWindowAttrib(state_->window, GLFW_HOVERED) == GLFW_FALSE)
    return std::nullopt;
  double x = 0, y = 0;
  glfwGetCursorPos(state_->window, &x, &y);
  const double scale = state_->pixels_per_coordinate();
  return std::array{scale * x, scale * y};
}

void Window::point_at(double x, double y) { state_->given_pointer = {x, y}; }

}  // namespace penumbra
