// A hidden window for tests of drawing.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include "gl/window.h"

namespace penumbra {

/// A window with the driver's checks on. Tests that have no display are skipped; with one, no window is a
/// failure. After each test OpenGL has nothing to complain of.
class HiddenWindowTest : public testing::Test {
 protected:
  void SetUp() override { open(640, 400, 1); }

  void open(int width, int height, float scale) {
    window_.reset();
    auto window = Window::create({.title = "test",
                                  .width = width,
                                  .height = height,
                                  .visible = false,
                                  .debug = true,
                                  .content_scale = scale});
    if (!window && std::getenv("DISPLAY") == nullptr) GTEST_SKIP() << window.error().message;
    ASSERT_TRUE(window.has_value()) << window.error().message;
    window_ = std::make_unique<Window>(std::move(*window));
  }

  void TearDown() override {
    if (window_ == nullptr) return;
    for (const std::string& error : window_->take_gl_errors()) ADD_FAILURE() << error;
  }

  std::unique_ptr<Window> window_;
};

}  // namespace penumbra
