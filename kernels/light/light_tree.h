// Chooses one of many lights by its possible contribution at a point, through a hierarchy over all lights.
// Nodes bound the positions and the emission directions of their lights (Conty Estevez and Kulla, "Importance
// Sampling of Many Lights with Adaptive Tree Splitting", 2018). A node is chosen in proportion to a bound of
// the irradiance from it; a node that cannot reach the surface's side is never chosen. The upper part of the
// hierarchy is flat: first one of the nodes of the cut (LIGHT_CUT or fewer) is chosen, which with few lights
// are the lights themselves, and from there on one of two children. A leaf may contain a light cluster, whose
// lights have fixed probabilities (scenes/device/light_groups.h). Infinite lights (skies, directional lights)
// are nodes whose intensities are irradiances: see scenes/device/pilot_paths.h.
//
// LANES points descend one level at a time. A descent depends only on the point, so that pdfs for MIS repeat
// the same arithmetic along the path to the light.
#ifndef PENUMBRA_LIGHT_TREE_H
#define PENUMBRA_LIGHT_TREE_H
#include "kernels/light/light_found.h"
#include "kernels/light/light_importance.h"
#include "kernels/light/light_sample.h"
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

// If both infinite and finite lights may contribute, each kind gets at least this probability: the estimates
// that compare them are averages over the whole scene.
#define LEAST_LIGHT_SHARE 0.05f

/// How many of the LIGHT_PROBABILITY_STEPS numbers choose the first node of a pair. `any`: whether either
/// node has any importance.
FN int numbers_of_first(GLOBAL const LightNode* pair, LitPlace place, PRIVATE bool* any) {
  const float first = light_importance(pair, place), second = light_importance(pair + 1, place);
  const float sum = first + second;
  const int numbers = (int)(first / (sum > 0.0f ? sum : 1.0f) * LIGHT_PROBABILITY_STEPS);
  const int all = (int)LIGHT_PROBABILITY_STEPS;
  const int inside = numbers < 1 ? 1 : (numbers > all - 1 ? all - 1 : numbers);
  *any = sum > 0.0f;
  return first > 0.0f ? (second > 0.0f ? inside : all) : 0;
}

/// A number in [0, 1) with twice the digits of a float: (high + low) / LIGHT_PROBABILITY_STEPS, where high is
/// an integer.
typedef struct {
  int high;
  float low;
} LongNumber;

FN LongNumber long_number(float u, float fine) {
  LongNumber x;
  x.high = (int)(u * LIGHT_PROBABILITY_STEPS);
  x.low = fine;
  return x;
}

/// The remainder of a number below `width` / LIGHT_PROBABILITY_STEPS, stretched to [0, 1): stratified numbers
/// stay stratified, digit by digit. The quotient is corrected by its remainder, which is small and therefore
/// exact modulo 2^32. Lanes without such a number get an arbitrary one; clamping keeps conversions to int
/// valid.
FN LongNumber stretched(LongNumber x, int width) {
  const float w = (float)width;
  const int quotient =
      (int)clamp_f((float)x.high / w * LIGHT_PROBABILITY_STEPS, 0.0f, LIGHT_PROBABILITY_STEPS);
  const int remainder = (int)(((uint)x.high << 24) - (uint)quotient * (uint)width);
  const float rest = ((float)remainder + x.low * LIGHT_PROBABILITY_STEPS) / w;
  const float more = clamp_f(rest, -LIGHT_PROBABILITY_STEPS, LIGHT_PROBABILITY_STEPS);
  const float whole = floor_f(more);
  const int high = quotient + (int)whole;
  const int last = (int)LIGHT_PROBABILITY_STEPS - 1;
  LongNumber left;
  left.high = high < 0 ? 0 : (high > last ? last : high);
  left.low = clamp_f(more - whole, 0.0f, ONE_MINUS_EPSILON);
  return left;
}

// A descent from a node of the cut: to a leaf by a random number, or to a known light by its trail, whose
// lowest bit is the next choice of a child.
#define LIGHT_WALK_FIELDS(F, a)                              \
  F(a, int, node)                                            \
  F(a, int, high) /* the number, or the rest of the trail */ \
  F(a, float, low)                                           \
  F(a, float, pmf) /* probability of the descent so far */
LANE_RECORD(LightWalk, LightWalks, light_walk, LIGHT_WALK_FIELDS)

/// The factors from importances of the cut's nodes to counts of LIGHT_PROBABILITY_STEPS.
#define LIGHT_SCALES_FIELDS(F, a) \
  F(a, float, finite)             \
  F(a, float, infinite)
LANE_RECORD(LightScale, LightScales, light_scales, LIGHT_SCALES_FIELDS)

#define WEIGH_CUT_NODE(name, known)                                                         \
  STAGE void name(GLOBAL const LightNode* shared, const PRIVATE LitPlaces* RESTRICT places, \
                  PRIVATE float* RESTRICT importance, PRIVATE float* RESTRICT sums) {       \
    const LightNode node = read_light_node(shared);                                         \
    LANE_LOOP                                                                               \
      for (int j = 0; j < LANES; j++) {                                                     \
        const float own = light_importance_by(node, load_lit_place(places, j), known);      \
        importance[j] = own;                                                                \
        sums[j] += own;                                                                     \
      }                                                                                     \
  }
WEIGH_CUT_NODE(weigh_any_node, NODE_ANY)
WEIGH_CUT_NODE(weigh_infinite_node, NODE_INFINITE)
WEIGH_CUT_NODE(weigh_all_around_node, NODE_ISOTROPIC)
#undef WEIGH_CUT_NODE

/// Converts sums to scales. Rounding leaves a few numbers (5e-6 of all) that choose no light.
STAGE void scale_cut(PRIVATE LightScales* RESTRICT scales) {
  const float numbers = LIGHT_PROBABILITY_STEPS - 4.0f * (float)LIGHT_CUT;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float finite = scales->finite[j], infinite = scales->infinite[j];
      const bool mixed = (finite > 0.0f) & (infinite > 0.0f);
      const float sum = finite + infinite, share = infinite / (sum > 0.0f ? sum : 1.0f);
      const float of_infinite = mixed ? clamp_f(share, LEAST_LIGHT_SHARE, 1.0f - LEAST_LIGHT_SHARE)
                                      : (infinite > 0.0f ? 1.0f : 0.0f);
      scales->finite[j] = (1.0f - of_infinite) * numbers / (finite > 0.0f ? finite : 1.0f);
      scales->infinite[j] = of_infinite * numbers / (infinite > 0.0f ? infinite : 1.0f);
    }
}

/// Computes the importances of the cut's nodes; that of lane j is at node * LANES + j.
FN void weigh_cut(const PRIVATE Scene* scene, const PRIVATE LitPlaces* places, PRIVATE float* importances,
                  PRIVATE LightScales* scales) {
  for (int j = 0; j < LANES; j++) scales->finite[j] = scales->infinite[j] = 0.0f;
  for (int k = 0; k < scene->header.light_cut; k++) {
    GLOBAL const LightNode* node = scene->light_nodes + k;
    const bool infinite = (node->flags & LIGHTS_INFINITE) != 0;
    PRIVATE float* importance = importances + k * LANES;
    if (infinite)
      weigh_infinite_node(node, places, importance, scales->infinite);
    else if (node->cos_o == -1.0f)
      weigh_all_around_node(node, places, importance, scales->finite);
    else
      weigh_any_node(node, places, importance, scales->finite);
  }
  scale_cut(scales);
}

/// The scales of places where no light is chosen.
FN void find_light_scales(const PRIVATE Scene* scene, const PRIVATE LitPlaces* places,
                          PRIVATE LightScales* scales) {
  float importances[LIGHT_CUT * LANES];
  weigh_cut(scene, places, importances, scales);
}

/// How many numbers choose a node of the cut: at least one if any light may arrive.
FN int numbers_of_node(float importance, float scale) {
  const int some = (int)clamp_f(importance * scale, 0.0f, LIGHT_PROBABILITY_STEPS);
  return importance > 0.0f ? (some < 1 ? 1 : some) : 0;
}

/// Which numbers choose which node; assigned node by node.
typedef struct {
  int below[LANES];  ///< how many are assigned
  int node[LANES], start[LANES], width[LANES];
} CutNumbers;

/// Assigns numbers to the k-th node. A descent takes the node that its number belongs to.
STAGE void deal_numbers(int k, const PRIVATE float* RESTRICT importance, const PRIVATE float* RESTRICT scales,
                        const PRIVATE LightWalks* RESTRICT walks, PRIVATE CutNumbers* RESTRICT dealt) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int numbers = numbers_of_node(importance[j], scales[j]);
      const int start = dealt->below[j], number = walks->high[j];
      const int node = dealt->node[j], node_start = dealt->start[j], width = dealt->width[j];
      const bool taken = (number >= start) & (number < start + numbers);
      dealt->node[j] = taken ? k : node;
      dealt->start[j] = taken ? start : node_start;
      dealt->width[j] = taken ? numbers : width;
      dealt->below[j] = start + numbers;
    }
}

/// Starts descents at their nodes of the cut. Numbers that choose no node get probability 0.
STAGE void enter_cut(const PRIVATE CutNumbers* RESTRICT dealt, PRIVATE LightWalks* RESTRICT walks) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightWalk before = load_light_walk(walks, j);
      const int node = dealt->node[j], width = dealt->width[j];
      LongNumber x;
      x.high = before.high - dealt->start[j];
      x.low = before.low;
      const LongNumber left = stretched(x, width > 0 ? width : 1);
      LightWalk walk;
      walk.node = node >= 0 ? node : 0;
      walk.high = left.high;
      walk.low = left.low;
      walk.pmf = node >= 0 ? (float)width * (1.0f / LIGHT_PROBABILITY_STEPS) : 0.0f;
      store_light_walk(walks, j, walk);
    }
}

/// Descends by one level, except at leaves. Returns whether any descent continues. `by_trail` is a constant.
FN bool step_walks(const PRIVATE Scene* scene, bool by_trail, const PRIVATE LitPlaces* RESTRICT places,
                   PRIVATE LightWalks* RESTRICT walks) {
  int any_left = 0;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightWalk before = load_light_walk(walks, j);
      const int child = scene->light_nodes[before.node].child;
      const bool inner = child > 0;
      bool any;
      const int numbers =
          numbers_of_first(scene->light_nodes + (inner ? child : 0), load_lit_place(places, j), &any);
      LongNumber x;
      x.high = before.high;
      x.low = before.low;
      const bool first = by_trail ? (before.high & 1) == 0 : x.high < numbers;
      const int width = first ? numbers : (int)LIGHT_PROBABILITY_STEPS - numbers;
      x.high = first ? x.high : x.high - numbers;
      LongNumber left;
      if (by_trail) {
        left.high = (int)((uint)before.high >> 1);
        left.low = 0.0f;
      } else {
        left = stretched(x, width > 0 ? width : 1);
      }
      const float pmf = any ? before.pmf * ((float)width * (1.0f / LIGHT_PROBABILITY_STEPS)) : 0.0f;
      LightWalk after;
      after.node = inner ? child + (first ? 0 : 1) : before.node;
      after.high = inner ? left.high : before.high;
      after.low = inner ? left.low : before.low;
      after.pmf = inner ? pmf : before.pmf;
      store_light_walk(walks, j, after);
      any_left |= (inner & (after.pmf > 0.0f)) ? 1 : 0;
    }
  return any_left != 0;
}
STAGE bool descend_by_numbers(const PRIVATE Scene* scene, const PRIVATE LitPlaces* RESTRICT places,
                              PRIVATE LightWalks* RESTRICT walks) {
  return step_walks(scene, false, places, walks);
}
STAGE bool turn_by_trails(const PRIVATE Scene* scene, const PRIVATE LitPlaces* RESTRICT places,
                          PRIVATE LightWalks* RESTRICT walks) {
  return step_walks(scene, true, places, walks);
}

/// Whether any descent continues.
FN bool any_turns_left(const PRIVATE Scene* scene, const PRIVATE LightWalks* walks) {
  int any = 0;
  for (int j = 0; j < LANES; j++)
    any |= ((scene->light_nodes[walks->node[j]].child > 0) & (walks->pmf[j] > 0.0f)) ? 1 : 0;
  return any != 0;
}

STAGE void start_by_numbers(const PRIVATE float* RESTRICT u, const PRIVATE float* RESTRICT fine,
                            PRIVATE LightWalks* RESTRICT walks) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LongNumber x = long_number(u[j], fine[j]);
      LightWalk walk;
      walk.node = -1;
      walk.high = x.high;
      walk.low = x.low;
      walk.pmf = 1.0f;
      store_light_walk(walks, j, walk);
    }
}

/// Search in the leaves where descents ended: which light the number chooses. The shares of a leaf's lights
/// are the same for all places.
typedef struct {
  int first[LANES], count[LANES];  ///< the leaf's members; count is 1 for a leaf without members
  int at[LANES];                   ///< index of the first light that may be the one
} LeafSearch;

STAGE void start_search(const PRIVATE Scene* scene, const PRIVATE LightWalks* RESTRICT walks,
                        PRIVATE LeafSearch* RESTRICT search) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      GLOBAL const LightNode* node = scene->light_nodes + walks->node[j];
      const int child = node->child, count = node->lights;
      const bool several = (child < 0) & (count > 1);
      search->first[j] = several ? ~child : 0;
      search->count[j] = several ? count : 1;
      search->at[j] = 0;
    }
}

/// Advances by `step` lights if the number does not belong to a light before that.
STAGE void turn_search(const PRIVATE Scene* scene, int step, const PRIVATE LightWalks* RESTRICT walks,
                       PRIVATE LeafSearch* RESTRICT search) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int at = search->at[j], next = at + step, number = walks->high[j];
      const bool there = next < search->count[j];
      const int start = scene->light_members[search->first[j] + (there ? next : 0)].start;
      search->at[j] = (there & (start <= number)) ? next : at;
    }
}

/// Stores the lights chosen in leaves that have several.
STAGE void take_members(const PRIVATE Scene* scene, const PRIVATE LeafSearch* RESTRICT search,
                        const PRIVATE LightWalks* RESTRICT walks, PRIVATE float* RESTRICT u,
                        PRIVATE LightSamplings* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightWalk walk = load_light_walk(walks, j);
      const bool several = search->count[j] > 1;
      GLOBAL const LightMember* member = scene->light_members + (search->first[j] + search->at[j]);
      const int light = member->light, start = member->start;
      const int numbers = scene->light_numbers[light];
      LongNumber x;
      x.high = walk.high - start;
      x.low = walk.low;
      const LongNumber left = stretched(x, numbers > 0 ? numbers : 1);
      const float own =
          clamp_f(((float)left.high + left.low) * (1.0f / LIGHT_PROBABILITY_STEPS), 0.0f, ONE_MINUS_EPSILON);
      const float pmf = walk.pmf * ((float)numbers * (1.0f / LIGHT_PROBABILITY_STEPS));
      const int only_light = samplings->light[j];
      const float only_u = u[j], only_pmf = samplings->pmf[j];
      u[j] = several ? own : only_u;
      samplings->light[j] = (several & (walk.pmf > 0.0f)) ? light : only_light;
      samplings->pmf[j] = several ? pmf : only_pmf;
    }
}

/// Stores the lights where descents ended. If no light can arrive, the probability is 0.
STAGE void end_by_numbers(const PRIVATE Scene* scene, const PRIVATE LightWalks* RESTRICT walks,
                          PRIVATE float* RESTRICT u, PRIVATE LightSamplings* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightWalk walk = load_light_walk(walks, j);
      const int child = scene->light_nodes[walk.node].child;
      const bool at_light = (child < 0) & (walk.pmf > 0.0f);
      u[j] =
          clamp_f(((float)walk.high + walk.low) * (1.0f / LIGHT_PROBABILITY_STEPS), 0.0f, ONE_MINUS_EPSILON);
      samplings->light[j] = at_light ? ~child : 0;
      samplings->pmf[j] = at_light ? walk.pmf : 0.0f;
    }
}

/// Chooses a light for each place by u and the digits below it, `fine` in [0, 1). The remainder replaces u:
/// it is again uniform in [0, 1), and as well stratified. Sets the `scales` of the places.
FN void choose_by_tree(const PRIVATE Scene* scene, const PRIVATE LitPlaces* places, PRIVATE float* u,
                       const PRIVATE float* fine, PRIVATE LightSamplings* samplings,
                       PRIVATE LightScales* scales) {
  LightWalks walks;
  float importances[LIGHT_CUT * LANES];
  CutNumbers dealt;
  start_by_numbers(u, fine, &walks);
  weigh_cut(scene, places, importances, scales);
  for (int j = 0; j < LANES; j++) {
    dealt.below[j] = dealt.start[j] = dealt.width[j] = 0;
    dealt.node[j] = -1;
  }
  for (int k = 0; k < scene->header.light_cut; k++) {
    const bool infinite = (scene->light_nodes[k].flags & LIGHTS_INFINITE) != 0;
    deal_numbers(k, importances + k * LANES, infinite ? scales->infinite : scales->finite, &walks, &dealt);
  }
  enter_cut(&dealt, &walks);
  if (any_turns_left(scene, &walks))
    for (int level = 0; level < scene->header.light_tree_depth; level++)
      if (!descend_by_numbers(scene, places, &walks)) break;
  end_by_numbers(scene, &walks, u, samplings);
  const int turns = scene->header.light_leaf_steps;
  if (turns == 0) return;
  LeafSearch search;
  start_search(scene, &walks, &search);
  int any = 0;
  for (int j = 0; j < LANES; j++) any |= search.count[j] > 1 ? 1 : 0;
  if (any == 0) return;
  for (int turn = turns - 1; turn >= 0; turn--) turn_search(scene, 1 << turn, &walks, &search);
  take_members(scene, &search, &walks, u, samplings);
}

/// Starts descents towards known lights at their nodes of the cut.
STAGE void start_by_trails(const PRIVATE Scene* scene, const PRIVATE LitPlaces* RESTRICT places,
                           const PRIVATE LightScales* RESTRICT scales,
                           const PRIVATE FoundLights* RESTRICT found, PRIVATE LightWalks* RESTRICT walks) {
  const int last =
      scene->header.light_cut > 0 ? scene->header.light_cut - 1 : 0;  // the scene may have no hierarchy
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int light = found->light[j];
      const uint trail = scene->light_trails[light >= 0 ? light : 0];
      const int node = min_i((int)(trail & (LIGHT_CUT - 1u)), last);
      const int flags = scene->light_nodes[node].flags;
      const float importance = light_importance(scene->light_nodes + node, load_lit_place(places, j));
      const float finite = scales->finite[j], infinite = scales->infinite[j];
      const int numbers = numbers_of_node(importance, (flags & LIGHTS_INFINITE) != 0 ? infinite : finite);
      LightWalk walk;
      walk.node = node;
      walk.high = (int)(trail / LIGHT_CUT);
      walk.low = 0.0f;
      walk.pmf = light >= 0 ? (float)numbers * (1.0f / LIGHT_PROBABILITY_STEPS) : 0.0f;
      store_light_walk(walks, j, walk);
    }
}

STAGE void end_by_trails(const PRIVATE Scene* scene, const PRIVATE LightWalks* RESTRICT walks,
                         PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightWalk walk = load_light_walk(walks, j);
      const int child = scene->light_nodes[walk.node].child;
      found->pmf[j] = child == ~found->light[j] ? walk.pmf : 0.0f;
    }
}

/// The same for leaves with several lights.
STAGE void end_at_members(const PRIVATE Scene* scene, const PRIVATE LightWalks* RESTRICT walks,
                          PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightWalk walk = load_light_walk(walks, j);
      const int light = found->light[j];
      GLOBAL const LightNode* node = scene->light_nodes + walk.node;
      const int child = node->child, count = node->lights;
      const int numbers = scene->light_numbers[light >= 0 ? light : 0];
      const float pmf = walk.pmf * ((float)numbers * (1.0f / LIGHT_PROBABILITY_STEPS));
      const float only_pmf = found->pmf[j];
      found->pmf[j] = ((child < 0) & (count > 1) & (light >= 0)) ? pmf : only_pmf;
    }
}

/// Sets the probabilities with which choose_by_tree chooses the found lights at these places; `scales` are
/// those of the places.
FN void find_tree_pmfs(const PRIVATE Scene* scene, const PRIVATE LitPlaces* places,
                       const PRIVATE LightScales* scales, PRIVATE FoundLights* found) {
  LightWalks walks;
  start_by_trails(scene, places, scales, found, &walks);
  if (any_turns_left(scene, &walks))
    for (int level = 0; level < scene->header.light_tree_depth; level++)
      if (!turn_by_trails(scene, places, &walks)) break;
  end_by_trails(scene, &walks, found);
  if (scene->header.light_leaf_steps > 0) end_at_members(scene, &walks, found);
}

PENUMBRA_NAMESPACE_END
#endif
