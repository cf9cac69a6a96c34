// A GLFW window with OpenGL 3.3 core and Dear ImGui: input, a framebuffer to draw into, and display.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/actions.h"
#include "gl/gl_objects.h"
#include "kernels/host/error.h"

struct GLFWwindow;

namespace penumbra {

struct WindowOptions {
  std::string title = "Penumbra";
  int width = 1280, height = 800;  ///< of the picture: in pixels if hidden, else in the desktop's units
  bool visible = true;             ///< a hidden window also needs a display, but shows nothing
  bool debug = false;              ///< request the driver's checks of all calls
  /// Pixels per pixel of a plain display. Default: the desktop's; 1 if hidden.
  std::optional<float> content_scale{};
};

/// Events since the last poll, without those for the panel. Distances are in framebuffer pixels, to the right
/// and downwards.
struct WindowEvents {
  std::vector<Action> actions;          ///< from keys, in order
  double orbit_x = 0, orbit_y = 0;      ///< drags with the left button
  double pan_x = 0, pan_y = 0;          ///< drags with the middle button, or with shift and the left button
  double picture_x = 0, picture_y = 0;  ///< drags with the right button, or with control and the left button
  double wheel = 0;                     ///< notches; positive: away from the user, the camera moves closer
  double zoom = 0;                      ///< notches with control
  bool pointer_moved = false;           ///< also without a drag, and over the panel; not counted by any()
  bool resized = false;
  bool close = false;

  [[nodiscard]] bool any() const {
    return !actions.empty() || orbit_x != 0 || orbit_y != 0 || pan_x != 0 || pan_y != 0 || picture_x != 0 ||
           picture_y != 0 || wheel != 0 || zoom != 0 || resized || close;
  }
};

/// Red, green and blue, 8 bits each, row by row from the top.
struct FramePixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// A frame consists of poll(), begin_frame(), the panel (ImGui calls), the picture into framebuffer(),
/// end_frame(): the panel is laid out before the picture and drawn over it. Only one window has ImGui at a
/// time; its context and OpenGL's are current from create() on. To be used on the main thread.
class Window {
 public:
  /// Errors: there is no display, or it has no OpenGL 3.3; the text says what would help.
  static Expected<Window> create(const WindowOptions& options);
  ~Window();
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;

  /// Waits up to `wait_seconds` for events, or until wake(). Keys are looked up in all_actions() by their
  /// labels, unless Alt or the system's key is held; with Ctrl as "ctrl+" and the label.
  WindowEvents poll(double wait_seconds = 0);
  /// Ends the waiting of poll(). May be called on any thread while a window exists.
  static void wake();
  /// The mouse's place, in framebuffer pixels; nothing while it is over the panel or outside.
  [[nodiscard]] std::optional<std::array<double, 2>> pointer() const;
  /// From now on pointer() is there, for scripts.
  void point_at(double x, double y);

  /// Size of the framebuffer, in pixels.
  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  /// Pixels per pixel of a plain display, for fonts and line widths.
  [[nodiscard]] float content_scale() const;

  /// Clears the picture to the background and begins an ImGui frame.
  void begin_frame();
  /// The framebuffer to draw into: RGBA8, width() × height(). It is not the screen's own, whose contents are
  /// undefined if the window is hidden or covered.
  [[nodiscard]] GLuint framebuffer() const;
  /// Draws the panel and shows the frame. Waits for the display if the window is visible.
  void end_frame();

  /// Requests another size, in pixels; the desktop may choose a different one. Errors: not within 1 … 16384.
  Expected<void> resize(int width, int height);
  void set_title(const std::string& title);
  void set_clipboard(const std::string& text);

  /// The last finished frame.
  [[nodiscard]] FramePixels read_pixels() const;

  /// OpenGL errors since the last call, at most a hundred; the driver's own texts if it has KHR_debug and
  /// `debug` was requested.
  std::vector<std::string> take_gl_errors();

  [[nodiscard]] GLFWwindow* handle() const;

  struct State;  ///< of the implementation

 private:
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The name in all_actions() of a GLFW key that types `printed` ("" for nothing; case is ignored). Empty if
/// it has none.
std::string key_name(int glfw_key, const std::string& printed);

}  // namespace penumbra
