// The media that contain a point. They follow from the boundaries that a ray crossed on its way. So media may
// be nested, touch each other, or surround the camera, and a boundary need not say what is around it.
#ifndef PENUMBRA_MEDIUM_STACK_H
#define PENUMBRA_MEDIUM_STACK_H
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// The media at a point: the innermost is in the lowest byte of `low`, the outer ones follow; 0 is vacuum.
typedef struct {
  uint low, high;
} MediumStack;

#define MOST_NESTED_MEDIA 8

FN int innermost(MediumStack media) { return (int)(media.low & 0xffu); }

FN MediumStack within(MediumStack media, int medium) {
  MediumStack inner;
  inner.high = (media.high << 8) | (media.low >> 24);
  inner.low = (media.low << 8) | (uint)medium;
  return inner;
}

FN MediumStack without_innermost(MediumStack media) {
  MediumStack outer;
  outer.low = (media.low >> 8) | (media.high << 24);
  outer.high = media.high >> 8;
  return outer;
}

FN MediumStack with_innermost(MediumStack media, int medium) {
  media.low = (media.low & ~0xffu) | (uint)medium;
  return media;
}

FN MediumStack select_media(bool condition, MediumStack yes, MediumStack no) {
  MediumStack media;
  media.low = condition ? yes.low : no.low;
  media.high = condition ? yes.high : no.high;
  return media;
}

/// The boundary that the primitive is part of, or -1.
FN int boundary_of(const PRIVATE Scene* scene, int primitive) {
  const int boundary = scene->primitive_boundaries[primitive >= 0 ? primitive : 0];
  return primitive >= 0 ? boundary : -1;
}

typedef struct {
  MediumStack media;  ///< behind the boundary
  bool consistent;    ///< the media before it agree with the boundary
  bool overlaps;      ///< the outer one of two overlapping media is left
  bool unentered;     ///< a medium is left that was never entered
} Crossing;

/// Crosses boundary `boundary` from `media`, into its inside (`inwards`) or out of it. If the boundary
/// contradicts what was crossed before, the boundary is right from here on.
FN Crossing cross_boundary(const PRIVATE Scene* scene, int boundary, bool inwards, MediumStack media) {
  GLOBAL const Boundary* b = scene->boundaries + (boundary >= 0 ? boundary : 0);
  const int interior = b->interior, exterior = b->exterior;
  const bool knows_around = exterior >= 0;
  const bool was_outside = (!knows_around | (exterior == innermost(media))) & ((media.high >> 24) == 0u);
  const bool was_inside = interior == innermost(media);
  // If two media overlap, the outer one is left.
  const MediumStack outer = without_innermost(media);
  const bool leaves_outer = !was_inside & (innermost(outer) == interior);
  const MediumStack left = select_media(
      was_inside, outer, select_media(leaves_outer, with_innermost(outer, innermost(media)), media));
  const bool agrees = !knows_around | (innermost(left) == exterior) | (innermost(left) == 0);
  Crossing crossing;
  crossing.media = select_media(
      inwards, within(media, interior),
      select_media(knows_around & !leaves_outer, with_innermost(left, knows_around ? exterior : 0), left));
  crossing.consistent = inwards ? was_outside : was_inside & agrees;
  crossing.overlaps = !inwards & leaves_outer;
  crossing.unentered = !(inwards | was_inside | leaves_outer);
  return crossing;
}

PENUMBRA_NAMESPACE_END
#endif
