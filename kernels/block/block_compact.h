// Closes the gaps that finished paths leave in a block.
#ifndef PENUMBRA_BLOCK_COMPACT_H
#define PENUMBRA_BLOCK_COMPACT_H
#include "kernels/block/path_state.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

#if defined(PACKS_REGISTERS) && LANES % 8 == 0
  #define PACKS_FIELDS
#endif

// Moves a field's values of the remaining paths, in order, to the first lanes.
#ifdef PACKS_FIELDS
/// `going` has a mask for each 8 of `count` lanes: the bits of remaining paths are set.
FN void move_up_words(GLOBAL int* words, const GLOBAL int* RESTRICT going, int count) {
  int left = 0;
  for (int i = 0; i < count; i += 8) {
    const uint wanted = (uint)going[i / 8];
    pack_8(words + left, words + i, wanted);
    left += BIT_COUNT(wanted);
  }
}
  #define MOVE_UP_float(field, capacity, going, count) move_up_words((GLOBAL int*)(field), going, count)
  #define MOVE_UP_int(field, capacity, going, count) move_up_words(field, going, count)
#else
/// `count` paths remain: lane m gets the value of lane going[m] >= m.
CALLED_FN void move_up_float(GLOBAL float* RESTRICT field, const GLOBAL int* RESTRICT going, int count) {
  LANE_LOOP
    for (int m = 0; m < count; m++) field[m] = field[going[m]];
}
CALLED_FN void move_up_int(GLOBAL int* RESTRICT field, const GLOBAL int* RESTRICT going, int count) {
  LANE_LOOP
    for (int m = 0; m < count; m++) field[m] = field[going[m]];
}
  #define MOVE_UP_float(field, capacity, going, count) move_up_float(field, going, count)
  #define MOVE_UP_int(field, capacity, going, count) move_up_int(field, going, count)
#endif
#define MOVE_UP_bool(field, capacity, going, count) MOVE_UP_int(field, capacity, going, count)
#define MOVE_UP_vec3(field, capacity, going, count) \
  for (int k = 0; k < 3; k++) MOVE_UP_float((field) + k * (capacity), capacity, going, count)

/// Compacts one field at a time. `left` of `count` paths remain; if fields are not packed, `going` lists
/// them.
STAGE void close_gaps(ulong features, const PRIVATE PathState* paths, int count, int left) {
  GLOBAL int* RESTRICT going = paths->going;
#ifdef PACKS_FIELDS
  for (int i = 0; i < count; i += 8) {
    const uint alive = mask_of_8(paths->alive + i), there = count - i < 8 ? (1u << (count - i)) - 1u : 0xffu;
    going[i / 8] = (int)(alive & there);
  }
  const int lanes = count;
#else
  const int lanes = left;
#endif
#define MOVE_FIELD(type, name, needs, travels)                        \
  if (MAY_MOVE(needs, travels) && is_moved(features, needs, travels)) \
    MOVE_UP_##type(paths->name, paths->capacity, going, lanes);
  PATH_FIELDS(MOVE_FIELD)
#undef MOVE_FIELD
}

/// Copies lane `from` to lane `to`.
FN void copy_lane(ulong features, const PRIVATE PathState* paths, int to, int from) {
#define COPY_FIELD(type, name, needs, travels)                        \
  if (MAY_MOVE(needs, travels) && is_moved(features, needs, travels)) \
    set_##name(paths, to, get_##name(paths, from));
  PATH_FIELDS(COPY_FIELD)
#undef COPY_FIELD
}

// The channel of a path that is traced for all channels at once.
#define EVERY_CHANNEL -1
// The channel of photons, which have no sample.
#define NO_CHANNEL -2
// Of channels that are traced one after the other the first: green, whose layers are kept, comes last.
#define FIRST_CHANNEL 2

/// Writes direct and indirect light of a finished path, of one channel or of EVERY_CHANNEL, to its slot.
FN void finish_split_light(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int channel,
                           const PRIVATE SlotState* slots) {
  const int slot = get_slot(paths, i);
  const vec3 all = get_radiance(paths, i);
  const vec3 direct = select3(get_depth(paths, i) <= 1, all, get_direct(paths, i));
  // Infinities count as such, not as the NaN of their difference.
  const vec3 indirect = select3(is_finite3(direct), sub(all, direct), all);
  const bool every = channel == EVERY_CHANNEL;
  if (NEEDS(scene, DIRECT_LAYER))
    set_slot_direct(slots, slot,
                    every ? direct : with_channel(get_slot_direct(slots, slot), direct, channel));
  if (NEEDS(scene, INDIRECT_LAYER))
    set_slot_indirect(slots, slot,
                      every ? indirect : with_channel(get_slot_indirect(slots, slot), indirect, channel));
}

/// Writes one channel of a finished path to its slot, see camera_channels.
FN void finish_channel(const PRIVATE PathState* paths, int i, int channel, bool polygons,
                       const PRIVATE SlotState* slots) {
  const int slot = get_slot(paths, i);
  set_slot_sample(slots, slot, with_channel(get_slot_sample(slots, slot), get_radiance(paths, i), channel));
  if (polygons) {
    set_slot_shadowed(slots, slot,
                      with_channel(get_slot_shadowed(slots, slot), get_shadowed(paths, i), channel));
    set_slot_unshadowed(slots, slot,
                        with_channel(get_slot_unshadowed(slots, slot), get_unshadowed(paths, i), channel));
    set_slot_analytic(slots, slot,
                      with_channel(get_slot_analytic(slots, slot), get_analytic(paths, i), channel));
  }
}

/// Records contradictory crossings of a finished path. They belong to the sample, whatever the path's
/// channel.
FN void finish_crossings(const PRIVATE PathState* paths, int i, int channel, const PRIVATE SlotState* slots) {
  const int slot = get_slot(paths, i), found = get_contradiction(paths, i);
  const bool is_first = (channel == EVERY_CHANNEL) | (channel == FIRST_CHANNEL);
  const int known = is_first ? 0 : get_slot_contradiction(slots, slot);
  set_slot_contradiction(slots, slot, known != 0 ? known : found);
}

/// Finished paths write their results, of one channel or of EVERY_CHANNEL, to their slots. The remaining
/// paths move to the first lanes, in order. Returns how many remain.
STAGE int compact(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count, int channel,
                  const PRIVATE SlotState* slots) {
#ifndef PACKS_FIELDS
  GLOBAL int* RESTRICT going = paths->going;
#endif
  GLOBAL int* RESTRICT finished = paths->finished;
  int left = 0, gone = 0;
  for (int i = 0; i < count; i++) {  // no branch: which paths end is unpredictable
    const int alive = get_alive(paths, i) ? 1 : 0;
#ifndef PACKS_FIELDS
    going[left] = i;
#endif
    finished[gone] = i;
    left += alive;
    gone += 1 - alive;
  }
  const bool polygons = NEEDS(scene, POLYGONS);
  if (HAS(CAMERA) && channel >= 0)
    for (int m = 0; m < gone; m++) finish_channel(paths, finished[m], channel, polygons, slots);
  for (int m = 0; m < gone && channel == EVERY_CHANNEL; m++) {
    const int i = finished[m], slot = get_slot(paths, i);
    set_slot_sample(slots, slot, get_radiance(paths, i));
    if (polygons) {
      set_slot_shadowed(slots, slot, get_shadowed(paths, i));
      set_slot_unshadowed(slots, slot, get_unshadowed(paths, i));
      set_slot_analytic(slots, slot, get_analytic(paths, i));
    }
  }
  if (NEEDS_SPLIT_LIGHT(scene) && channel != NO_CHANNEL)
    for (int m = 0; m < gone; m++) finish_split_light(scene, paths, finished[m], channel, slots);
  if (NEEDS_MEDIA(scene) && channel != NO_CHANNEL)
    for (int m = 0; m < gone; m++) finish_crossings(paths, finished[m], channel, slots);
  if (gone > 0 && left > 0) close_gaps(SCENE_FEATURES(&scene->header), paths, count, left);
  return left;
}

/// Lanes from `count` to the next multiple of LANES repeat the last path, so that every lane holds valid
/// work.
CALLED_FN void pad_lanes(ulong features, const PRIVATE PathState* paths, int count) {
  for (int i = count; i % LANES != 0; i++) copy_lane(features, paths, i, count - 1);
}

PENUMBRA_NAMESPACE_END
#endif
