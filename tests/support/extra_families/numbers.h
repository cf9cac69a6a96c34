// The numbers of the tests' additional BSDF families. Tests write them into materials.
#ifndef PENUMBRA_EXTRA_FAMILY_NUMBERS_H
#define PENUMBRA_EXTRA_FAMILY_NUMBERS_H

#define FAMILY_MIRROR 21
#define FAMILY_WINDOW 31
#define FAMILY_REFRACTING 28
#define FAMILY_CRUDE 29
#define FAMILY_GLOSSY 30

#endif
