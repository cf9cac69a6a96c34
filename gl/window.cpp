#include "gl/window.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "gl/overlay_style.h"
#include "gl/window_state.h"

namespace penumbra {
namespace {

constexpr int kLargestSize = 16384;
constexpr double kLeastRatio = 0.125;  // of pixels to GLFW coordinates
constexpr std::size_t kMostErrors = 100;

/// GLFW reports errors by callback; the last one explains why a call failed.
std::string& last_glfw_error() {
  static std::string text;
  return text;
}

void on_glfw_error(int, const char* text) { last_glfw_error() = text; }

Error no_window(bool opengl) {
  std::string message = fmt::format("cannot open a window: {}", last_glfw_error());
  if (opengl) {
    message +=
        "\nit needs OpenGL 3.3 core; LIBGL_ALWAYS_SOFTWARE=1 draws it with the CPU where Mesa is there";
  } else if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) {
    message +=
        "\nDISPLAY is not set: start this on a desktop, log in with `ssh -X`, or run it under `xvfb-run -a`";
  } else {
    message += "\nthe display that DISPLAY names does not answer; `xvfb-run -a` brings one of its own";
  }
  return {message};
}

void on_debug_message(GLenum, GLenum type, GLuint, GLenum severity, GLsizei length, const GLchar* text,
                      const void* user) {
  if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH) return;
  auto& errors = static_cast<Window::State*>(const_cast<void*>(user))->gl_errors;
  if (errors.size() < kMostErrors) errors.emplace_back(text, std::size_t(std::max(length, 0)));
}

void listen_to_driver(Window::State& state) {
  if (epoxy_gl_version() < 43 && !epoxy_has_gl_extension("GL_KHR_debug")) return;
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(on_debug_message, &state);
  state.debug_output = true;
}

Expected<void> make_target(Window::State& state) {
  Texture picture = make_texture(GL_RGBA8, state.width, state.height, GL_RGBA, GL_UNSIGNED_BYTE);
  auto target = make_framebuffer(std::array{picture.name()});
  if (!target) return std::unexpected(target.error());
  state.picture = std::move(picture);
  state.target = std::move(*target);
  return {};
}

void start_imgui(Window::State& state) {
  state.imgui = ImGui::CreateContext();
  ImGui::SetCurrentContext(state.imgui);
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().LogFilename = nullptr;
  ImGui_ImplGlfw_InitForOpenGL(state.window, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Expected<void> open(Window::State& state, const WindowOptions& options) {
  glfwSetErrorCallback(on_glfw_error);
  if (glfwInit() == GLFW_FALSE) return std::unexpected(no_window(false));
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, options.visible ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  state.window = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
  if (state.window == nullptr) return std::unexpected(no_window(true));
  glfwMakeContextCurrent(state.window);
  glfwSwapInterval(options.visible ? 1 : 0);
  if (options.debug) listen_to_driver(state);

  state.width = options.width;
  state.height = options.height;
  if (options.visible) glfwGetFramebufferSize(state.window, &state.width, &state.height);
  state.fixed_scale = options.content_scale.has_value() || !options.visible;
  state.scale = options.content_scale.value_or(1.0f);
  if (!state.fixed_scale) {
    float vertical = 1;
    glfwGetWindowContentScale(state.window, &state.scale, &vertical);
  }
  state.scale = std::isfinite(state.scale) ? std::clamp(state.scale, 0.5f, 8.0f) : 1.0f;
  install_input_callbacks(state);
  start_imgui(state);
  return make_target(state);
}

}  // namespace

double Window::State::pixels_per_coordinate() const {
  // Both are queried now: `width` is that of the last event, which may be older than a requested size. The
  // size may also change between the two calls; then the ratio is outside of what displays have, and is
  // clamped.
  int window_width = 0, window_height = 0, pixels_across = 0, pixels_down = 0;
  glfwGetWindowSize(window, &window_width, &window_height);
  glfwGetFramebufferSize(window, &pixels_across, &pixels_down);
  if (!visible || window_width < 1 || pixels_across < 1) return 1.0;
  return std::clamp(double(pixels_across) / window_width, kLeastRatio, 1 / kLeastRatio);
}

Window::State::~State() {
  if (window == nullptr) return;
  glfwMakeContextCurrent(window);
  if (imgui != nullptr) {
    ImGui::SetCurrentContext(imgui);
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext(imgui);
  }
  if (debug_output) glDebugMessageCallback(nullptr, nullptr);
  target = {};
  picture = {};
  // glfwTerminate is not called: other windows may be open.
  glfwDestroyWindow(window);
}

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::~Window() = default;
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;

Expected<Window> Window::create(const WindowOptions& options) {
  if (options.width < 1 || options.height < 1 || options.width > kLargestSize ||
      options.height > kLargestSize) {
    return fail(fmt::format("a window has 1 to {0} pixels in each direction, not {1} × {2}", kLargestSize,
                            options.width, options.height));
  }
  auto state = std::make_unique<State>();
  state->visible = options.visible;
  if (auto opened = open(*state, options); !opened) return std::unexpected(opened.error());
  return Window(std::move(state));
}

int Window::width() const { return state_->width; }
int Window::height() const { return state_->height; }
float Window::content_scale() const { return state_->scale; }
GLuint Window::framebuffer() const { return state_->target.name(); }
GLFWwindow* Window::handle() const { return state_->window; }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(state_->window, title.c_str()); }

void Window::set_clipboard(const std::string& text) { glfwSetClipboardString(state_->window, text.c_str()); }

void Window::begin_frame() {
  State& state = *state_;
  GLint width = 0, height = 0;
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, state.picture.name());
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &width);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &height);
  glBindTexture(GL_TEXTURE_2D, 0);
  // If there is not enough memory for the new size, OpenGL's error is reported and the old size is kept.
  if (width != state.width || height != state.height) {
    if (!make_target(state)) state.width = width, state.height = height;
  }
  const double ratio = state.pixels_per_coordinate();
  if (state.fonts_outdated) {
    apply_overlay_style(state.scale, float(ratio));
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
    state.fonts_outdated = false;
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {float(state.width / ratio), float(state.height / ratio)};
  io.DisplayFramebufferScale = {float(ratio), float(ratio)};
  ImGui::NewFrame();

  glBindFramebuffer(GL_FRAMEBUFFER, state.target.name());
  glViewport(0, 0, state.width, state.height);
  glDisable(GL_SCISSOR_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClearColor(0.075f, 0.078f, 0.086f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
}

void Window::end_frame() {
  State& state = *state_;
  ImGui::Render();
  glBindFramebuffer(GL_FRAMEBUFFER, state.target.name());
  glViewport(0, 0, state.width, state.height);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (state.visible) {
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, state.target.name());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, state.width, state.height, 0, 0, state.width, state.height, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glfwSwapBuffers(state.window);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Expected<void> Window::resize(int width, int height) {
  if (width < 1 || height < 1 || width > kLargestSize || height > kLargestSize) {
    return fail(fmt::format("a window has 1 to {0} pixels in each direction, not {1} × {2}", kLargestSize,
                            width, height));
  }
  State& state = *state_;
  if (state.visible) {
    const double ratio = state.pixels_per_coordinate();
    glfwSetWindowSize(state.window, std::max(1, int(std::lround(width / ratio))),
                      std::max(1, int(std::lround(height / ratio))));
    return {};
  }
  state.events.resized = width != state.width || height != state.height;
  state.width = width;
  state.height = height;
  return {};
}

FramePixels Window::read_pixels() const {
  GLint width = 0, height = 0;  // of the last frame, not of the next
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, state_->picture.name());
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &width);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &height);
  glBindTexture(GL_TEXTURE_2D, 0);
  const std::size_t row = 3 * std::size_t(width);
  std::vector<std::uint8_t> bytes(row * std::size_t(height));
  glBindFramebuffer(GL_FRAMEBUFFER, state_->target.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  for (std::size_t y = 0; y < std::size_t(height) / 2; ++y) {
    std::swap_ranges(bytes.data() + row * y, bytes.data() + row * (y + 1),
                     bytes.data() + row * (std::size_t(height) - 1 - y));
  }
  return {width, height, std::move(bytes)};
}

std::vector<std::string> Window::take_gl_errors() {
  State& state = *state_;
  for (std::size_t i = 0; i < kMostErrors; ++i) {  // a lost context would return errors forever
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) break;
    // The driver's own text is already recorded.
    if (!state.debug_output) state.gl_errors.push_back(fmt::format("OpenGL error {:#06x}", error));
  }
  return std::exchange(state.gl_errors, {});
}

}  // namespace penumbra
