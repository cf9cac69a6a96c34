// Values for the fields of paths and samples, different for every field and lane.
#pragma once

#include "kernels/host/block_memory.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/same_value.h"

namespace penumbra {

/// Exact as a float.
inline int number_of(int field, int lane) { return 1 + field * 4096 + lane; }

template <typename Value>
Value value_of(int field, int lane);
template <>
inline int value_of<int>(int field, int lane) {
  return number_of(field, lane);
}
template <>
inline float value_of<float>(int field, int lane) {
  return float(number_of(field, lane));
}
template <>
inline bool value_of<bool>(int field, int lane) {
  return (hash_uint(uint(number_of(field, lane))) & 1u) != 0;
}
template <>
inline vec3 value_of<vec3>(int field, int lane) {
  const auto x = float(number_of(field, lane));
  return make_vec3(x, x + 0.25f, x + 0.5f);
}

/// Sets all fields of a path that a scene with these features stores.
inline void fill_path(std::uint64_t features, const PathState& paths, int lane) {
  int field = 0;
#define FILL_FIELD(type, name, needs, travels)                                           \
  if (is_stored(features, needs)) set_##name(&paths, lane, value_of<type>(field, lane)); \
  ++field;
  PATH_FIELDS(FILL_FIELD)
#undef FILL_FIELD
}

/// The same of a sample; its fields are numbered after those of paths.
inline void fill_slot(std::uint64_t features, const SlotState& slots, int slot) {
  int field = 100;
#define FILL_FIELD(type, name, needs, travels)                                                \
  if (is_stored(features, needs)) set_slot_##name(&slots, slot, value_of<type>(field, slot)); \
  ++field;
  SLOT_FIELDS(FILL_FIELD)
#undef FILL_FIELD
}

}  // namespace penumbra
