// The numbers of the stand-in families, which tests patch into materials.
#ifndef PENUMBRA_STAND_IN_NUMBERS_H
#define PENUMBRA_STAND_IN_NUMBERS_H

#define FAMILY_CRUDE 19
#define FAMILY_MIRROR 20
#define FAMILY_WINDOW 21
#define FAMILY_REFRACTING 22
#define FAMILY_GLOSSY 23
#define FAMILY_PHONG_A 24
#define FAMILY_PHONG_B 25
#define FAMILY_PHONG_C 26
#define FAMILY_PHONG_D 27
#define FAMILY_PHONG_E 28
#define FAMILY_PHONG_F 29
#define FAMILY_PHONG_G 30
#define FAMILY_PHONG_H 31

#endif
