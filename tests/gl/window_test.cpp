#include "gl/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <imgui.h>
#include <unistd.h>

#include <cstdlib>

#include "tests/gl/hidden_window.h"

namespace penumbra {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class WindowTest : public HiddenWindowTest {
 protected:
  /// As GLFW calls back, ImGui's callbacks included.
  void key(int key, int happened, int modifiers = 0) {
    const GLFWkeyfun callback = glfwSetKeyCallback(window_->handle(), nullptr);
    glfwSetKeyCallback(window_->handle(), callback);
    callback(window_->handle(), key, glfwGetKeyScancode(key), happened, modifiers);
  }
  void button(int button, int happened, int modifiers = 0) {
    const GLFWmousebuttonfun callback = glfwSetMouseButtonCallback(window_->handle(), nullptr);
    glfwSetMouseButtonCallback(window_->handle(), callback);
    callback(window_->handle(), button, happened, modifiers);
  }
  void cursor(double x, double y) {
    const GLFWcursorposfun callback = glfwSetCursorPosCallback(window_->handle(), nullptr);
    glfwSetCursorPosCallback(window_->handle(), callback);
    callback(window_->handle(), x, y);
  }
};

TEST_F(WindowTest, KeysBecomeActionsAndRepeatWhereTheyMay) {
  window_->poll();
  key(GLFW_KEY_SPACE, GLFW_PRESS);
  key(GLFW_KEY_SPACE, GLFW_REPEAT);
  key(GLFW_KEY_SPACE, GLFW_RELEASE);
  key(GLFW_KEY_F5, GLFW_PRESS);
  key(GLFW_KEY_F5, GLFW_REPEAT);  // a key held down must not read the scene again and again
  key(GLFW_KEY_W, GLFW_PRESS, GLFW_MOD_SHIFT);
  key(GLFW_KEY_S, GLFW_PRESS, GLFW_MOD_CONTROL);
  key(GLFW_KEY_KP_ADD, GLFW_PRESS);
  key(GLFW_KEY_LEFT_BRACKET, GLFW_PRESS);
  key(GLFW_KEY_Y, GLFW_PRESS);  // of no action
  key(GLFW_KEY_Z, GLFW_PRESS, GLFW_MOD_ALT);
  EXPECT_THAT(window_->poll().actions,
              ElementsAre(Action::kOneMoreSample, Action::kOneMoreSample, Action::kReload, Action::kForward,
                          Action::kBrighter, Action::kAlphaDown));
  EXPECT_FALSE(window_->poll().any());
}

TEST_F(WindowTest, EveryActionHasAKeyOfTheKeyboard) {
  constexpr int kFirst = GLFW_KEY_SPACE, kLast = GLFW_KEY_LAST;
  for (const ActionInfo& info : all_actions()) {
    bool found = false;
    for (int code = kFirst; code <= kLast; ++code) {
      // Letters and digits print themselves.
      const std::string printed = code > 32 && code < 128 ? std::string(1, char(code)) : "";
      found |= action_of_key(key_name(code, printed)) == info.action;
      found |= action_of_key("ctrl+" + printed) == info.action;
    }
    EXPECT_TRUE(found) << info.key;
  }
}

TEST_F(WindowTest, DragsTurnOrMoveByTheButton) {
  double x = 0, y = 0;
  window_->poll();
  glfwGetCursorPos(window_->handle(), &x, &y);
  const auto drag = [&](int which, int modifiers) {
    button(which, GLFW_PRESS, modifiers);
    cursor(x + 10, y - 4);
    cursor(x + 12, y - 5);
    button(which, GLFW_RELEASE, modifiers);
    cursor(x + 100, y + 100);  // not a drag any more
    return window_->poll();
  };
  const WindowEvents orbit = drag(GLFW_MOUSE_BUTTON_LEFT, 0);
  EXPECT_EQ(orbit.orbit_x, 12);
  EXPECT_EQ(orbit.orbit_y, -5);
  EXPECT_EQ(orbit.pan_x, 0);
  for (const auto& pan : {drag(GLFW_MOUSE_BUTTON_MIDDLE, 0), drag(GLFW_MOUSE_BUTTON_LEFT, GLFW_MOD_SHIFT)}) {
    EXPECT_EQ(pan.pan_x, 12);
    EXPECT_EQ(pan.pan_y, -5);
    EXPECT_EQ(pan.orbit_x, 0);
  }
  for (const auto& picture :
       {drag(GLFW_MOUSE_BUTTON_RIGHT, 0), drag(GLFW_MOUSE_BUTTON_LEFT, GLFW_MOD_CONTROL)}) {
    EXPECT_EQ(picture.picture_x, 12);
    EXPECT_EQ(picture.picture_y, -5);
    EXPECT_EQ(picture.orbit_x, 0);
  }
  EXPECT_FALSE(drag(GLFW_MOUSE_BUTTON_4, 0).any());
}

TEST_F(WindowTest, WhatThePanelWantsIsNotAnEvent) {
  window_->poll();
  ImGui::GetIO().WantCaptureMouse = ImGui::GetIO().WantCaptureKeyboard = true;
  key(GLFW_KEY_SPACE, GLFW_PRESS);
  button(GLFW_MOUSE_BUTTON_LEFT, GLFW_PRESS);
  cursor(1000, 1000);
  const GLFWscrollfun scroll = glfwSetScrollCallback(window_->handle(), nullptr);
  glfwSetScrollCallback(window_->handle(), scroll);
  scroll(window_->handle(), 0, 1);
  EXPECT_FALSE(window_->poll().any());
  ImGui::GetIO().WantCaptureMouse = false;
  scroll(window_->handle(), 0, 1);
  EXPECT_EQ(window_->poll().wheel, 1);
}

TEST_F(WindowTest, PixelsAreThoseOfTheLastFrameTopRowFirst) {
  window_->begin_frame();
  glBindFramebuffer(GL_FRAMEBUFFER, window_->framebuffer());
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 390, 640, 10);  // OpenGL counts from below
  glClearColor(1, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_SCISSOR_TEST);
  window_->end_frame();
  ASSERT_TRUE(window_->resize(320, 200).has_value());
  const auto pixels = window_->read_pixels().rgb;
  ASSERT_EQ(pixels.size(), 3u * 640 * 400) << "the new size begins with the next frame";
  EXPECT_EQ(pixels[0], 255);
  EXPECT_EQ(pixels[1], 0);
  EXPECT_LT(pixels[pixels.size() - 3], 64);
  EXPECT_TRUE(window_->poll().resized);
  window_->begin_frame();
  window_->end_frame();
  EXPECT_EQ(window_->read_pixels().rgb.size(), 3u * 320 * 200);
}

TEST_F(WindowTest, AVisibleWindowShowsWhatWasDrawn) {
  window_.reset();
  auto visible = Window::create({.width = 300, .height = 200, .debug = true});
  ASSERT_TRUE(visible.has_value()) << visible.error().message;
  for (int frame = 0; frame < 2; ++frame) {
    visible->poll(0.01);
    visible->begin_frame();
    glBindFramebuffer(GL_FRAMEBUFFER, visible->framebuffer());
    glClearColor(0, 1, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    visible->end_frame();
  }
  EXPECT_GT(visible->width(), 0);
  EXPECT_GE(visible->content_scale(), 0.5f);
  const auto pixels = visible->read_pixels().rgb;
  ASSERT_EQ(pixels.size(), 3u * std::size_t(visible->width()) * std::size_t(visible->height()));
  EXPECT_EQ(pixels[0], 0);
  EXPECT_EQ(pixels[1], 255);
  ASSERT_TRUE(visible->resize(400, 250).has_value());
  bool resized = false;
  for (int i = 0; i < 100 && !resized; ++i) resized = visible->poll(0.02).resized;
  EXPECT_TRUE(resized);
  visible->begin_frame();
  visible->end_frame();
  EXPECT_EQ(visible->read_pixels().rgb.size(),
            3u * std::size_t(visible->width()) * std::size_t(visible->height()));
  EXPECT_THAT(visible->take_gl_errors(), IsEmpty());
}

TEST_F(WindowTest, TheSmallestWindowIsDrawn) {
  for (const bool visible : {true, false}) {
    SCOPED_TRACE(visible);
    window_.reset();
    auto window = Window::create({.width = 1280, .height = 720, .visible = visible, .debug = true});
    ASSERT_TRUE(window.has_value()) << window.error().message;
    // Before the first frame, which makes the panel's style: the window is small already, and the event that
    // says so has not been heard.
    ASSERT_TRUE(window->resize(1, 1).has_value());
    for (int frame = 0; frame < 3; ++frame) {
      window->begin_frame();
      ImGui::Begin("panel");
      ImGui::TextUnformatted("text");
      ImGui::End();
      window->end_frame();
      window->poll(0.05);
    }
    EXPECT_THAT(window->take_gl_errors(), IsEmpty());
  }
}

TEST_F(WindowTest, ErrorsOfOpenGlAreHeard) {
  glEnable(0xdead);
  EXPECT_THAT(window_->take_gl_errors(), Not(IsEmpty()));
  EXPECT_THAT(window_->take_gl_errors(), IsEmpty());
}

TEST_F(WindowTest, SizesOfNoWindowAreRefused) {
  EXPECT_FALSE(window_->resize(0, 100).has_value());
  EXPECT_FALSE(window_->resize(100, 100000).has_value());
  EXPECT_FALSE(Window::create({.width = -1}).has_value());
}

TEST(WindowWithoutDisplay, SaysWhatWouldHelp) {
  // GLFW keeps a display that it has, so in processes that begin anew.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        unsetenv("DISPLAY");
        unsetenv("WAYLAND_DISPLAY");
        const auto window = Window::create({});
        if (!window) fputs(window.error().message.c_str(), stderr);
        _exit(window ? 1 : 0);
      },
      testing::ExitedWithCode(0), AllOf(HasSubstr("DISPLAY"), HasSubstr("xvfb-run")));
  EXPECT_EXIT(
      {
        setenv("DISPLAY", ":4711", 1);
        const auto window = Window::create({});
        if (!window) fputs(window.error().message.c_str(), stderr);
        _exit(window ? 1 : 0);
      },
      testing::ExitedWithCode(0), AllOf(HasSubstr("does not answer"), HasSubstr("xvfb-run")));
}

}  // namespace
}  // namespace penumbra
