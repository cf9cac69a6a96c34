// Portable kernel source compiled as OpenCL C 1.2; the counterpart of lang_cpp.h.
#pragma OPENCL FP_CONTRACT OFF

#define PENUMBRA_NAMESPACE_BEGIN
#define PENUMBRA_NAMESPACE_END

#define FN static inline __attribute__((always_inline))
#define STAGE static __attribute__((noinline))
#define GLOBAL __global
#define PRIVATE __private
#define RESTRICT restrict

#ifndef LANES
  #define LANES 16
#endif
#define PENUMBRA_PRAGMA(x) _Pragma(#x)
#if LANES > 1 && defined(__clang__)
  #define LANE_LOOP_WIDTH(n) PENUMBRA_PRAGMA(clang loop vectorize(assume_safety) vectorize_width(n))
#else
  #define LANE_LOOP_WIDTH(n)
#endif
#define LANE_LOOP_(n) LANE_LOOP_WIDTH(n)
// The registers of the target: wider vectors than that spill.
#ifndef VECTOR_WIDTH
  #define VECTOR_WIDTH LANES
#endif
#define LANE_LOOP LANE_LOOP_(VECTOR_WIDTH)

#define SQRT(x) sqrt((float)(x))
#define FABS(x) fabs((float)(x))
#define FLOAT_BITS(x) as_uint((float)(x))
#define BITS_FLOAT(x) as_float((uint)(x))
#ifdef __has_builtin
  #if __has_builtin(__builtin_bitreverse32)
    #define BIT_REVERSE(x) __builtin_bitreverse32(x)
  #endif
#endif
