// Portable kernel source compiled as OpenCL C 1.2. Macros that lang_cpp.h has too are documented there.
#pragma OPENCL FP_CONTRACT OFF

#define PENUMBRA_NAMESPACE_BEGIN
#define PENUMBRA_NAMESPACE_END

// Not static: compilers change the parameters of static functions before inlining them. LANE_LOOP's promise
// that arrays do not overlap is then lost, and each loop compares every pair of arrays at run time. PoCL 3.1
// defines `inline` as nothing, which would make each FN a separate function to optimise and keep.
#undef inline
#define FN inline __attribute__((always_inline))
#define CONSTANT_FN FN
// On GPUs, stages are inlined into their kernel. With one lane there are no loops to keep apart, and values
// that stages would pass through memory stay in registers.
#ifdef INLINE_STAGES
  #define STAGE static inline __attribute__((always_inline))
#endif
// Compilers avoid 512-bit registers unless an attribute says that a function needs them. PoCL 3.1 is 1.4
// times as fast with them.
#if !defined(STAGE) && defined(__has_attribute) && VECTOR_WIDTH >= 16
  #if __has_attribute(min_vector_width)
    #define STAGE static __attribute__((noinline, min_vector_width(512)))
  #endif
#endif
#ifndef STAGE
  #define STAGE static __attribute__((noinline))
#endif
// For long functions that are called in several places, or rarely: CPUs compile them once instead of once per
// call.
#if LANES == 1
  #define CALLED_FN FN
#else
  #define CALLED_FN STAGE
#endif
#define JIT_CALLED_FN CALLED_FN
#define GLOBAL __global
#define PRIVATE __private
#define RESTRICT restrict
#define CONSTANT_TABLE __constant

// See lang_cpp.h. Work items share counters.
#define FETCH_AND_INCREMENT(counter) atomic_inc(counter)
#define STRUCT(name)        \
  typedef struct name name; \
  struct name
#define BOTH(a, b) ((a) & (b))
#define EITHER(a, b) ((a) | (b))
#define TO_INT(x) ((int)(x))
#define TO_UINT(x) ((uint)(x))
#define TO_FLOAT(x) ((float)(x))

#define ENUM_OF_ULONG enum

// Kernels are compiled for exactly the features of their scene, so that compilers drop the rest.
#define NEEDED(compiled, own) (compiled)

#define SQRT(x) sqrt((float)(x))
#define FABS(x) fabs((float)(x))
#define FLOAT_BITS(x) as_uint((float)(x))
#define BITS_FLOAT(x) as_float((uint)(x))
// Closed forms use double. Devices without double only have to compile them: no kernel calls them there.
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
#define BIT_COUNT(x) popcount(x)
#define LOWEST_BIT(x) (31 - (int)clz((uint)(x) & (0u - (uint)(x))))
#ifdef __has_builtin
  #if __has_builtin(__builtin_bitreverse32)
    #define BIT_REVERSE(x) __builtin_bitreverse32(x)
  #endif
#endif

/// Bit j of the result is set if wanted[j] is not 0; `wanted` has 8 elements.
FN uint mask_of_8(const PRIVATE int* wanted) {
  const int8 bits = (int8)(1, 2, 4, 8, 16, 32, 64, 128);
  const int8 some = (vload8(0, wanted) != 0) & bits;
  const int4 four = some.lo | some.hi;
  const int2 two = four.lo | four.hi;
  return (uint)(two.lo | two.hi);
}
