// Picks the language header and defines what is the same in all of them. Portable sources include this first
// and nothing from any standard library.
#ifndef PENUMBRA_LANG_H
#define PENUMBRA_LANG_H
#if defined(PENUMBRA_GLSL)
  #include "kernels/lang_glsl.h"
#elif defined(__OPENCL_VERSION__)
  #include "kernels/lang_opencl.h"
#else
  #include "kernels/lang_cpp.h"
#endif

// LANES paths are carried through one vectorised loop; 1 for debugging a single path. VECTOR_WIDTH of them
// share a register of the target: wider vectors than that spill.
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
  // Before a loop of few, constant turns inside a lane loop: only straight code vectorises.
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
  // Before a loop of exactly n turns, a register's worth. Clang would unroll it first and lose its shape.
  #define REGISTER_LOOP(n) \
    PENUMBRA_PRAGMA(clang loop vectorize(assume_safety) vectorize_width(n) unroll(disable))
#else
  #define REGISTER_LOOP(n)
#endif
// Of an array that a REGISTER_LOOP of 8 turns writes: within one cache line, or reading from it waits.
#define REGISTER_ARRAY __attribute__((aligned(32)))
#define LANE_LOOP_(n) LANE_LOOP_WIDTH(n)
#define LANE_LOOP LANE_LOOP_(VECTOR_WIDTH)

#endif
