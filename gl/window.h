// A window of GLFW with OpenGL 3.3 core and Dear ImGui in it: what people do, where to draw, what it shows.
#pragma once

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
  int width = 1280, height = 800;  ///< of the picture: pixels if hidden, else as the desktop counts
  bool visible = true;             ///< a hidden window needs a display all the same, but shows nothing on it
  bool debug = false;              ///< ask the driver to check all that is called
  /// Pixels for what is one on a plain display. Nothing: as the desktop says; 1 if hidden.
  std::optional<float> content_scale{};
};

/// What happened since the last poll, less what was meant for the panel. Distances are in pixels of the
/// framebuffer, to the right and downwards.
struct WindowEvents {
  std::vector<Action> actions;      ///< of keys, in order
  double orbit_x = 0, orbit_y = 0;  ///< drags with the left button
  double pan_x = 0, pan_y = 0;      ///< drags with the middle button, or with shift and the left one
  double wheel = 0;                 ///< notches, away from the person: closer
  bool resized = false;
  bool close = false;

  [[nodiscard]] bool any() const {
    return !actions.empty() || orbit_x != 0 || orbit_y != 0 || pan_x != 0 || pan_y != 0 || wheel != 0 ||
           resized || close;
  }
};

/// Red, green and blue, 8 bits each, row by row from the top.
struct FramePixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// A frame is poll(), begin_frame(), the panel (ImGui calls), the picture into framebuffer(), end_frame():
/// the panel is laid out before the picture and drawn over it. One window has ImGui at a time; its context
/// and OpenGL's are current from create() on. For the thread that is main().
class Window {
 public:
  /// Errors: no display, or no OpenGL 3.3 on it; the text says what would help.
  static Expected<Window> create(const WindowOptions& options);
  ~Window();
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;

  /// Waits up to `wait_seconds` for something to happen. Keys are looked up in all_actions() by what is
  /// printed on them; none counts while Ctrl, Alt or the system's key is held.
  WindowEvents poll(double wait_seconds = 0);

  /// Of the framebuffer, in pixels.
  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  /// Pixels for what is one on a plain display: for fonts and line widths.
  [[nodiscard]] float content_scale() const;

  /// Clears the picture to the background and begins a frame of ImGui.
  void begin_frame();
  /// What to draw into: RGBA8, width() × height(). Not the screen's own, whose contents are undefined where
  /// the window is hidden or covered.
  [[nodiscard]] GLuint framebuffer() const;
  /// Draws the panel and shows the frame; waits for the display if the window is visible.
  void end_frame();

  /// Asks for another size, in pixels; the desktop may give another one. Errors: not within 1 … 16384.
  Expected<void> resize(int width, int height);
  void set_title(const std::string& title);

  /// The last frame that ended.
  [[nodiscard]] FramePixels read_pixels() const;

  /// What OpenGL complained of since the last call, at most a hundred; texts of the driver's own where it has
  /// KHR_debug and `debug` was asked for.
  std::vector<std::string> take_gl_errors();

  [[nodiscard]] GLFWwindow* handle() const;

  struct State;  ///< of the implementation

 private:
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The name by which all_actions() knows a key of GLFW that types `printed` ("" if nothing; a letter in
/// either case). Empty if it has none.
std::string key_name(int glfw_key, const std::string& printed);

}  // namespace penumbra
