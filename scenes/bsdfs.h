// The BSDFs: one file each in bsdfs/, with its parameters, a row for every one, and the material of the
// kernels that it becomes.
//
// A BSDF is a struct with its plugin's name `kPlugin`, members with their defaults, and
//   static void parameters(row)   which calls row(name, member, values, text) for every parameter, in order:
//                                 readers, their messages and the reference of all plugins follow from it;
//   void complete(findings)       if needed: what no single parameter can tell. `given(name)` of the second
//                                 form, complete(findings, given), tells which were given;
//   void written_for(version)     if needed: defaults that depend on the file's major version
//   Model other_side() const      if it transmits: what its back is, or
//   kSidesAreAlike = true         if that is the same; without either the back is black
// and beside it material_of(bsdf), or material_of(bsdf, tables) where materials share tables of the scene.
#pragma once

#include <string>
#include <variant>

#include "scenes/bsdfs/bend.h"
#include "scenes/bsdfs/blinnphong.h"
#include "scenes/bsdfs/conductor.h"
#include "scenes/bsdfs/dielectric.h"
#include "scenes/bsdfs/diffuse.h"
#include "scenes/bsdfs/disney.h"
#include "scenes/bsdfs/microfacet_diffuse.h"
#include "scenes/bsdfs/nested.h"
#include "scenes/bsdfs/phong.h"
#include "scenes/bsdfs/plastic.h"
#include "scenes/bsdfs/principled.h"
#include "scenes/bsdfs/principledthin.h"
#include "scenes/bsdfs/roughplastic.h"
#include "scenes/bsdfs/ward.h"

namespace penumbra {

using BsdfModel = std::variant<DiffuseBsdf, PhongBsdf, ConductorBsdf, RoughConductorBsdf, DielectricBsdf,
                               ThinDielectricBsdf, RoughDielectricBsdf, PlasticBsdf, RoughPlasticBsdf,
                               PolarizedPlasticBsdf, WardBsdf, BlinnPhongBsdf, MicrofacetDiffuseBsdf,
                               PrincipledBsdf, PrincipledThinBsdf, DisneyBsdf, NullBsdf, MaskBsdf, BlendBsdf>;

/// The parameters of those that hold others and are none of these themselves.
using HolderParameters = std::variant<TwoSidedParameters, MixtureParameters, NormalMapParameters,
                                      BumpMapParameters, PolarizerParameters>;

struct Bsdf {
  std::string name;  ///< the file's id, or a description of the place, for messages
  BsdfModel model;
  SurfaceBend bend = {};  ///< of one that holds no others
};

/// What its children are made of is not known: `passes` is up to the device scene.
inline Material material_of(const Bsdf& bsdf, MaterialTables& tables) {
  const auto material = [&](const auto& model) {
    if constexpr (requires { material_of(model, tables); })
      return material_of(model, tables);
    else
      return material_of(model);
  };
  Material m = std::visit(material, bsdf.model);
  set_bend(m, bsdf.bend);
  return m;
}

}  // namespace penumbra
