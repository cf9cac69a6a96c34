// Where photons are stored and looked up: at surfaces with a diffuse part, and in media. Mirrors, glass and
// glossy surfaces without a diffuse part are left to the paths of the camera. Paths and photons keep which of
// these scattered them (chain).
#ifndef PENUMBRA_PHOTON_SURFACES_H
#define PENUMBRA_PHOTON_SURFACES_H
#include "kernels/block/path_state.h"
#include "kernels/bsdf/families.h"
#include "kernels/light/light_found.h"

PENUMBRA_NAMESPACE_BEGIN

/// Whether the closure has a diffuse part, or is a phase function. Of hair, which is thinner than photons lie
/// apart, paths find all light.
FN bool has_diffuse_part(Closure c) {
  const ulong diffuse = USERS_diffuse & ~ONLY(HAIR);
  const bool metal = is_among(c, USERS_metallic) & (c.metallic >= 1.0f);
  const bool glass = is_among(c, USERS_spec_trans) & (c.spec_trans >= 1.0f);
  const float through = is_among(c, ONLY(DIFFTRANS)) ? max_component(c.transmitted) : 0.0f;
  const bool coloured = (max_f(max_component(c.diffuse), through) > 0.0f) & !metal & !glass;
  return (is_among(c, diffuse) & coloured) | is_among(c, ONLY(PHASE));
}

// The surfaces that scattered a path of the camera so far; and those of a photon.
#define CHAIN_SPECULAR 0        // none with a diffuse part, or only its delta directions
#define CHAIN_DIFFUSE 1         // the last one is diffuse
#define CHAIN_BEHIND_DIFFUSE 2  // an earlier one is diffuse, and the last is not
// Of paths of the camera whose other light photons have brought, and which go on for the emission of media,
// since media emit no photons.
#define CHAIN_LAST 3   // at the surface that took photons: its ray still finds light that was sampled there
#define CHAIN_MEDIA 4  // further on

STAGE void start_chains(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_chain(paths, j, CHAIN_SPECULAR);
}

FN int next_chain(int chain, bool diffuse) {
  if (chain >= CHAIN_LAST) return CHAIN_MEDIA;
  return diffuse ? CHAIN_DIFFUSE : (chain == CHAIN_SPECULAR ? CHAIN_SPECULAR : CHAIN_BEHIND_DIFFUSE);
}

/// Drops emission that photons bring to the last diffuse surface.
STAGE void drop_photon_emission(const PRIVATE PathState* paths, int i, PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int chain = get_chain(paths, i + j);
      const bool dropped = (chain == CHAIN_BEHIND_DIFFUSE) | (chain == CHAIN_MEDIA);
      found->light[j] = dropped ? -1 : found->light[j];
    }
}

PENUMBRA_NAMESPACE_END
#endif
