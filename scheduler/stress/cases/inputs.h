// Helpers for the inputs of cases.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "scheduler/stress/case.h"
#include "scheduler/stress/truth/sensitivity.h"

namespace penumbra::stress {

struct Point {
  double x = 0, y = 0, z = 0;
};
using Points = std::vector<Point>;

/// Rounded to float, as the kernels see it.
inline double rounded(double v) { return double(float(v)); }
inline Point rounded(const Point& p) { return {rounded(p.x), rounded(p.y), rounded(p.z)}; }
/// The unit vector in double precision.
inline Point unit(double x, double y, double z) {
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}
inline Quad3 quad(const Point& p) { return {p.x, p.y, p.z}; }
inline Quad3 quad(const Quads& q, std::size_t i) { return {q[i], q[i + 1], q[i + 2]}; }
inline Quads quads(const Numbers& numbers) { return {numbers.begin(), numbers.end()}; }
inline Quads quads(const Quad3& v) { return {v.x, v.y, v.z}; }

inline constexpr double kBelow1 = 1 - kUlp;  ///< the largest float below 1

/// Concatenates vectors, then numbers, rounded to float.
inline Numbers floats(const Points& vectors, const Numbers& numbers = {}) {
  Numbers all;
  for (const Point& p : vectors) all.insert(all.end(), {rounded(p.x), rounded(p.y), rounded(p.z)});
  for (const double v : numbers) all.push_back(rounded(v));
  return all;
}

/// The square around (x, y) at height z, facing down.
inline Points square(double half, double z, double x = 0, double y = 0) {
  return {{x - half, y - half, z}, {x - half, y + half, z}, {x + half, y + half, z}, {x + half, y - half, z}};
}

/// The largest number, or NaN if any is NaN; std::max may ignore a NaN.
inline double worst(std::initializer_list<double> numbers) {
  double most = -INFINITY;
  for (const double x : numbers) most = std::max(most, x);
  for (const double x : numbers) most = std::isnan(x) ? x : most;
  return most;
}

/// Selects components of the outputs.
inline std::function<Numbers(const Numbers&)> outputs(std::size_t first, std::size_t count) {
  return [first, count](const Numbers& out) {
    const auto at = out.begin() + std::ptrdiff_t(first);
    return Numbers(at, at + std::ptrdiff_t(count));
  };
}

/// The allowed error for inputs that are off by `input_error` (vectors first, see rounding()), plus that of
/// the functions.
inline Allowed conditioned(const QuadFunction& f, const Numbers& inputs, std::size_t vectors,
                           double input_error, Allowed functions) {
  functions.computed = [f, at = quads(inputs), vectors, input_error] {
    return sensitivity(f, at, rounding(at, vectors, input_error));
  };
  return functions;
}

/// The truth as a function of the inputs.
inline Truth truth_of(const QuadFunction& f, const Numbers& inputs, std::string how) {
  return {[f, inputs] { return f(quads(inputs)); }, std::move(how)};
}
inline Truth known(Quad value, std::string how) {
  return {[value] { return Quads{value}; }, std::move(how)};
}

}  // namespace penumbra::stress
