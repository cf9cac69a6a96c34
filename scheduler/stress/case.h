// A case of the table: what is stiff about it, what is computed, the truth and how far the result may be off.
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

/// One call of a kernel function; see quantities.h. `value` makes the result of the call's outputs; empty:
/// the first output.
struct KernelMeasurement {
  int quantity = 0;
  Numbers inputs;
  std::function<Numbers(const Numbers& outputs)> value;
};

/// A render in this process, merged pass by pass as the scheduler does.
struct RenderMeasurement {
  std::function<SceneDescription()> scene;
  std::function<Numbers(const FilmAccumulator& film)> value;
  /// Samples that are known to be NaN or infinite: they have to be counted.
  std::uint64_t non_finite = 0;
  bool one_lane = true;  ///< also by the block of one, which is slow
};

/// Code of the scheduler: the same for all backends.
struct HostMeasurement {
  std::function<Numbers()> value;
};

/// The value and where it is known from: a closed form, 113-bit arithmetic, quadrature.
struct Truth {
  std::function<Quads()> value;
  std::string how;
};

/// A result passes if its distance from the truth is at most absolute + relative |truth|. What takes long to
/// find out, such as a condition number, is `computed` when the case is run, and added to `absolute`.
struct Allowed {
  double absolute = 0, relative = 0;
  std::string why;
  std::function<double()> computed = {};
};

struct Case {
  std::string name;      ///< "group/what", unique
  std::string stiff;     ///< what makes it hard
  std::string quantity;  ///< what is computed, and in what unit
  std::variant<KernelMeasurement, RenderMeasurement, HostMeasurement> measurement;
  Truth truth;
  Allowed allowed;
};

inline std::string group_of(const Case& c) { return c.name.substr(0, c.name.find('/')); }

inline Allowed absolute(double error, std::string why) { return {error, 0, std::move(why), {}}; }
inline Allowed relative(double error, std::string why) { return {0, error, std::move(why), {}}; }

/// All cases in the order of the table: each file of cases/ adds its own.
std::vector<Case> all_cases();

}  // namespace penumbra::stress
