// The BSDFs. Each has one file in bsdfs/, which holds its parameters, one table row for every parameter, and
// the conversion to a material of the kernels.
//
// A BSDF is a struct with the plugin's name `kPlugin`, members with default values, and
//   static void parameters(row)   calls row(name, member, values, text) for every parameter, in order.
//                                 Readers, messages and the plugin reference are generated from these rows.
//   void complete(findings)       optional: checks that involve several parameters. In the second form,
//                                 complete(findings, given), `given(name)` tells whether one was given.
//   void written_for(version)     optional: sets defaults that depend on the scene file's major version.
//   Model other_side() const      for a BSDF that transmits: the BSDF of its back side, or
//   kSidesAreAlike = true         if both sides are the same. A BSDF with neither has a black back side.
// Next to the struct stands material_of(bsdf), or material_of(bsdf, tables) if materials share tables of the
// scene.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <variant>

#include "scenes/bsdfs/bend.h"
#include "scenes/bsdfs/conductor.h"
#include "scenes/bsdfs/dielectric.h"
#include "scenes/bsdfs/diffuse.h"
#include "scenes/bsdfs/disney.h"
#include "scenes/bsdfs/hair.h"
#include "scenes/bsdfs/lajolla.h"
#include "scenes/bsdfs/measured.h"
#include "scenes/bsdfs/metalrough.h"
#include "scenes/bsdfs/microfacet_diffuse.h"
#include "scenes/bsdfs/nested.h"
#include "scenes/bsdfs/openpbr.h"
#include "scenes/bsdfs/phong.h"
#include "scenes/bsdfs/plastic.h"
#include "scenes/bsdfs/principled.h"
#include "scenes/bsdfs/principledthin.h"
#include "scenes/bsdfs/standard_surface.h"
#include "scenes/bsdfs/ward.h"

namespace penumbra {

using BsdfModel =
    std::variant<DiffuseBsdf, PhongBsdf, ConductorBsdf, RoughConductorBsdf, DielectricBsdf,
                 ThinDielectricBsdf, RoughDielectricBsdf, PlasticBsdf, RoughPlasticBsdf, PolarizedPlasticBsdf,
                 WardBsdf, BlinnPhongBsdf, MicrofacetDiffuseBsdf, PrincipledBsdf, PrincipledThinBsdf,
                 DisneyBsdf, OpenPbrBsdf, NullBsdf, MaskBsdf, BlendBsdf, RoughDiffuseBsdf,
                 DiffuseTransmitterBsdf, HairBsdf, MeasuredBsdf>;

/// The parameters of plugins that hold other BSDFs and are not themselves a BsdfModel.
using HolderParameters =
    std::variant<TwoSidedParameters, MixtureParameters, MetalRoughParameters, StandardSurfaceParameters,
                 NormalMapParameters, BumpMapParameters, TurnedTangentParameters, PolarizerParameters,
                 DisneyDiffuseParameters, DisneyMetalParameters, DisneyClearcoatParameters,
                 DisneySheenParameters, DisneyGlassParameters, DisneySumParameters>;

/// A homogeneous medium behind a surface that transmits, with the phase function of Henyey and Greenstein.
struct InnerMedium {
  glm::vec3 extinction{0.0f}, albedo{0.0f};  ///< in 1 / scene unit; of single scattering
  float g = 0.0f;                            ///< mean cosine of scattering, in (-1, 1)
};

struct Bsdf {
  std::string name;  ///< the id in the scene file, or a description of the location; for messages
  BsdfModel model;
  SurfaceBend bend = {};                      ///< normal or bump map; only of a BSDF that holds no others
  SurfaceTurn turn = {};                      ///< likewise
  std::optional<SurfaceBend> coat_bend = {};  ///< of an OpenPbrBsdf's coat, if not `bend`
  std::optional<InnerMedium> inside = {};     ///< only of a BSDF of the front that holds no others
};

/// The material of one BSDF. The materials of its children are not known here, so the device scene sets
/// `passes`.
inline Material material_of(const Bsdf& bsdf, MaterialTables& tables) {
  const auto material = [&](const auto& model) {
    if constexpr (requires { material_of(model, tables); })
      return material_of(model, tables);
    else
      return material_of(model);
  };
  Material m = std::visit(material, bsdf.model);
  set_bend(m, bsdf.bend);
  set_turn(m, bsdf.turn);
  const auto* coated = std::get_if<OpenPbrBsdf>(&bsdf.model);
  const bool own_coat = bsdf.coat_bend && coated != nullptr && coated->coated() && !coated->inside;
  const bool smooth = own_coat && bsdf.coat_bend->kind == BendKind::kNone;
  if (own_coat && !(smooth && bsdf.bend.kind == BendKind::kNone)) set_coat_bend(m, *bsdf.coat_bend);
  return m;
}

}  // namespace penumbra
