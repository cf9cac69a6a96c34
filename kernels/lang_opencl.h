// Portable kernel source compiled as OpenCL C 1.2; the counterpart of lang_cpp.h.
#pragma OPENCL FP_CONTRACT OFF

#define PENUMBRA_NAMESPACE_BEGIN
#define PENUMBRA_NAMESPACE_END

// Not static: compilers change the parameters of static functions before they inline them, and with them goes
// what LANE_LOOP says of the accesses inside, which then cost a comparison of each two arrays.
// PoCL 3.1 defines `inline` away, which would make each of them a function to optimise and to keep.
#undef inline
#define FN inline __attribute__((always_inline))
#define CONSTANT_FN FN
// Stages that GPUs run are part of their kernel: with one lane there are no loops to keep apart, and what
// would be handed from function to function in memory stays in registers.
#ifdef INLINE_STAGES
  #define STAGE static inline __attribute__((always_inline))
#endif
// Compilers shy away from registers of 512 bits unless told that a function needs them: PoCL 3.1 is 1.4 times
// as fast with them.
#if !defined(STAGE) && defined(__has_attribute) && VECTOR_WIDTH >= 16
  #if __has_attribute(min_vector_width)
    #define STAGE static __attribute__((noinline, min_vector_width(512)))
  #endif
#endif
#ifndef STAGE
  #define STAGE static __attribute__((noinline))
#endif
// What is long and called in several places, or not often: CPUs compile it once, not wherever it is called.
#if LANES == 1
  #define CALLED_FN FN
#else
  #define CALLED_FN STAGE
#endif
#define GLOBAL __global
#define PRIVATE __private
#define RESTRICT restrict
#define CONSTANT_TABLE __constant

// See lang_cpp.h.
#define STRUCT(name)        \
  typedef struct name name; \
  struct name
#define BOTH(a, b) ((a) & (b))
#define EITHER(a, b) ((a) | (b))
#define TO_INT(x) ((int)(x))
#define TO_UINT(x) ((uint)(x))
#define TO_FLOAT(x) ((float)(x))

#define ENUM_OF_ULONG enum

// Kernels are compiled for exactly what their scene needs, so that compilers drop the rest.
#define NEEDED(compiled, own) (compiled)

#define SQRT(x) sqrt((float)(x))
#define FABS(x) fabs((float)(x))
#define FLOAT_BITS(x) as_uint((float)(x))
#define BITS_FLOAT(x) as_float((uint)(x))
// Closed forms are in double. Where a device has none, they only have to compile: no kernel calls them there.
#ifdef cl_khr_fp64
  #pragma OPENCL EXTENSION cl_khr_fp64 : enable
  #define DOUBLE_BITS(x) as_ulong((double)(x))
  #define BITS_DOUBLE(x) as_double((ulong)(x))
#else
  #define double float
  #define DOUBLE_BITS(x) ((ulong)(x))
  #define BITS_DOUBLE(x) ((float)(x))
#endif
#define SQRT_D(x) sqrt((double)(x))
#define FABS_D(x) fabs((double)(x))
#define LOWEST_BIT(x) (31 - (int)clz((uint)(x) & (0u - (uint)(x))))
#ifdef __has_builtin
  #if __has_builtin(__builtin_bitreverse32)
    #define BIT_REVERSE(x) __builtin_bitreverse32(x)
  #endif
#endif

/// Bit j of the result says whether wanted[j], of 8, is not 0.
FN uint mask_of_8(const PRIVATE int* wanted) {
  const int8 bits = (int8)(1, 2, 4, 8, 16, 32, 64, 128);
  const int8 some = (vload8(0, wanted) != 0) & bits;
  const int4 four = some.lo | some.hi;
  const int2 two = four.lo | four.hi;
  return (uint)(two.lo | two.hi);
}
