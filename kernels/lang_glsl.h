// Portable kernel source as GLSL 3.30, for the closed forms on the screen: a C preprocessor makes one text of
// it at build time. What is shared has no pointers, no casts but the macros' and no `const` that a fragment's
// values decide; it is in single precision, since GLSL 3.30 has no other.
#pragma once

#define PENUMBRA_NAMESPACE_BEGIN
#define PENUMBRA_NAMESPACE_END

#define FN
#define double float
#define vec3d vec3
// Of a local variable it would mean a constant expression.
#define const

#define STRUCT(name) struct name
#define BOTH(a, b) ((a) && (b))
#define EITHER(a, b) ((a) || (b))
#define TO_INT(x) int(x)
#define TO_UINT(x) uint(x)
#define TO_FLOAT(x) float(x)

#define SQRT(x) sqrt(x)
#define FABS(x) abs(x)
#define FLOAT_BITS(x) floatBitsToUint(x)
#define BITS_FLOAT(x) uintBitsToFloat(x)
#define SQRT_D(x) sqrt(x)
#define FABS_D(x) abs(x)
