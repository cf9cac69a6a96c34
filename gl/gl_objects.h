// Owners of OpenGL 3.3 objects. An object belongs to the context that was current at its creation. That
// context, or one that shares with it, must be current at its destruction.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "kernels/host/error.h"

namespace penumbra {

/// Owns an object's name; 0 is none. `Traits` has create() and destroy(GLuint).
template <typename Traits>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(GLuint name) : name_(name) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  GlObject(const GlObject&) = delete;
  GlObject& operator=(const GlObject&) = delete;
  ~GlObject() {
    if (name_ != 0) Traits::destroy(name_);
  }

  /// Creates a new object.
  static GlObject create() { return GlObject(Traits::create()); }
  [[nodiscard]] GLuint name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  GLuint name_ = 0;
};

struct TextureTraits {
  static GLuint create();
  static void destroy(GLuint name);
};
struct BufferTraits {
  static GLuint create();
  static void destroy(GLuint name);
};
struct FramebufferTraits {
  static GLuint create();
  static void destroy(GLuint name);
};
struct RenderbufferTraits {
  static GLuint create();
  static void destroy(GLuint name);
};
struct VertexArrayTraits {
  static GLuint create();
  static void destroy(GLuint name);
};
struct QueryTraits {
  static GLuint create();
  static void destroy(GLuint name);
};
struct ProgramTraits {
  static GLuint create();
  static void destroy(GLuint name);
};

using Texture = GlObject<TextureTraits>;
using Buffer = GlObject<BufferTraits>;
using Framebuffer = GlObject<FramebufferTraits>;
using Renderbuffer = GlObject<RenderbufferTraits>;
using VertexArray = GlObject<VertexArrayTraits>;  ///< not shared between contexts, like framebuffers
using Query = GlObject<QueryTraits>;
using Program = GlObject<ProgramTraits>;

/// Compiles and links a program; `name` is for errors, which include the driver's log. The texts start with
/// their #version.
Expected<Program> link_program(std::string_view name, std::string_view vertex_text,
                               std::string_view fragment_text);

/// A 2D texture with one level and no contents, sampled by nearest neighbour and clamped to its edge. Format
/// and type are those of glTexImage2D. It stays bound to the active unit.
Texture make_texture(GLenum internal_format, int width, int height, GLenum format, GLenum type);

/// Makes a framebuffer with these colour attachments and, unless it is 0, a depth texture. Errors: it is not
/// complete. Keeps the bound framebuffer.
Expected<Framebuffer> make_framebuffer(std::span<const GLuint> colour_textures, GLuint depth_texture = 0);

/// Sets a uniform of the current program. Names that the linker has removed are ignored.
void set_uniform(const Program& program, const char* name, int value);
void set_uniform(const Program& program, const char* name, float value);
void set_uniform(const Program& program, const char* name, float x, float y);
void set_uniform(const Program& program, const char* name, float x, float y, float z);

/// A buffer of words, and its texture for fetches in shaders (samplerBuffer and its integer kinds).
struct BufferTexture {
  Buffer buffer;
  Texture texture;
};

/// `bytes` may be empty; the texture has at least one texel. Errors: it is larger than
/// GL_MAX_TEXTURE_BUFFER_SIZE texels; `what` names the table.
Expected<BufferTexture> make_buffer_texture(std::string_view what, std::span<const std::byte> bytes,
                                            GLenum internal_format, std::size_t bytes_per_texel);

}  // namespace penumbra
