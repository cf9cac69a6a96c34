// Errors of the OpenGL object wrappers.
#include "gl/gl_objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/gl/gl_test_context.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
using GlObjects = GlTest;

constexpr const char* kVertexText =
    "#version 330 core\nout vec2 at;\nvoid main() { at = vec2(0.0); gl_Position = vec4(0.0); }\n";
constexpr const char* kFragmentText =
    "#version 330 core\nin vec2 at;\nout vec4 colour;\nvoid main() { colour = at.xyxy; }\n";

TEST_F(GlObjects, ProgramsLink) {
  const auto program = link_program("plain", kVertexText, kFragmentText);
  ASSERT_TRUE(program) << program.error().message;
  EXPECT_TRUE(glIsProgram(program->name()));
}

TEST_F(GlObjects, ABrokenShaderIsAnErrorWithTheLog) {
  const auto vertex =
      link_program("broken", "#version 330 core\nvoid main() { nonsense = 1; }\n", kFragmentText);
  ASSERT_FALSE(vertex);
  EXPECT_THAT(vertex.error().message, HasSubstr("vertex shader 'broken' does not compile"));
  EXPECT_THAT(vertex.error().message, HasSubstr("nonsense"));
  const auto fragment = link_program("broken", kVertexText, "");
  ASSERT_FALSE(fragment);
  EXPECT_THAT(fragment.error().message, HasSubstr("fragment shader 'broken' does not"));
}

TEST_F(GlObjects, ShadersThatDoNotFitAreAnErrorWithTheLog) {
  const auto program =
      link_program("unfit", kVertexText,
                   "#version 330 core\nin vec4 at;\nout vec4 colour;\nvoid main() { colour = at; }\n");
  ASSERT_FALSE(program);
  EXPECT_THAT(program.error().message, HasSubstr("'unfit' do not link"));
  EXPECT_THAT(program.error().message, HasSubstr("at"));
}

TEST_F(GlObjects, ATableThatIsTooLargeIsAnError) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  const std::vector<std::byte> bytes(std::size_t(most) + 1);
  const auto table = make_buffer_texture("the words", bytes, GL_R8UI, 1);
  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().message, HasSubstr("the words take " + std::to_string(most + 1L) + " texels"));
}

TEST_F(GlObjects, AnEmptyTableIsOneTexel) {
  const auto table = make_buffer_texture("nothing", {}, GL_RGBA32F, 16);
  ASSERT_TRUE(table);
  EXPECT_TRUE(glIsTexture(table->texture.name()));
}

TEST_F(GlObjects, OwnersDeleteAndMove) {
  GLuint name = 0;
  {
    Buffer buffer = Buffer::create();
    name = buffer.name();
    glBindBuffer(GL_ARRAY_BUFFER, name);
    Buffer other = std::move(buffer);
    EXPECT_EQ(other.name(), name);
    EXPECT_TRUE(glIsBuffer(name));
  }
  EXPECT_FALSE(glIsBuffer(name));
}

TEST_F(GlObjects, AFramebufferWithPartsOfDifferentKindsIsRefused) {
  const Texture colour = make_texture(GL_RGBA8, 4, 4, GL_RGBA, GL_UNSIGNED_BYTE);
  const GLuint names[] = {colour.name()};
  EXPECT_TRUE(make_framebuffer(names));
  const auto framebuffer = make_framebuffer(names, colour.name());  // a colour as depth
  ASSERT_FALSE(framebuffer);
  EXPECT_THAT(framebuffer.error().message, HasSubstr("framebuffer"));
}

}  // namespace
}  // namespace penumbra
