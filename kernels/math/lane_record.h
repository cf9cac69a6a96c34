// Records of which a stage holds LANES at a time. One list of fields generates the struct of a single record
// and the struct of arrays of LANES records, which stays in the L1 cache between the lane loops of a step.
//
// A list of fields is FIELDS(F, a) with a row F(a, type, name) for each; types are float, int, bool and vec3.
#ifndef PENUMBRA_LANE_RECORD_H
#define PENUMBRA_LANE_RECORD_H
#include "kernels/math/vec3.h"

#define LANE_ARRAY_float(name) float name[LANES];
#define LANE_ARRAY_int(name) int name[LANES];
#define LANE_ARRAY_bool(name) int name[LANES];
#define LANE_ARRAY_vec3(name) float name[3 * LANES];
// Entry i of an array of a type. The components of a vec3 are `stride` apart.
#define LOAD_ENTRY_float(array, stride, i) (array)[i]
#define LOAD_ENTRY_int(array, stride, i) (array)[i]
#define LOAD_ENTRY_bool(array, stride, i) ((array)[i] != 0)
#define LOAD_ENTRY_vec3(array, stride, i) \
  make_vec3((array)[i], (array)[(stride) + (i)], (array)[2 * (stride) + (i)])
#define STORE_ENTRY_float(array, stride, i, value) (array)[i] = (value)
#define STORE_ENTRY_int(array, stride, i, value) (array)[i] = (value)
#define STORE_ENTRY_bool(array, stride, i, value) (array)[i] = (value) ? 1 : 0
#define STORE_ENTRY_vec3(array, stride, i, value) \
  (array)[i] = (value).x, (array)[(stride) + (i)] = (value).y, (array)[2 * (stride) + (i)] = (value).z
#define LOAD_LANE_vec3(array, j) LOAD_ENTRY_vec3(array, LANES, j)
#define STORE_LANE_vec3(array, j, value) STORE_ENTRY_vec3(array, LANES, j, value)

#define RECORD_MEMBER(a, type, name) type name;
#define RECORD_ARRAY(a, type, name) LANE_ARRAY_##type(name)
#define RECORD_LOAD(a, type, name) record.name = LOAD_ENTRY_##type(lanes->name, LANES, j);
#define RECORD_SELECT(a, type, name) record.name = SELECT_##type(condition, yes.name, no.name);
#define SELECT_float(c, yes, no) ((c) ? (yes) : (no))
#define SELECT_int(c, yes, no) ((c) ? (yes) : (no))
#define SELECT_bool(c, yes, no) ((c) ? (yes) : (no))
#define SELECT_vec3(c, yes, no) select3(c, yes, no)
#define RECORD_STORE(a, type, name) STORE_ENTRY_##type(lanes->name, LANES, j, record.name);

/// Defines struct Name, struct Names for LANES of them, load_name(names, lane), store_name(names, lane,
/// record) and select_name(condition, yes, no).
#define LANE_RECORD(Name, Names, name, FIELDS)               \
  typedef struct {                                           \
    FIELDS(RECORD_MEMBER, )                                  \
  } Name;                                                    \
  typedef struct {                                           \
    FIELDS(RECORD_ARRAY, )                                   \
  } Names;                                                   \
  FN Name load_##name(const PRIVATE Names* lanes, int j) {   \
    Name record;                                             \
    FIELDS(RECORD_LOAD, )                                    \
    return record;                                           \
  }                                                          \
  FN Name select_##name(bool condition, Name yes, Name no) { \
    Name record;                                             \
    FIELDS(RECORD_SELECT, )                                  \
    return record;                                           \
  }                                                          \
  FN void store_##name(PRIVATE Names* lanes, int j, Name record) { FIELDS(RECORD_STORE, ) }

/// Defines store_part(names, lane, record), which stores only some fields.
#define LANE_RECORD_PART(Name, Names, part, FIELDS) \
  FN void store_##part(PRIVATE Names* lanes, int j, Name record) { FIELDS(RECORD_STORE, ) }

#endif
