// The numbers of the stand-in families, which tests patch into materials.
#ifndef PENUMBRA_STAND_IN_NUMBERS_H
#define PENUMBRA_STAND_IN_NUMBERS_H

#define FAMILY_MIRROR 16
#define FAMILY_WINDOW 17
#define FAMILY_REFRACTING 18
#define FAMILY_GLOSSY 19
#define FAMILY_PHONG_A 20
#define FAMILY_PHONG_B 21
#define FAMILY_PHONG_C 22
#define FAMILY_PHONG_D 23
#define FAMILY_PHONG_E 24
#define FAMILY_PHONG_F 25
#define FAMILY_PHONG_G 26
#define FAMILY_PHONG_H 27
#define FAMILY_SPLITTING 28

#endif
