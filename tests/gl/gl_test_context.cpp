#include "tests/gl/gl_test_context.h"

#include <cstddef>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>

namespace penumbra {
namespace {

std::vector<std::string> reported_errors;

void GLAPIENTRY on_message(GLenum source, GLenum type, GLuint, GLenum, GLsizei length, const GLchar* text,
                           const void*) {
  // What a shader's text is wrong in is the caller's to report.
  if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
  if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR)
    reported_errors.emplace_back(text, static_cast<std::size_t>(std::max(length, 0)));
}

}  // namespace

std::string make_gl_context() {
  if (glfwInit() != GLFW_TRUE) return "there is no display";
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
  GLFWwindow* window = glfwCreateWindow(64, 64, "test", nullptr, nullptr);
  if (window == nullptr) return "there is no OpenGL 3.3 on this display";
  glfwMakeContextCurrent(window);
  if (epoxy_has_gl_extension("GL_KHR_debug")) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_message, nullptr);
  }
  return "";
}

const std::vector<std::string>& GlTest::gl_errors() { return reported_errors; }

void GlTest::SetUp() {
  static const std::string reason = make_gl_context();
  if (!reason.empty()) GTEST_SKIP() << reason;
  reported_errors.clear();
}

void GlTest::TearDown() {
  if (IsSkipped()) return;
  for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError())
    reported_errors.push_back("error " + std::to_string(error));
  EXPECT_TRUE(reported_errors.empty())
      << reported_errors.size() << " errors, first: " << reported_errors.front();
}

statistics::Image read_texture(GLuint texture) {
  GLint width = 0, height = 0;
  glBindTexture(GL_TEXTURE_2D, texture);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &width);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &height);
  statistics::Image image(width, height, 3);
  std::vector<float> values(image.values.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RGB, GL_FLOAT, values.data());
  std::ranges::copy(values, image.values.begin());
  return image;
}

}  // namespace penumbra
