#include "gl/gl_objects.h"

#include <fmt/format.h>

#include <array>
#include <vector>

namespace penumbra {

namespace {

template <typename Generate>
GLuint generated(Generate generate) {
  GLuint name = 0;
  generate(1, &name);
  return name;
}

class Shader {
 public:
  explicit Shader(GLenum kind) : name_(glCreateShader(kind)) {}
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  ~Shader() { glDeleteShader(name_); }
  [[nodiscard]] GLuint name() const { return name_; }

 private:
  GLuint name_;
};

template <typename GetNumber, typename GetLog>
std::string info_log(GLuint name, GetNumber get_number, GetLog get_log) {
  GLint length = 0;
  get_number(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length > 0 ? length : 1), '\0');
  GLsizei written = 0;
  get_log(name, static_cast<GLsizei>(log.size()), &written, log.data());
  log.resize(static_cast<std::size_t>(written));
  while (!log.empty() && (log.back() == '\n' || log.back() == ' ')) log.pop_back();
  return log.empty() ? "the driver says nothing" : log;
}

Expected<void> compile(const Shader& shader, std::string_view name, std::string_view stage,
                       std::string_view text) {
  const GLchar* data = text.data();
  const GLint length = static_cast<GLint>(text.size());
  glShaderSource(shader.name(), 1, &data, &length);
  glCompileShader(shader.name());
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return {};
  return fail(fmt::format("the {} shader '{}' does not compile:\n{}", stage, name,
                          info_log(
                              shader.name(), [](auto... a) { glGetShaderiv(a...); },
                              [](auto... a) { glGetShaderInfoLog(a...); })));
}

}  // namespace

// Lambdas, since libepoxy's functions are macros over pointers that change at the first call.
GLuint TextureTraits::create() {
  return generated([](auto... a) { glGenTextures(a...); });
}
void TextureTraits::destroy(GLuint name) { glDeleteTextures(1, &name); }
GLuint BufferTraits::create() {
  return generated([](auto... a) { glGenBuffers(a...); });
}
void BufferTraits::destroy(GLuint name) { glDeleteBuffers(1, &name); }
GLuint FramebufferTraits::create() {
  return generated([](auto... a) { glGenFramebuffers(a...); });
}
void FramebufferTraits::destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
GLuint RenderbufferTraits::create() {
  return generated([](auto... a) { glGenRenderbuffers(a...); });
}
void RenderbufferTraits::destroy(GLuint name) { glDeleteRenderbuffers(1, &name); }
GLuint VertexArrayTraits::create() {
  return generated([](auto... a) { glGenVertexArrays(a...); });
}
void VertexArrayTraits::destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
GLuint QueryTraits::create() {
  return generated([](auto... a) { glGenQueries(a...); });
}
void QueryTraits::destroy(GLuint name) { glDeleteQueries(1, &name); }
GLuint ProgramTraits::create() { return glCreateProgram(); }
void ProgramTraits::destroy(GLuint name) { glDeleteProgram(name); }

Expected<Program> link_program(std::string_view name, std::string_view vertex_text,
                               std::string_view fragment_text) {
  const Shader vertex(GL_VERTEX_SHADER), fragment(GL_FRAGMENT_SHADER);
  if (auto done = compile(vertex, name, "vertex", vertex_text); !done) return std::unexpected(done.error());
  if (auto done = compile(fragment, name, "fragment", fragment_text); !done)
    return std::unexpected(done.error());
  Program program = Program::create();
  glAttachShader(program.name(), vertex.name());
  glAttachShader(program.name(), fragment.name());
  glLinkProgram(program.name());
  glDetachShader(program.name(), vertex.name());
  glDetachShader(program.name(), fragment.name());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  return fail(fmt::format("the shaders of '{}' do not link:\n{}", name,
                          info_log(
                              program.name(), [](auto... a) { glGetProgramiv(a...); },
                              [](auto... a) { glGetProgramInfoLog(a...); })));
}

Texture make_texture(GLenum internal_format, int width, int height, GLenum format, GLenum type) {
  Texture texture = Texture::create();
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, format, type,
               nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

Expected<Framebuffer> make_framebuffer(std::span<const GLuint> colour_textures, GLuint depth_texture) {
  GLint draws = 0, reads = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draws);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &reads);
  Framebuffer framebuffer = Framebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  std::vector<GLenum> buffers;
  for (const GLuint texture : colour_textures) {
    buffers.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(buffers.size()));
    glFramebufferTexture2D(GL_FRAMEBUFFER, buffers.back(), GL_TEXTURE_2D, texture, 0);
  }
  if (depth_texture != 0)
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_texture, 0);
  glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draws));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(reads));
  if (status != GL_FRAMEBUFFER_COMPLETE)
    return fail(fmt::format("this OpenGL cannot draw into such a framebuffer (status {:#x})", status));
  return framebuffer;
}

void set_uniform(const Program& program, const char* name, int value) {
  glUniform1i(glGetUniformLocation(program.name(), name), value);
}
void set_uniform(const Program& program, const char* name, float value) {
  glUniform1f(glGetUniformLocation(program.name(), name), value);
}
void set_uniform(const Program& program, const char* name, float x, float y) {
  glUniform2f(glGetUniformLocation(program.name(), name), x, y);
}
void set_uniform(const Program& program, const char* name, float x, float y, float z) {
  glUniform3f(glGetUniformLocation(program.name(), name), x, y, z);
}

Expected<BufferTexture> make_buffer_texture(std::string_view what, std::span<const std::byte> bytes,
                                            GLenum internal_format, std::size_t bytes_per_texel) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  const std::size_t texels = bytes.size() / bytes_per_texel;
  if (texels > static_cast<std::size_t>(most))
    return fail(fmt::format("{} take {} texels of a texture buffer, and this OpenGL has at most {}", what,
                            texels, most));
  static constexpr std::array<std::byte, 16> kNothing{};
  if (bytes.empty()) bytes = kNothing;
  BufferTexture made{Buffer::create(), Texture::create()};
  glBindBuffer(GL_TEXTURE_BUFFER, made.buffer.name());
  glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STATIC_DRAW);
  glBindTexture(GL_TEXTURE_BUFFER, made.texture.name());
  glTexBuffer(GL_TEXTURE_BUFFER, internal_format, made.buffer.name());
  glBindTexture(GL_TEXTURE_BUFFER, 0);
  glBindBuffer(GL_TEXTURE_BUFFER, 0);
  return made;
}

}  // namespace penumbra
