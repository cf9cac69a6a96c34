// Portable kernel source compiled as C++: everything in which C++, OpenCL C and GLSL differ is a macro
// here, in lang_opencl.h and lang_glsl.h, under the same name.
#pragma once

#define PENUMBRA_NAMESPACE_BEGIN namespace penumbra {
#define PENUMBRA_NAMESPACE_END }

#define FN static inline __attribute__((always_inline, unused))
// One that constants may be made of.
#define CONSTANT_FN static constexpr inline __attribute__((always_inline, unused))
// A function that holds lane loops: never inlined, so that RESTRICT holds and each is optimised by itself.
#define STAGE static __attribute__((noinline, unused))
// A function of its own where kernels are compiled when they are first wanted.
#define CALLED_FN FN
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

// Of constants of 64 bits.
#define ENUM_OF_ULONG enum : ulong

// What a scene needs, a bit mask: its own, of what kernels are compiled for.
#define NEEDED(compiled, own) (own)

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

#if defined(__clang__) && defined(__AVX2__) && defined(__BMI2__)
  // pack_8 is no loop.
  #define PACKS_REGISTERS
#endif
#if !defined(RAYS_IN_FLIGHT) && defined(PACKS_REGISTERS)
  // Rays whose traversals are interleaved (block/block_flight.h); not defined: one after the other, which is
  // faster where pack_8 is a loop.
  #define RAYS_IN_FLIGHT 32
#endif
// Number of bits that are set.
#define BIT_COUNT(x) __builtin_popcount(x)
// Asks for the cache line so many bytes behind an address, which will be read soon; any place will do, and no
// table need be there.
#define PREFETCH(address, bytes) __builtin_prefetch((const void*)((unsigned long)(address) + (bytes)))

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

/// The least of 8.
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

/// Writes those of 8 numbers whose bit is set one after the other, and anything behind them, 8 in all.
FN void pack_8(int* to, const int* from, uint wanted) {
#if defined(__clang__) && defined(__AVX512VL__)
  typedef int Ints __attribute__((ext_vector_type(8), aligned(4)));
  typedef int Register __attribute__((vector_size(32)));
  *(Ints*)to = __builtin_ia32_compresssi256_mask(*(const Ints*)from, Register{}, (unsigned char)wanted);
#elif defined(__clang__) && defined(__AVX2__) && defined(__BMI2__)
  // The bytes of places that are wanted, one after the other, become the register's indices.
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
