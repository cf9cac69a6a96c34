// The textures. Each has its parameters, one table row for every parameter (see bsdfs.h), and the conversion
// to a record of the kernels.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <variant>

#include "kernels/scene_types.h"
#include "scenes/image/bitmap_reader.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/plugin_values.h"
#include "scenes/textured.h"

namespace penumbra {

enum class BitmapFilter { kNearest, kBilinear, kTrilinear, kAnisotropic };

/// Textures from image files, as in Mitsuba 3, including the parameters of version 0.6.
struct BitmapTexture {
  static constexpr const char* kPlugin = "bitmap";
  static constexpr const char* kText = "an image file";
  std::string filename;
  BitmapFilter filter = BitmapFilter::kBilinear;
  int wrap = WRAP_REPEAT, wrap_u = WRAP_REPEAT, wrap_v = WRAP_REPEAT;
  bool raw = false;
  float gamma = kSrgb;  ///< decoding of integers: (n / most)^gamma, sRGB, or linear (1)
  BitmapChannels channel = BitmapChannels::kAll;
  int bitmap = -1;         ///< index into SceneDescription::bitmaps
  int times = kNoTexture;  ///< another texture, which multiplies it

  template <typename Row>
  static void parameters(const Row& row) {
    row("filename", &BitmapTexture::filename, FileName{}, "the image");
    row("filter_type", &BitmapTexture::filter,
        OneOf<BitmapFilter>{{{"nearest", BitmapFilter::kNearest},
                             {"bilinear", BitmapFilter::kBilinear},
                             {"trilinear", BitmapFilter::kTrilinear},
                             {"ewa", BitmapFilter::kAnisotropic}}},
        "what is between the centres of texels; trilinear and ewa are bilinear here");
    const OneOf<int> wraps{{{"repeat", WRAP_REPEAT},
                            {"mirror", WRAP_MIRROR},
                            {"clamp", WRAP_CLAMP},
                            {"zero", WRAP_ZERO},
                            {"one", WRAP_ONE}}};
    row("wrap_mode", &BitmapTexture::wrap, wraps, "what is beyond the edges");
    row("wrap_mode_u", &BitmapTexture::wrap_u, wraps, "the same to the sides alone");
    row("wrap_mode_v", &BitmapTexture::wrap_v, wraps, "... above and below");
    row("raw", &BitmapTexture::raw, TrueOrFalse{},
        "whole numbers are linear, as of normals; else they are sRGB");
    row("gamma", &BitmapTexture::gamma, NumberWithin{LowEnd::kClosed, -1.0f, 100.0f},
        "whole numbers count (n / most)^gamma; -1: sRGB");
    row("channel", &BitmapTexture::channel,
        OneOf<BitmapChannels>{{{"all", BitmapChannels::kAll},
                               {"r", BitmapChannels::kRed},
                               {"g", BitmapChannels::kGreen},
                               {"b", BitmapChannels::kBlue},
                               {"a", BitmapChannels::kAlpha}}},
        "one channel, as grey");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (!given("filename")) findings.push_back({"", "a bitmap needs a <string name=\"filename\" …>"});
    if (!given("wrap_mode_u")) wrap_u = wrap;
    if (!given("wrap_mode_v")) wrap_v = wrap;
    if (gamma != kSrgb && !(gamma > 0.0f))
      findings.push_back({"gamma", "gamma must be a number above 0, or -1 for sRGB"});
    if (raw && given("gamma") && gamma != 1.0f)
      findings.push_back({"gamma", "raw values have no gamma: give one of both"});
    if (raw) gamma = 1.0f;
    if (filter == BitmapFilter::kTrilinear || filter == BitmapFilter::kAnisotropic)
      findings.push_back({"filter_type", "its filter is bilinear, without smaller copies", true});
  }
};

/// The record without the position of its texels.
inline TextureNode texture_of(const BitmapTexture& bitmap) {
  TextureNode t{};
  t.texture0 = bitmap.times;
  t.texture1 = kNoTexture;
  t.wrap_u = bitmap.wrap_u;
  t.wrap_v = bitmap.wrap_v;
  t.nearest = bitmap.filter == BitmapFilter::kNearest ? 1 : 0;
  return t;
}

/// A checkerboard that repeats a pattern of four squares.
struct CheckerboardTexture {
  static constexpr const char* kPlugin = "checkerboard";
  static constexpr const char* kText = "two colours in squares";
  TexturedColour color0{glm::vec3(0.4f)};
  TexturedColour color1{glm::vec3(0.2f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("color0", &CheckerboardTexture::color0, ColourWithin{0.0f, kAnyNumber},
        "colour of one half of the squares");
    row("color1", &CheckerboardTexture::color1, ColourWithin{0.0f, kAnyNumber}, "colour of the others");
  }
};

inline TextureNode texture_of(const CheckerboardTexture& checkerboard) {
  TextureNode t{};
  t.kind = TEXTURE_CHECKERBOARD;
  set_field(t.colour0, t.texture0, checkerboard.color0);
  set_field(t.colour1, t.texture1, checkerboard.color1);
  return t;
}

enum class MeshAttribute { kVertexColour, kFaceColour };

inline OneOf<MeshAttribute> mesh_attributes() {
  return {{{"vertex_color", MeshAttribute::kVertexColour}, {"face_color", MeshAttribute::kFaceColour}}};
}

/// Colours stored with a mesh.
struct MeshAttributeTexture {
  static constexpr const char* kPlugin = "mesh_attribute";
  static constexpr const char* kText = "colours of the vertices or faces of a mesh";
  MeshAttribute attribute = MeshAttribute::kVertexColour;
  float scale = 1.0f;
  int times = kNoTexture;  ///< another texture, which multiplies it

  template <typename Row>
  static void parameters(const Row& row) {
    row("name", &MeshAttributeTexture::attribute, mesh_attributes(), "which colours");
    row("scale", &MeshAttributeTexture::scale, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "by which they are multiplied");
  }
};

/// The record without its index among the colours of a triangle.
inline TextureNode texture_of(const MeshAttributeTexture& texture) {
  TextureNode t{};
  t.kind = TEXTURE_MESH_ATTRIBUTE;
  t.texture0 = texture.times;
  t.texture1 = kNoTexture;
  t.colour0 = to_vec3(glm::vec3(texture.scale));
  return t;
}

/// Value noise in octaves; the formula is in kernels/texture/noise_texture.h.
struct NoiseTexture {
  static constexpr const char* kPlugin = "noise";
  static constexpr const char* kText = "value noise in octaves, between two colours";
  TexturedColour color0{glm::vec3(0.0f)};
  TexturedColour color1{glm::vec3(1.0f)};
  std::int64_t seed = 0;
  std::int64_t octaves = 4;
  float persistence = 0.5f;
  float lacunarity = 2.0f;

  template <typename Row>
  static void parameters(const Row& row) {
    row("color0", &NoiseTexture::color0, ColourWithin{0.0f, kAnyNumber}, "colour where the noise is 0");
    row("color1", &NoiseTexture::color1, ColourWithin{0.0f, kAnyNumber}, "colour where the noise is 1");
    row("seed", &NoiseTexture::seed, WholeNumber{0, kMaxInt}, "of the random numbers");
    row("octaves", &NoiseTexture::octaves, WholeNumber{1, MAX_NOISE_OCTAVES},
        "how many are summed; one has a number at each whole u and v");
    row("persistence", &NoiseTexture::persistence, NumberWithin{LowEnd::kClosed, 0.0f, 16.0f},
        "height of an octave over that of the one before");
    row("lacunarity", &NoiseTexture::lacunarity, NumberWithin{LowEnd::kOpen, 0.0f, 16.0f},
        "frequency of an octave over that of the one before");
  }
  void complete(Findings& findings) {
    if (color0.texture != kNoTexture || color1.texture != kNoTexture)
      findings.push_back({"", "the colours of noise must be colours, not textures"});
    color0.texture = color1.texture = kNoTexture;
  }
};

inline TextureNode texture_of(const NoiseTexture& noise) {
  TextureNode t{};
  t.kind = TEXTURE_NOISE;
  t.texture0 = t.texture1 = kNoTexture;
  t.colour0 = to_vec3(noise.color0.value);
  t.colour1 = to_vec3(noise.color1.value);
  t.seed = uint(noise.seed);
  t.octaves = int(noise.octaves);
  t.persistence = noise.persistence;
  t.lacunarity = noise.lacunarity;
  return t;
}

/// Multiplies a nested texture by a number or a colour (Mitsuba 0.6).
struct ScaleTexture {
  static constexpr const char* kPlugin = "scale";
  static constexpr const char* kText = "another texture, multiplied";
  TexturedColour scale{glm::vec3(1.0f)};
  int texture = kNoTexture;  ///< the nested texture, which has no name

  template <typename Row>
  static void parameters(const Row& row) {
    row("scale", &ScaleTexture::scale, ColourWithin{0.0f, kAnyNumber},
        "number or colour by which the texture that it holds is multiplied");
  }
  void complete(Findings& findings) {
    if (scale.texture != kNoTexture)
      findings.push_back({"", "'scale' must be a number or a colour, not another texture"});
    scale.texture = kNoTexture;
  }
};

inline TextureNode texture_of(const ScaleTexture& scale) {
  TextureNode t{};
  t.kind = TEXTURE_SCALE;
  t.colour0 = to_vec3(scale.scale.value);
  t.texture0 = scale.texture;
  t.texture1 = kNoTexture;
  return t;
}

using TextureModel =
    std::variant<CheckerboardTexture, BitmapTexture, ScaleTexture, NoiseTexture, MeshAttributeTexture>;

struct SceneTexture {
  std::string name;  ///< the id in the scene file, or a description of the location; for messages
  TextureModel model;
  glm::dmat3 to_uv{1.0};  ///< maps homogeneous texture coordinates of the surface to those of the texture
};

inline TextureNode texture_of(const SceneTexture& texture) {
  TextureNode t = std::visit([](const auto& model) { return texture_of(model); }, texture.model);
  const glm::dmat3& m = texture.to_uv;  // column by column
  t.u_by_u = float(m[0][0]);
  t.u_by_v = float(m[1][0]);
  t.u_offset = float(m[2][0]);
  t.v_by_u = float(m[0][1]);
  t.v_by_v = float(m[1][1]);
  t.v_offset = float(m[2][1]);
  return t;
}

}  // namespace penumbra
