// Portable kernel source compiled as C++: everything in which C++ and OpenCL C differ is a macro here or in
// lang_opencl.h, under the same name.
#pragma once

#define PENUMBRA_NAMESPACE_BEGIN namespace penumbra {
#define PENUMBRA_NAMESPACE_END }

#define FN static inline __attribute__((always_inline, unused))
// A function that holds lane loops: never inlined, so that RESTRICT holds and each is optimised by itself.
#define STAGE static __attribute__((noinline, unused))
#define GLOBAL
#define PRIVATE
#define RESTRICT __restrict

#define SQRT(x) __builtin_sqrtf(x)
#define FABS(x) __builtin_fabsf(x)
#define FLOAT_BITS(x) __builtin_bit_cast(unsigned int, float(x))
#define BITS_FLOAT(x) __builtin_bit_cast(float, (unsigned int)(x))
#define SQRT_D(x) __builtin_sqrt(x)
#define FABS_D(x) __builtin_fabs(x)
#define DOUBLE_BITS(x) __builtin_bit_cast(unsigned long, double(x))
#define BITS_DOUBLE(x) __builtin_bit_cast(double, (unsigned long)(x))
#ifdef __clang__
  #define BIT_REVERSE(x) __builtin_bitreverse32(x)
#endif

PENUMBRA_NAMESPACE_BEGIN
using uint = unsigned int;
using ulong = unsigned long;
PENUMBRA_NAMESPACE_END
