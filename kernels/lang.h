// Includes the header for the language that is compiled, and defines what all languages share. Portable
// sources include this file first, and nothing from a standard library.
#ifndef PENUMBRA_LANG_H
#define PENUMBRA_LANG_H
#if defined(PENUMBRA_GLSL)
  #include "kernels/lang_glsl.h"
#elif defined(__OPENCL_VERSION__)
  #include "kernels/lang_opencl.h"
#else
  #include "kernels/lang_cpp.h"
#endif

// LANES paths go through one vectorised loop; LANES is 1 for debugging a single path. VECTOR_WIDTH lanes fill
// one register of the target: wider vectors would spill.
#ifndef LANES
  #define LANES 16
#endif
#ifndef VECTOR_WIDTH
  #define VECTOR_WIDTH LANES
#endif

#define PENUMBRA_PRAGMA(x) _Pragma(#x)
#if defined(PENUMBRA_GLSL)
  #define UNROLL
#elif defined(__clang__)
  // For a loop with a small constant number of iterations inside a lane loop: compilers vectorise the lane
  // loop only if its body has no inner loop.
  #define UNROLL PENUMBRA_PRAGMA(clang loop unroll(full))
#else
  #define UNROLL
#endif
#if LANES > 1 && defined(__clang__)
  #define LANE_LOOP_WIDTH(n) PENUMBRA_PRAGMA(clang loop vectorize(assume_safety) vectorize_width(n))
#else
  #define LANE_LOOP_WIDTH(n)
#endif
#ifdef __clang__
  // For a loop of exactly n iterations, which fit one register. Without the pragma Clang unrolls the loop
  // first and then fails to vectorise it.
  #define REGISTER_LOOP(n) \
    PENUMBRA_PRAGMA(clang loop vectorize(assume_safety) vectorize_width(n) unroll(disable))
#else
  #define REGISTER_LOOP(n)
#endif
// For an array that a REGISTER_LOOP of 8 iterations writes: aligned, so that a register never spans two cache
// lines, which would stall the loads that follow.
#define REGISTER_ARRAY __attribute__((aligned(32)))
#define LANE_LOOP_(n) LANE_LOOP_WIDTH(n)
#define LANE_LOOP LANE_LOOP_(VECTOR_WIDTH)
// For a loop over lanes that stays one.
#ifdef __clang__
  #define PLAIN_LOOP PENUMBRA_PRAGMA(clang loop vectorize(disable) unroll(disable))
#else
  #define PLAIN_LOOP
#endif

#endif
