// Portable kernel source compiled as C++: everything in which C++, OpenCL C and GLSL differ is a macro
// here, in lang_opencl.h and lang_glsl.h, under the same name.
#pragma once

#define PENUMBRA_NAMESPACE_BEGIN namespace penumbra {
#define PENUMBRA_NAMESPACE_END }

#define FN static inline __attribute__((always_inline, unused))
// A function that holds lane loops: never inlined, so that RESTRICT holds and each is optimised by itself.
#define STAGE static __attribute__((noinline, unused))
#define GLOBAL
#define PRIVATE
#define RESTRICT __restrict
#define CONSTANT_TABLE static constexpr

// A struct, as STRUCT(Name) { fields };
#define STRUCT(name)        \
  typedef struct name name; \
  struct name
// Both or either of two bools, without a branch between them.
#define BOTH(a, b) ((a) & (b))
#define EITHER(a, b) ((a) | (b))
// Conversions.
#define TO_INT(x) ((int)(x))
#define TO_UINT(x) ((uint)(x))
#define TO_FLOAT(x) ((float)(x))

#define SQRT(x) __builtin_sqrtf(x)
#define FABS(x) __builtin_fabsf(x)
#define FLOAT_BITS(x) __builtin_bit_cast(unsigned int, float(x))
#define BITS_FLOAT(x) __builtin_bit_cast(float, (unsigned int)(x))
#define SQRT_D(x) __builtin_sqrt(x)
#define FABS_D(x) __builtin_fabs(x)
#define DOUBLE_BITS(x) __builtin_bit_cast(unsigned long, double(x))
#define BITS_DOUBLE(x) __builtin_bit_cast(double, (unsigned long)(x))
// Index of the lowest bit that is set; there is one.
#define LOWEST_BIT(x) __builtin_ctz(x)
#ifdef __clang__
  #define BIT_REVERSE(x) __builtin_bitreverse32(x)
#endif

PENUMBRA_NAMESPACE_BEGIN
using uint = unsigned int;
using ulong = unsigned long;

/// Bit j of the result says whether wanted[j], of 8, is not 0.
FN uint mask_of_8(const int* wanted) {
#ifdef __clang__
  typedef int Ints __attribute__((ext_vector_type(8), aligned(4)));
  typedef bool Bools __attribute__((ext_vector_type(8)));
  return __builtin_bit_cast(unsigned char, __builtin_convertvector(*(const Ints*)wanted != 0, Bools));
#else
  uint mask = 0;
  for (int j = 0; j < 8; j++) mask |= wanted[j] != 0 ? 1u << j : 0u;
  return mask;
#endif
}
PENUMBRA_NAMESPACE_END
