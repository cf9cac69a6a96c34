// The numbers of the tests' additional BSDF families. Tests write them into materials.
#ifndef PENUMBRA_EXTRA_FAMILY_NUMBERS_H
#define PENUMBRA_EXTRA_FAMILY_NUMBERS_H

#define FAMILY_MIRROR 24
#define FAMILY_WINDOW 25
#define FAMILY_REFRACTING 26
#define FAMILY_GLOSSY 27
#define FAMILY_PHONG_A 28
#define FAMILY_PHONG_B 29
#define FAMILY_PHONG_C 30
#define FAMILY_CRUDE 31

#endif
