// The layers of a film: what a pixel stores besides radiance and its standard deviation. This is the only
// list of them.
#ifndef PENUMBRA_FILM_LAYERS_H
#define PENUMBRA_FILM_LAYERS_H
#include "kernels/features.h"
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

// X(NAME, planes, needs, samples, mean, layer, channels), in the order of the planes:
//   needs     a scene has the layer if it has all of these features
//   samples   the slot field (block/path_state.h) that is averaged; 0: another stage writes the plane
//   mean      FILTERED: weighted by the film's filter, UNFILTERED, or FIRST_SAMPLE: the pixel's first sample
//             alone
//   layer, channels   name in images and letters of the channels; the channel of a single plane may have a
//                     longer name; see scheduler/record/film_image.h
#define PENUMBRA_FILM_LAYERS(X)                                                                              \
  /* reflectance at the first hit, 0 where nothing is hit */                                                 \
  X(ALBEDO, 3, FEATURE_LAYERS, slots->albedo, FILTERED, "albedo", "RGB")                                     \
  /* world-space shading normal at the first hit */                                                          \
  X(NORMAL, 3, FEATURE_LAYERS, slots->normal, FILTERED, "normal", "XYZ")                                     \
  /* distance from the camera to the first hit */                                                            \
  X(DEPTH, 1, FEATURE_LAYERS, slots->distance, FILTERED, "depth", "Z")                                       \
  /* variances of the means of those three. Results hold standard deviations of the samples, films sums of   \
     squared deviations */                                                                                   \
  X(ALBEDO_VARIANCE, 3, FEATURE_LAYERS | FEATURE_DENOISING, 0, FILTERED, "albedo_variance", "RGB")           \
  X(NORMAL_VARIANCE, 3, FEATURE_LAYERS | FEATURE_DENOISING, 0, FILTERED, "normal_variance", "XYZ")           \
  X(DEPTH_VARIANCE, 1, FEATURE_LAYERS | FEATURE_DENOISING, 0, FILTERED, "depth_variance", "Z")               \
  /* closed form: unshadowed radiance from polygon lights */                                                 \
  X(ANALYTIC, 3, FEATURE_LAYERS | FEATURE_POLYGONS, 0, FILTERED, "analytic", "RGB")                          \
  /* their estimate minus that closed form: mostly shadows, at most 0 in expectation */                      \
  X(DIFFERENCE, 3, FEATURE_LAYERS | FEATURE_POLYGONS, 0, FILTERED, "difference", "RGB")                      \
  /* light samples of polygon lights, summed over channels, with and without shadows; images show their      \
     quotient */                                                                                             \
  X(SHADOWED, 1, FEATURE_LAYERS | FEATURE_POLYGONS, 0, UNFILTERED, "visibility", "Y")                        \
  X(UNSHADOWED, 1, FEATURE_LAYERS | FEATURE_POLYGONS, 0, UNFILTERED, "", "")                                 \
  /* radiance of half of the samples and of the others, and the share of the first half. A half is stored as \
     its sum over the number of all samples; images show its mean */                                         \
  X(HALF_A, 3, FEATURE_DENOISING, 0, FILTERED, "half_a", "RGB")                                              \
  X(HALF_B, 3, FEATURE_DENOISING, 0, FILTERED, "half_b", "RGB")                                              \
  X(HALF_SHARE, 1, FEATURE_DENOISING, 0, UNFILTERED, "", "")                                                 \
  /* fraction of samples that hit a surface or a visible sky. It is not filtered: with filter weights a      \
     fully covered pixel would have alpha 1 only in expectation */                                           \
  X(COVERAGE, 1, FEATURE_COVERAGE, slots->coverage, UNFILTERED, "", "A")                                     \
  /* Layers on demand, see LAYERS_ON_DEMAND. The first hit in world space, 0 where nothing is hit */         \
  X(POSITION, 3, FEATURE_POSITION_LAYER, slots->position, FILTERED, "position", "XYZ")                       \
  /* texture coordinates of the first hit */                                                                 \
  X(UV, 2, FEATURE_UV_LAYER, slots->uv, FILTERED, "uv", "UV")                                                \
  /* world-space normal of the geometry at the first hit, on the camera's side */                            \
  X(GEOMETRIC_NORMAL, 3, FEATURE_GEOMETRIC_NORMAL_LAYER, slots->geometric_normal, FILTERED,                  \
    "geometric_normal", "XYZ")                                                                               \
  /* number of the shape that the first sample hits, from 1 on; 0: nothing. Means of numbers would be        \
     numbers of other shapes */                                                                              \
  X(SHAPE, 1, FEATURE_SHAPE_LAYER, slots->shape, FIRST_SAMPLE, "shape", "ID")                                \
  /* light of paths that scatter at most once, and of the others. Their sum is the radiance */               \
  X(DIRECT, 3, FEATURE_DIRECT_LAYER, slots->direct, FILTERED, "direct", "RGB")                               \
  X(INDIRECT, 3, FEATURE_INDIRECT_LAYER, slots->indirect, FILTERED, "indirect", "RGB")                       \
  /* pixels, to the right and down, from where the middle of the frame shows the first hit to where that of  \
     the frame before, and of the next one, show it */                                                       \
  X(MOTION_BEFORE, 2, FEATURE_MOTION_LAYER, slots->motion_before, FILTERED, "motion", "XY")                  \
  X(MOTION_AFTER, 2, FEATURE_MOTION_LAYER, slots->motion_after, FILTERED, "motion", "ZW")

#define UNFILTERED 0
#define FILTERED 1
#define FIRST_SAMPLE 2

#define ENUMERATE_LAYER(NAME, planes, needs, samples, mean, layer, channels) LAYER_##NAME,
enum { PENUMBRA_FILM_LAYERS(ENUMERATE_LAYER) FILM_LAYERS };
#undef ENUMERATE_LAYER

/// The features of layers that a scene has only if they are asked for.
#define LAYERS_ON_DEMAND                                                                              \
  (FEATURE_POSITION_LAYER | FEATURE_UV_LAYER | FEATURE_GEOMETRIC_NORMAL_LAYER | FEATURE_SHAPE_LAYER | \
   FEATURE_DIRECT_LAYER | FEATURE_INDIRECT_LAYER | FEATURE_MOTION_LAYER)

/// The planes that every result has before its layers: mean radiance (3) and its standard deviation (3).
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

/// Index of the first plane of `layer` in results of a scene with these features. For FILM_LAYERS: the number
/// of planes.
CONSTANT_FN int layer_plane(ulong features, int layer) {
  int plane = RADIANCE_PLANES;
#define LAYER_BEFORE(NAME, planes, needs, samples, mean, name, channels) \
  plane += LAYER_##NAME < layer && LAYER_IS_THERE(features, needs) ? planes : 0;
  PENUMBRA_FILM_LAYERS(LAYER_BEFORE)
#undef LAYER_BEFORE
  return plane;
}

/// The planes of ALBEDO, NORMAL and DEPTH, the first of the layers. As many planes of variances follow them.
#define FEATURE_PLANES 7

CONSTANT_FN int plane_count(ulong features) { return layer_plane(features, FILM_LAYERS); }

PENUMBRA_NAMESPACE_END
#endif
