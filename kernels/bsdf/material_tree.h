// Material trees: at each point of a surface, an inner node is one of two other materials at random. A leaf
// scatters, or is empty, so that rays pass through. Descents end, since children have lower indices. Thin
// panes (FEATURE_PANES) are leaves that rays pass at random, and mirrors for the other rays: transmission
// then does not depend on the path's BSDF samples, so that shadow rays pass, too.
#ifndef PENUMBRA_MATERIAL_TREE_H
#define PENUMBRA_MATERIAL_TREE_H
#include "kernels/bsdf/dielectric.h"
#include "kernels/intersect/surface_fields.h"
#include "kernels/scene.h"
#include "kernels/texture/texture.h"

PENUMBRA_NAMESPACE_BEGIN

/// PASSES_* of a material; -1 (empty) passes all.
FN int passes_of(const PRIVATE Scene* scene, int material) {
  const int passes = scene->materials[material >= 0 ? material : 0].passes;
  return material >= 0 ? passes : PASSES_ALL;
}

/// Whether the material, an index or -1, is an inner node.
FN bool is_branch(const PRIVATE Scene* scene, int material) {
  const int branches = scene->materials[material >= 0 ? material : 0].branches;
  return (material >= 0) & (branches != 0);
}

FN bool any_branch(const PRIVATE Scene* scene, const PRIVATE int* materials) {
  int any = 0;
  for (int j = 0; j < LANES; j++) any |= is_branch(scene, materials[j]) ? 1 : 0;
  return any != 0;
}

/// The relative refractive index of the material (an index, or -1) if it is a thin pane, else 0.
FN float pane_of(const PRIVATE Scene* scene, int material) {
  const float pane = scene->materials[material >= 0 ? material : 0].pane;
  return material >= 0 ? pane : 0.0f;
}

FN bool any_pane(const PRIVATE Scene* scene, const PRIVATE int* materials) {
  int any = 0;
  for (int j = 0; j < LANES; j++) any |= pane_of(scene, materials[j]) > 0.0f ? 1 : 0;
  return any != 0;
}

/// Whether any of the materials needs a random number.
FN bool any_chance(const PRIVATE Scene* scene, const PRIVATE int* materials) {
  if (NEEDS(scene, PANES) && any_pane(scene, materials)) return true;
  return any_branch(scene, materials);
}

STAGE void plain_weights(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT materials,
                         PRIVATE float* RESTRICT weights) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int material = materials[j];
      weights[j] = scene->materials[material >= 0 ? material : 0].weight;
    }
}

STAGE bool note_weight_textures(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT materials,
                                PRIVATE int* RESTRICT textures) {
  int any = 0;
  for (int j = 0; j < LANES; j++) {
    const int material = materials[j];
    const int texture = scene->materials[material >= 0 ? material : 0].weight_texture;
    textures[j] = material >= 0 ? texture : -1;
    any |= textures[j] >= 0 ? 1 : 0;
  }
  return any != 0;
}

STAGE void textured_weights(const PRIVATE int* RESTRICT textures, const PRIVATE TextureLanes* RESTRICT found,
                            PRIVATE float* RESTRICT weights) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float value = clamp_f(luminance(LOAD_LANE_vec3(found->value, j)), 0.0f, 1.0f);
      const float plain = weights[j];
      weights[j] = textures[j] >= 0 ? value : plain;
    }
}

/// The probabilities of the second child, for materials that are inner nodes.
FN void branch_weights(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                       const PRIVATE int* materials, PRIVATE float* weights) {
  plain_weights(scene, materials, weights);
  int textures[LANES];
  if (NEEDS(scene, TEXTURES) && note_weight_textures(scene, materials, textures)) {
    TextureLanes found;
    eval_textures(scene, surfaces, textures, &found);
    textured_weights(textures, &found, weights);
  }
}

/// The remainder of a number in [0, 1) that was below `weight` or not: again uniform in [0, 1).
FN float rest_of_number(float number, float weight, bool below) {
  const float rest = below ? number / (weight > 0.0f ? weight : 1.0f)
                           : (number - weight) / (weight < 1.0f ? 1.0f - weight : 1.0f);
  return min_f(rest, ONE_MINUS_EPSILON);
}

STAGE void descend(const PRIVATE Scene* scene, const PRIVATE float* RESTRICT weights,
                   PRIVATE float* RESTRICT numbers, PRIVATE int* RESTRICT materials) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int material = materials[j];
      GLOBAL const Material* m = scene->materials + (material >= 0 ? material : 0);
      const int first = m->first, second = m->second, branches = m->branches;
      const bool branch = (material >= 0) & (branches != 0);
      const float number = numbers[j], weight = weights[j];
      const bool below = number < weight;
      const float rest = rest_of_number(number, weight, below);
      const int child = below ? second : first;
      numbers[j] = branch ? rest : number;
      materials[j] = branch ? child : material;
    }
}

STAGE void plain_leaf_shares(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT leaves,
                             PRIVATE float* RESTRICT shares) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int leaf = leaves[j];
      shares[j] = passes_of(scene, leaf) == PASSES_ALL ? 1.0f : 0.0f;
    }
}

STAGE void pane_shares(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                       const PRIVATE int* RESTRICT leaves, PRIVATE float* RESTRICT shares) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const int leaf = leaves[j];
      const float pane = pane_of(scene, leaf), plain = shares[j];
      const bool is_pane = pane > 0.0f;
      const float cosine = FABS(dot3(s.shading, s.wo));
      const float reflected = pane_reflectance(cosine, is_pane ? pane : 1.0f);
      shares[j] = is_pane ? 1.0f - reflected : plain;
    }
}

/// The probabilities that rays pass the leaves.
FN void leaf_shares(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces, const PRIVATE int* leaves,
                    PRIVATE float* shares) {
  plain_leaf_shares(scene, leaves, shares);
  if (NEEDS(scene, PANES) && any_pane(scene, leaves)) pane_shares(scene, surfaces, leaves, shares);
}

/// Descends from the surfaces' materials to leaves, chosen by `numbers`, uniform in [0, 1).
FN void walk_to_leaves(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces, PRIVATE float* numbers,
                       PRIVATE int* materials) {
  float weights[LANES];
  while (any_branch(scene, materials)) {
    branch_weights(scene, surfaces, materials, weights);
    descend(scene, weights, numbers, materials);
  }
}

/// Leaves that rays pass become -1: each with its share as probability, by the remaining numbers.
STAGE void pass_leaves(const PRIVATE float* RESTRICT numbers, const PRIVATE float* RESTRICT shares,
                       PRIVATE int* RESTRICT leaves) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int leaf = leaves[j];
      leaves[j] = numbers[j] < shares[j] ? -1 : leaf;
    }
}

#define PANE_TINT_FIELDS(F, a) F(a, vec3, colour)
LANE_RECORD(PaneTint, PaneTints, pane_tint, PANE_TINT_FIELDS)

STAGE void plain_tints(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT leaves,
                       PRIVATE PaneTints* RESTRICT tints) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int leaf = leaves[j];
      const vec3 transmitted = load3(&scene->materials[leaf >= 0 ? leaf : 0].transmitted);
      PaneTint tint;
      tint.colour = select3(pane_of(scene, leaf) > 0.0f, transmitted, make_vec3(1.0f, 1.0f, 1.0f));
      store_pane_tint(tints, j, tint);
    }
}

STAGE bool note_tint_textures(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT leaves,
                              PRIVATE int* RESTRICT textures) {
  int any = 0;
  for (int j = 0; j < LANES; j++) {
    const int leaf = leaves[j], texture = scene->materials[leaf >= 0 ? leaf : 0].transmitted_texture;
    textures[j] = pane_of(scene, leaf) > 0.0f ? texture : -1;
    any |= textures[j] >= 0 ? 1 : 0;
  }
  return any != 0;
}

STAGE void textured_tints(const PRIVATE int* RESTRICT textures, const PRIVATE TextureLanes* RESTRICT found,
                          PRIVATE PaneTints* RESTRICT tints) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      PaneTint tint = load_pane_tint(tints, j);
      tint.colour = select3(textures[j] >= 0, LOAD_LANE_vec3(found->value, j), tint.colour);
      store_pane_tint(tints, j, tint);
    }
}

/// The tints of light that passes the leaves: 1 for leaves that are no panes.
FN void find_tints(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces, const PRIVATE int* leaves,
                   PRIVATE PaneTints* tints) {
  plain_tints(scene, leaves, tints);
  int textures[LANES];
  if (NEEDS(scene, TEXTURES) && note_tint_textures(scene, leaves, textures)) {
    TextureLanes found;
    eval_textures(scene, surfaces, textures, &found);
    textured_tints(textures, &found, tints);
  }
}

// The descent from a material to one of its leaves that let light pass, the `leaf`-th of them from the left.
// `factor` is the product of the branches' probabilities.
#define PASSING_DESCENT_FIELDS(F, a) \
  F(a, int, material)                \
  F(a, int, leaf)                    \
  F(a, float, factor)
LANE_RECORD(PassingDescent, PassingDescents, passing_descent, PASSING_DESCENT_FIELDS)

/// The number of leaves of a material (an index, or -1) that let light pass.
FN int passing_leaves_of(const PRIVATE Scene* scene, int material) {
  const int leaves = scene->materials[material >= 0 ? material : 0].passing_leaves;
  return material >= 0 ? leaves : 1;
}

/// Starts the descents to the `leaf`-th leaves. Returns whether any of the materials has that many.
STAGE bool start_descents(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT materials, int leaf,
                          PRIVATE PassingDescents* RESTRICT descents) {
  int any = 0;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int material = materials[j];
      const bool has_leaf = leaf < passing_leaves_of(scene, material);
      PassingDescent descent;
      descent.material = has_leaf ? material : 0;
      descent.leaf = leaf;
      descent.factor = has_leaf ? 1.0f : 0.0f;
      store_passing_descent(descents, j, descent);
      any |= has_leaf ? 1 : 0;
    }
  return any != 0;
}

STAGE void descend_to_passing(const PRIVATE Scene* scene, const PRIVATE float* RESTRICT weights,
                              PRIVATE PassingDescents* RESTRICT descents) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const PassingDescent before = load_passing_descent(descents, j);
      GLOBAL const Material* m = scene->materials + (before.material >= 0 ? before.material : 0);
      const int first = m->first, second = m->second, branches = m->branches;
      const bool branch = (before.material >= 0) & (branches != 0);
      const int of_first = passing_leaves_of(scene, first);
      const float weight = weights[j];
      const bool to_second = before.leaf >= of_first;
      PassingDescent after;
      after.material = to_second ? second : first;
      after.leaf = before.leaf - (to_second ? of_first : 0);
      after.factor = before.factor * (to_second ? weight : 1.0f - weight);
      store_passing_descent(descents, j, select_passing_descent(branch, after, before));
    }
}

STAGE void start_passing(PRIVATE float* RESTRICT shares, PRIVATE PaneTints* RESTRICT light) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      PaneTint none;
      none.colour = make_vec3(0.0f, 0.0f, 0.0f);
      store_pane_tint(light, j, none);
      shares[j] = 0.0f;
    }
}

STAGE void add_passing(const PRIVATE PassingDescents* RESTRICT descents,
                       const PRIVATE float* RESTRICT leaf_shares, const PRIVATE PaneTints* RESTRICT tints,
                       PRIVATE float* RESTRICT shares, PRIVATE PaneTints* RESTRICT light) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float share = descents->factor[j] * leaf_shares[j], before = shares[j];
      PaneTint sum = load_pane_tint(light, j);
      sum.colour = add_scaled(sum.colour, share, load_pane_tint(tints, j).colour);
      store_pane_tint(light, j, sum);
      shares[j] = before + share;
    }
}

/// The fractions of light that pass the surfaces, in [0, 1] but for rounding, and that light in colour: sums
/// over the leaves.
FN void passing_light(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces, PRIVATE float* shares,
                      PRIVATE PaneTints* light) {
  float weights[LANES], of_leaves[LANES];
  PassingDescents descents;
  PaneTints tints;
  start_passing(shares, light);
  for (int k = 0; start_descents(scene, surfaces->material, k, &descents); k++) {
    while (any_branch(scene, descents.material)) {
      branch_weights(scene, surfaces, descents.material, weights);
      descend_to_passing(scene, weights, &descents);
    }
    leaf_shares(scene, surfaces, descents.material, of_leaves);
    find_tints(scene, surfaces, descents.material, &tints);
    add_passing(&descents, of_leaves, &tints, shares, light);
  }
}

PENUMBRA_NAMESPACE_END
#endif
