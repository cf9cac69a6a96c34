// Owners of OpenGL 3.3 objects. Each object belongs to the context that was current when it was made, and
// that context, or one that shares with it, must be current when it goes.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "kernels/host/error.h"

namespace penumbra {

/// An object's name; 0 is none. `Traits` has create() and destroy(GLuint).
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

  /// A new object.
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

/// Compiles and links; `name` says in errors which program it is, and an error holds the driver's log. Texts
/// begin with their #version.
Expected<Program> link_program(std::string_view name, std::string_view vertex_text,
                               std::string_view fragment_text);

/// A 2D texture of one level without contents, sampled by nearest neighbour and clamped to its edge; format
/// and type are those of glTexImage2D. Leaves it bound to the active unit.
Texture make_texture(GLenum internal_format, int width, int height, GLenum format, GLenum type);

/// Makes a framebuffer of these colour attachments and, unless 0, a depth renderbuffer or texture; an error
/// if it is not complete. Leaves the framebuffer bound that was.
Expected<Framebuffer> make_framebuffer(std::span<const GLuint> colour_textures, GLuint depth_texture = 0);

/// Sets a uniform of the program in use; a name that the linker has left out is no error.
void set_uniform(const Program& program, const char* name, int value);
void set_uniform(const Program& program, const char* name, float value);
void set_uniform(const Program& program, const char* name, float x, float y);
void set_uniform(const Program& program, const char* name, float x, float y, float z);

/// A buffer of words and the texture through which shaders fetch from it (samplerBuffer and its integer
/// kinds).
struct BufferTexture {
  Buffer buffer;
  Texture texture;
};

/// `bytes` may be empty: one texel is there all the same. `what` names the table in the error for one that is
/// larger than GL_MAX_TEXTURE_BUFFER_SIZE texels.
Expected<BufferTexture> make_buffer_texture(std::string_view what, std::span<const std::byte> bytes,
                                            GLenum internal_format, std::size_t bytes_per_texel);

}  // namespace penumbra
