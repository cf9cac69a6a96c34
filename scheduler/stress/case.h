// A case of the accuracy table: why it is hard, what is computed, the true value and the allowed error.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "scenes/scene_description.h"
#include "scheduler/plan/film_accumulator.h"
#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

/// A result: one number, or the components of a vector.
using Numbers = std::vector<double>;
using Quads = std::vector<Quad>;

/// One call of a kernel function; see quantities.h. `value` computes the result from the call's outputs; if
/// it is empty, the result is the first output.
struct KernelMeasurement {
  int quantity = 0;
  Numbers inputs;
  std::function<Numbers(const Numbers& outputs)> value;
};

/// A render in this process, merged pass by pass like the scheduler's.
struct RenderMeasurement {
  std::function<SceneDescription()> scene;
  std::function<Numbers(const FilmAccumulator& film)> value;
  /// The expected number of NaN or infinite samples, which must be counted.
  std::uint64_t non_finite = 0;
  bool one_lane = true;  ///< also run by blocks of one pixel, which is slow
};

/// Scheduler code, which does not depend on the backend.
struct HostMeasurement {
  std::function<Numbers()> value;
};

/// The true value and how it is known: closed form, 113-bit arithmetic, quadrature.
struct Truth {
  std::function<Quads()> value;
  std::string how;
};

/// The allowed error: a result passes if its distance from the truth is at most absolute + relative |truth|.
/// `computed` is for parts that take long, such as a condition number; it is called when the case is run and
/// added to `absolute`.
struct Allowed {
  double absolute = 0, relative = 0;
  std::string why;
  std::function<double()> computed = {};
};

struct Case {
  std::string name;      ///< "group/what", unique
  std::string stiff;     ///< why it is numerically hard
  std::string quantity;  ///< what is computed, and its unit
  std::variant<KernelMeasurement, RenderMeasurement, HostMeasurement> measurement;
  Truth truth;
  Allowed allowed;
};

inline std::string group_of(const Case& c) { return c.name.substr(0, c.name.find('/')); }

inline Allowed absolute(double error, std::string why) { return {error, 0, std::move(why), {}}; }
inline Allowed relative(double error, std::string why) { return {0, error, std::move(why), {}}; }

/// All cases in the order of the table. Each file in cases/ adds its own.
std::vector<Case> all_cases();

}  // namespace penumbra::stress
