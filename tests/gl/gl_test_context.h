// An OpenGL 3.3 core context for tests: a hidden window's, with the driver's checks on.
#pragma once

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/image_test.h"

namespace penumbra {

/// Makes the context, current and kept to the end of the process. Returns why there is none; empty if there
/// is.
std::string make_gl_context();

/// A test that is skipped, with the reason, where there is no display or no OpenGL 3.3. Its context is
/// current; it is the same for all tests of a process. A test fails if OpenGL complains of what it called.
class GlTest : public testing::Test {
 public:
  /// What the driver called errors or undefined since the test began.
  static const std::vector<std::string>& gl_errors();

 protected:
  void SetUp() override;
  void TearDown() override;
};

/// The texture's red, green and blue as they are; row 0 is the texture's.
statistics::Image read_texture(GLuint texture);

}  // namespace penumbra
