// The numbers of the tests' additional BSDF families. Tests write them into materials.
#ifndef PENUMBRA_EXTRA_FAMILY_NUMBERS_H
#define PENUMBRA_EXTRA_FAMILY_NUMBERS_H

#define FAMILY_CRUDE 21
#define FAMILY_MIRROR 22
#define FAMILY_WINDOW 23
#define FAMILY_REFRACTING 24
#define FAMILY_GLOSSY 25
#define FAMILY_PHONG_A 26
#define FAMILY_PHONG_B 27
#define FAMILY_PHONG_C 28
#define FAMILY_PHONG_D 29
#define FAMILY_PHONG_E 30
#define FAMILY_PHONG_F 31

#endif
