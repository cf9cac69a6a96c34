// The numbers of the stand-in families, which tests patch into materials.
#ifndef PENUMBRA_STAND_IN_NUMBERS_H
#define PENUMBRA_STAND_IN_NUMBERS_H

#define FAMILY_CRUDE 20
#define FAMILY_MIRROR 21
#define FAMILY_WINDOW 22
#define FAMILY_REFRACTING 23
#define FAMILY_GLOSSY 24
#define FAMILY_PHONG_A 25
#define FAMILY_PHONG_B 26
#define FAMILY_PHONG_C 27
#define FAMILY_PHONG_D 28
#define FAMILY_PHONG_E 29
#define FAMILY_PHONG_F 30
#define FAMILY_PHONG_G 31

#endif
