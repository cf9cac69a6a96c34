// Portable kernel source compiled as C++. C++, OpenCL C and GLSL differ only in macros, which this file,
// lang_opencl.h and lang_glsl.h define under the same names.
#pragma once

#define PENUMBRA_NAMESPACE_BEGIN namespace penumbra {
#define PENUMBRA_NAMESPACE_END }

#define FN static inline __attribute__((always_inline, unused))
// A function that constant expressions may call.
#define CONSTANT_FN static constexpr inline __attribute__((always_inline, unused))
// A function that contains lane loops. It is never inlined, so that RESTRICT holds and each stage is
// optimised on its own.
#define STAGE static __attribute__((noinline, unused))
// A long function that is called in several places, or rarely: it is compiled once instead of once per call.
#define CALLED_FN static __attribute__((noinline, unused))
// The same, but so short that here it is like FN.
#define JIT_CALLED_FN FN
#define GLOBAL
#define PRIVATE
#define RESTRICT __restrict
#define CONSTANT_TABLE static constexpr

// Declares a struct: STRUCT(Name) { fields };
#define STRUCT(name)        \
  typedef struct name name; \
  struct name
// Logical and / or of two bools without a branch.
#define BOTH(a, b) ((a) & (b))
#define EITHER(a, b) ((a) | (b))
#define TO_INT(x) ((int)(x))
#define TO_UINT(x) ((uint)(x))
#define TO_FLOAT(x) ((float)(x))

// An enumeration with 64-bit constants.
#define ENUM_OF_ULONG enum : ulong

// The features that a scene needs. Native code reads the scene's own mask at run time; OpenCL uses the mask
// that kernels are compiled for.
#define NEEDED(compiled, own) (own)

#define SQRT(x) __builtin_sqrtf(x)
#define FABS(x) __builtin_fabsf(x)
#define FLOAT_BITS(x) __builtin_bit_cast(unsigned int, float(x))
#define BITS_FLOAT(x) __builtin_bit_cast(float, (unsigned int)(x))
#define SQRT_D(x) __builtin_sqrt(x)
#define FABS_D(x) __builtin_fabs(x)
#define DOUBLE_BITS(x) __builtin_bit_cast(unsigned long, double(x))
#define BITS_DOUBLE(x) __builtin_bit_cast(double, (unsigned long)(x))
// Index of the lowest set bit; x must not be 0.
#define LOWEST_BIT(x) __builtin_ctz(x)
#ifdef __clang__
  #define BIT_REVERSE(x) __builtin_bitreverse32(x)
#endif

#if defined(__clang__) && defined(__AVX2__) && defined(__BMI2__)
  // pack_8 needs no loop here.
  #define PACKS_REGISTERS
#endif
#if !defined(RAYS_IN_FLIGHT) && defined(PACKS_REGISTERS)
  // The number of rays whose traversals are interleaved (block/block_flight.h). If it is undefined, rays are
  // traced one after the other, which is faster where pack_8 needs a loop.
  #define RAYS_IN_FLIGHT 32
#endif
// Increments *counter and returns what it was. Each counter belongs to one thread.
#define FETCH_AND_INCREMENT(counter) ((*(counter))++)
// Number of set bits.
#define BIT_COUNT(x) __builtin_popcount(x)
// Prefetches the cache line at `address` + `bytes`. Any address is allowed, even one outside of a table.
#define PREFETCH(address, bytes) __builtin_prefetch((const void*)((unsigned long)(address) + (bytes)))

PENUMBRA_NAMESPACE_BEGIN
using uint = unsigned int;
using ulong = unsigned long;

/// Bit j of the result is set if wanted[j] is not 0; `wanted` has 8 elements.
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

/// The minimum of 8 numbers.
FN int least_of_8(const int* values) {
#ifdef __clang__
  typedef int Ints __attribute__((ext_vector_type(8), aligned(4)));
  return __builtin_reduce_min(*(const Ints*)values);
#else
  int least = values[0];
  for (int j = 1; j < 8; j++) least = values[j] < least ? values[j] : least;
  return least;
#endif
}

/// Packs those of 8 numbers whose bit in `wanted` is set to the front of `to`. May write 8 elements; those
/// behind the packed ones are arbitrary.
FN void pack_8(int* to, const int* from, uint wanted) {
#if defined(__clang__) && defined(__AVX512VL__)
  typedef int Ints __attribute__((ext_vector_type(8), aligned(4)));
  typedef int Register __attribute__((vector_size(32)));
  *(Ints*)to = __builtin_ia32_compresssi256_mask(*(const Ints*)from, Register{}, (unsigned char)wanted);
#elif defined(__clang__) && defined(__AVX2__) && defined(__BMI2__)
  // The byte indices of the wanted elements, packed, become the indices of the permutation.
  typedef int Ints __attribute__((ext_vector_type(8), aligned(4)));
  typedef int Register __attribute__((vector_size(32)));
  typedef unsigned char Bytes __attribute__((vector_size(8)));
  const ulong bytes = __builtin_ia32_pdep_di(wanted, 0x0101010101010101ul) * 0xfful;
  const ulong places = __builtin_ia32_pext_di(0x0706050403020100ul, bytes);
  *(Ints*)to = __builtin_ia32_permvarsi256(
      *(const Ints*)from, __builtin_convertvector(__builtin_bit_cast(Bytes, places), Register));
#else
  for (uint left = wanted; left != 0u; left &= left - 1u) *to++ = from[LOWEST_BIT(left)];
#endif
}
PENUMBRA_NAMESPACE_END
