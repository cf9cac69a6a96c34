// Fits the table of the sheen of Zeltner, Burley and Chiang 2022 and writes it as C++:
//   fit_sheen > scenes/bsdfs/sheen_table.inc
// Their surface is a layer of thickness and density 1 of fibres along the normal that absorb nothing: SGGX
// microflakes that mirror (Heitz et al. 2015), whose area seen along the fibres is the squared roughness of
// that from the side. What leaves after at most 16 reflections to the viewer's side is a transformed cosine.
// Its two numbers minimise the cubes of differences of the BRDF over equal steps of both angles of wi, as the
// authors do. Two minutes on one core.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSize = 32, kBins = 32, kBounces = 16, kPaths = 1 << 18, kFewest = 1000;
constexpr double kLeast = 0.01;  // of both parameters

/// Marsaglia's xorshift, 2003.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u) {
    for (int i = 0; i < 16; ++i) (*this)();
  }
  /// In [0, 1).
  double operator()() {
    state_ ^= state_ << 13, state_ ^= state_ >> 7, state_ ^= state_ << 17;
    return double(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

struct Vec3 {
  double x, y, z;
};
double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The area of flakes seen from w, whose area seen along the fibres is `end`.
double area(const Vec3& w, double end) { return std::sqrt(w.x * w.x + w.y * w.y + end * end * w.z * w.z); }

/// A normal of the flakes seen from w. They are those of an ellipsoid, which makes a sphere's hemisphere of
/// what is seen of it.
Vec3 visible_normal(const Vec3& w, double end, Random& random) {
  const double seen = area(w, end);
  const Vec3 a{w.x / seen, w.y / seen, end * w.z / seen};
  const double r = std::sqrt(random()), angle = 2 * kPi * random(), u = r * std::cos(angle),
               v = r * std::sin(angle), up = std::sqrt(1 - r * r);
  // The frame of Duff et al. 2017.
  const double sign = a.z >= 0 ? 1 : -1, q = -1 / (sign + a.z), t = a.x * a.y * q;
  const Vec3 m{u * (1 + sign * a.x * a.x * q) + v * t + up * a.x,
               u * sign * t + v * (sign + a.y * a.y * q) + up * a.y,
               end * (up * a.z - u * sign * a.x - v * a.y)};
  const double length = std::sqrt(dot(m, m));
  return {m.x / length, m.y / length, m.z / length};
}

/// Where light from the viewer leaves the layer; z is at most 0 if that is not on the viewer's side.
Vec3 walk(double cosine, double end, Random& random) {
  Vec3 back{std::sqrt(1 - cosine * cosine), 0, cosine};  // to where it came from
  double depth = 0;
  for (int bounce = 0;; ++bounce) {
    depth -= std::log(1 - random()) / area(back, end) * back.z;
    if (depth < 0) return {-back.x, -back.y, -back.z};
    if (depth > 1 || bounce == kBounces) return {0, 0, 0};
    const Vec3 m = visible_normal(back, end, random);
    const double twice = 2 * dot(back, m);
    back = {back.x - twice * m.x, back.y - twice * m.y, back.z - twice * m.z};
  }
}

/// What leaves: its share of the light, and the BRDF times wi's cosine in bins of its polar angle and
/// azimuth.
struct Reflected {
  double share = 0;
  int count = 0;
  std::vector<double> bins = std::vector<double>(kBins * kBins);
};
Reflected simulated(double cosine, double roughness, std::uint64_t seed) {
  Random random(seed);
  Reflected result;
  for (int i = 0; i < kPaths; ++i) {
    const Vec3 wi = walk(cosine, roughness * roughness, random);
    if (!(wi.z > 0)) continue;
    ++result.count;
    const double polar = std::acos(std::min(wi.z, 1.0)), azimuth = std::abs(std::atan2(wi.y, wi.x));
    const int row = std::min(int(polar / (kPi / 2) * kBins), kBins - 1),
              column = std::min(int(azimuth / kPi * kBins), kBins - 1);
    result.bins[std::size_t(row * kBins + column)] += kBins * kBins / (kPi * kPi * std::sin(polar) * kPaths);
  }
  result.share = double(result.count) / kPaths;
  // Around the normal the BRDF is the same for all azimuths.
  double mean = 0;
  for (int k = 0; k < kBins; ++k) mean += result.bins[std::size_t(k)] / kBins;
  std::fill_n(result.bins.begin(), kBins, mean);
  return result;
}

/// The matrix from directions to cosines has the rows (narrow, 0, lean), (0, narrow, 0), (0, 0, 1).
struct Lobe {
  double narrow = 1, lean = 0;
};
double distance(const Reflected& of, const Lobe& lobe) {
  double sum = 0;
  for (int i = 0; i < kBins; ++i)
    for (int k = 0; k < kBins; ++k) {
      const double polar = kPi / 2 * (i + 0.5) / kBins, azimuth = kPi * (k + 0.5) / kBins,
                   z = std::cos(polar);
      const double x = lobe.narrow * std::sin(polar) * std::cos(azimuth) + lobe.lean * z,
                   y = lobe.narrow * std::sin(polar) * std::sin(azimuth), d2 = x * x + y * y + z * z;
      const double f = of.share * z * lobe.narrow * lobe.narrow / (kPi * d2 * d2);
      sum += std::pow(std::abs(f - of.bins[std::size_t(i * kBins + k)]), 3);
    }
  return sum;
}
/// By ever smaller steps from `lobe`.
Lobe fitted(const Reflected& of, Lobe lobe) {
  double best = distance(of, lobe);
  for (double step = 0.1; step > 1e-5;) {
    bool better = false;
    for (const Lobe& other : {Lobe{lobe.narrow + step, lobe.lean}, Lobe{lobe.narrow - step, lobe.lean},
                              Lobe{lobe.narrow, lobe.lean + step}, Lobe{lobe.narrow, lobe.lean - step}}) {
      const double d = distance(of, other);
      if (!(d < best) || !(other.narrow > 0)) continue;
      best = d, lobe = other, better = true;
    }
    if (!better) step /= 2;
  }
  return lobe;
}

}  // namespace

int main() {
  struct Cell {
    double share;
    Lobe lobe;
  };
  std::array<Cell, kSize * kSize> table;
  for (int column = 0; column < kSize; ++column) {
    Lobe lobe;
    for (int row = kSize - 1; row >= 0; --row) {
      const double roughness = std::max(kLeast, double(row) / (kSize - 1)),
                   cosine = std::max(kLeast, double(column) / (kSize - 1));
      const int cell = row * kSize + column;
      const Reflected reflected = simulated(cosine, roughness, std::uint64_t(cell) + 1);
      if (reflected.count >= kFewest) lobe = fitted(reflected, lobe);  // else that of a larger roughness
      table[std::size_t(cell)] = {reflected.share, lobe};
    }
    std::fprintf(stderr, "%d of %d\n", column + 1, kSize);
  }
  std::puts(
      "// Written by fit_sheen: 32 rows of roughness by 32 columns of the viewer's cosine, from 0.01 and "
      "even\n"
      "// steps to 1: share of the light, narrow, lean.");
  for (const Cell& c : table) std::printf("{%#.5gf, %#.5gf, %#.5gf},\n", c.share, c.lobe.narrow, c.lobe.lean);
}
