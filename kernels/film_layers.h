// The layers of a film: what its pixels have beside radiance and its deviation. This is the one list of them.
#ifndef PENUMBRA_FILM_LAYERS_H
#define PENUMBRA_FILM_LAYERS_H
#include "kernels/features.h"
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

// X(NAME, planes, needs, samples, mean, layer, channels), in the order of their planes:
//   needs     a scene has the layer where it has all of these features
//   samples   the field of the samples whose mean it is, of block/path_state.h; 0: another stage writes it
//   mean      FILTERED by the film's filter, or UNFILTERED
//   layer, channels   its name in images and the letters of its channels, see scheduler/record/film_image.h
#define PENUMBRA_FILM_LAYERS(X)                                                                            \
  /* reflectance at the first hit, 0 where nothing is hit */                                               \
  X(ALBEDO, 3, FEATURE_LAYERS, slots->albedo, FILTERED, "albedo", "RGB")                                   \
  /* world-space shading normal there */                                                                   \
  X(NORMAL, 3, FEATURE_LAYERS, slots->normal, FILTERED, "normal", "XYZ")                                   \
  /* distance from the camera to there */                                                                  \
  X(DEPTH, 1, FEATURE_LAYERS, slots->distance, FILTERED, "depth", "Z")                                     \
  /* the closed form: radiance by polygon lights without shadows */                                        \
  X(ANALYTIC, 3, FEATURE_LAYERS | FEATURE_POLYGONS, 0, FILTERED, "analytic", "RGB")                        \
  /* what the estimate of their light differs from it by, shadows above all: at most 0 in expectation */   \
  X(DIFFERENCE, 3, FEATURE_LAYERS | FEATURE_POLYGONS, 0, FILTERED, "difference", "RGB")                    \
  /* the samples of their light, all channels together, and those without shadows: their quotient is shown \
   */                                                                                                      \
  X(SHADOWED, 1, FEATURE_LAYERS | FEATURE_POLYGONS, 0, UNFILTERED, "visibility", "Y")                      \
  X(UNSHADOWED, 1, FEATURE_LAYERS | FEATURE_POLYGONS, 0, UNFILTERED, "", "")                               \
  /* the share of the samples that hit something, or a sky that is seen. Whatever their filter weights: by \
     those what is covered everywhere would be 1 only in the mean */                                       \
  X(COVERAGE, 1, FEATURE_COVERAGE, slots->coverage, UNFILTERED, "", "A")

#define ENUMERATE_LAYER(NAME, planes, needs, samples, mean, layer, channels) LAYER_##NAME,
enum { PENUMBRA_FILM_LAYERS(ENUMERATE_LAYER) FILM_LAYERS };
#undef ENUMERATE_LAYER

/// Planes that every result has, before those of its layers: mean radiance, and its standard deviation.
#define RADIANCE_PLANES 6

#define LAYER_IS_THERE(features, needs) ((~(features) & (needs)) == 0)

CONSTANT_FN bool has_layer(ulong features, int layer) {
  bool there = false;
#define THAT_LAYER(NAME, planes, needs, samples, mean, name, channels) \
  there = layer == LAYER_##NAME ? LAYER_IS_THERE(features, needs) : there;
  PENUMBRA_FILM_LAYERS(THAT_LAYER)
#undef THAT_LAYER
  return there;
}

/// The first plane of a layer in results of a scene with these features; of FILM_LAYERS how many planes those
/// have.
CONSTANT_FN int layer_plane(ulong features, int layer) {
  int plane = RADIANCE_PLANES;
#define LAYER_BEFORE(NAME, planes, needs, samples, mean, name, channels) \
  plane += LAYER_##NAME < layer && LAYER_IS_THERE(features, needs) ? planes : 0;
  PENUMBRA_FILM_LAYERS(LAYER_BEFORE)
#undef LAYER_BEFORE
  return plane;
}

CONSTANT_FN int plane_count(ulong features) { return layer_plane(features, FILM_LAYERS); }

PENUMBRA_NAMESPACE_END
#endif
