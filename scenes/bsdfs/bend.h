// Normal maps and bump maps: textures that change the shading normal of a surface. Turns of its tangent.
#pragma once

#include <cmath>

#include "kernels/scene_types.h"
#include "scenes/plugin_values.h"

namespace penumbra {

enum class BendKind { kNone, kNormalMap, kBumpMap };
static_assert(int(BendKind::kNormalMap) == BEND_NORMAL_MAP && int(BendKind::kBumpMap) == BEND_BUMP_MAP);

/// A normal map, whose normals are 2 t - 1 in the frame of tangent, bitangent and normal; or a bump map,
/// whose values are heights in scene units.
struct SurfaceBend {
  BendKind kind = BendKind::kNone;
  int texture = kNoTexture;  ///< an index into SceneDescription::textures
  float scale = 1.0f;        ///< factor of the heights; negative for the back side of the surface
  bool shadows = true;       ///< bumps cast shadows on each other
  friend bool operator==(const SurfaceBend&, const SurfaceBend&) = default;
};

/// Which layers of surfaces a map bends. Only OpenPBR's coats have normals of their own.
enum class BentLayers { kAll, kBase, kCoat };

/// Parameters that the plugins of normal maps and bump maps share, beside the nested texture and BSDF.
template <typename Parameters>
struct BendParameters {
  bool flip_invalid_normals = true;
  bool use_shadowing_function = true;
  BentLayers layers = BentLayers::kAll;

  template <typename Row>
  static void parameters(const Row& row) {
    row("flip_invalid_normals", &Parameters::flip_invalid_normals, TrueOrFalse{},
        "true: normals that face away lean the other way (false is read as true, with a warning)");
    row("use_shadowing_function", &Parameters::use_shadowing_function, TrueOrFalse{},
        "whether bumps shade each other (Estevez et al. 2019)");
    row("layers", &Parameters::layers,
        OneOf<BentLayers>{
            {{"all", BentLayers::kAll}, {"base", BentLayers::kBase}, {"coat", BentLayers::kCoat}}},
        "which layers of an openpbr it bends; a coat that none bends stays smooth over a bent base");
  }
};
struct NormalMapParameters : BendParameters<NormalMapParameters> {
  static constexpr const char* kPlugin = "normalmap";
  static constexpr const char* kText = "a BSDF with the normals of a nested texture, which is raw as a rule";
};
struct BumpMapParameters : BendParameters<BumpMapParameters> {
  static constexpr const char* kPlugin = "bumpmap";
  static constexpr const char* kText = "a BSDF with bumps by the heights of a nested texture";
  float scale = 1.0f;

  template <typename Row>
  static void parameters(const Row& row) {
    row("scale", &BumpMapParameters::scale, NumberWithin{LowEnd::kClosed, -kAnyNumber, kAnyNumber},
        "of the heights, which are in the scene's units");
    BendParameters::parameters(row);
  }
};

/// A turn of the tangent in the plane of the surface. `texture` has directions that are turned instead of it:
/// 2 t - 1 along the tangent (red) and the bitangent (green).
struct SurfaceTurn {
  int texture = kNoTexture;  ///< an index into SceneDescription::textures
  float angle = 0.0f;        ///< radians, counter-clockwise as seen from the front
  bool mirrored = false;     ///< whether the bitangent points the other way, and the angle counts so
  [[nodiscard]] bool turns() const { return texture != kNoTexture || angle != 0.0f; }
  friend bool operator==(const SurfaceTurn&, const SurfaceTurn&) = default;
};
struct TurnedTangentParameters {
  static constexpr const char* kPlugin = "turnedtangent";
  static constexpr const char* kText =
      "a BSDF whose tangent is turned; red and green of a nested raw texture are another tangent";
  float angle = 0.0f;  ///< degrees
  bool mirrored = false;

  template <typename Row>
  static void parameters(const Row& row) {
    row("angle", &TurnedTangentParameters::angle, NumberWithin{LowEnd::kClosed, -kAnyNumber, kAnyNumber},
        "of the turn in degrees, counter-clockwise");
    row("mirrored", &TurnedTangentParameters::mirrored, TrueOrFalse{},
        "whether green and the angle count the other way");
  }
};

/// The distance in texture coordinates of the finite differences of a bump map that is not an image. It is
/// large enough for single precision.
constexpr float kBendStep = 1.0f / 4096.0f;

inline void set_bend(Material& m, const SurfaceBend& bend) {
  const bool bends = bend.kind != BendKind::kNone && bend.texture != kNoTexture;
  m.bend = bends ? int(bend.kind) : BEND_NONE;
  m.bend_texture = bends ? bend.texture : kNoTexture;
  m.bend_scale = bend.scale;
  m.bend_step = kBendStep;
  m.bend_shadows = bends && bend.shadows ? 1 : 0;
}

/// `coat`: the bend of the material's coat, which differs from that of its base.
inline void set_coat_bend(Material& m, const SurfaceBend& coat) {
  const bool bends = coat.kind != BendKind::kNone && coat.texture != kNoTexture;
  m.variant |= OPENPBR_OWN_COAT;
  m.coat_bend = bends ? int(coat.kind) : BEND_NONE;
  m.coat_bend_texture = bends ? coat.texture : kNoTexture;
  m.coat_bend_scale = coat.scale;
  m.coat_bend_step = kBendStep;
}

inline void set_turn(Material& m, const SurfaceTurn& turn) {
  m.turn = !turn.turns() ? 0 : turn.mirrored ? -1 : 1;
  m.turn_texture = turn.texture;
  m.turn_cosine = std::cos(turn.angle);
  m.turn_sine = std::sin(turn.angle);
}

}  // namespace penumbra
