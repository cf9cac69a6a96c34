// Phong BSDFs from mirrors to flat lobes, and directions.
#include <fmt/format.h>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"
#include "scheduler/stress/truth/mixtures.h"
#include "scheduler/stress/truth/quadrature.h"

namespace penumbra::stress {
namespace bsdf_cases {
namespace {

constexpr int kGrid = 256;
// Directions are floats, and mirroring rounds four times.
constexpr double kDirectionRounding = 4 * kUlp;

struct Exponent {
  const char* name;
  double value;
};
constexpr Exponent kExponents[] = {{"0", 0},      {"1", 1},       {"33.5", 33.5},
                                   {"1e3", 1000}, {"1e4", 10000}, {"1e5", 100000}};

/// A pair of directions: the angle of wo from the normal, and of wi from its mirror direction.
struct Pair {
  const char *name, *stiff;
  double tilt, off;
};
const Pair kPairs[] = {{"peak", "the peak of the lobe", .5, 0},
                       {"shoulder", "a lobe's width off its peak", .5, -1},
                       {"grazing", "both directions under cosines of 1e-6", 1.5707953267948966, 0},
                       {"far", "half a radian off the peak", .5, -.5}};

QuadFunction value_function(bool pdf) {
  return [pdf](const Quads& in) {
    const PhongValue v = phong(in[9], in[10], in[11], quad(in, 0), quad(in, 3), quad(in, 6));
    return Quads{pdf ? v.pdf : v.f_cos};
  };
}

void add_values(std::vector<Case>& cases) {
  for (const Exponent& e : kExponents) {
    for (const Pair& pair : kPairs) {
      const double width = 1 / std::sqrt(e.value + 1), off = pair.off == -1 ? width : -pair.off;
      const double angle = pair.tilt - off;
      const Points directions{
          {0, 0, 1}, {std::sin(pair.tilt), 0, std::cos(pair.tilt)}, {-std::sin(angle), 0, std::cos(angle)}};
      Numbers inputs = floats({}, {.3, .6, e.value});
      for (const double v : floats(directions)) inputs.push_back(v);
      Numbers order = floats(directions, {.3, .6, e.value});
      // exp of a product of up to 88: its rounding is multiplied by it.
      const double power = std::min(-e.value * std::log(std::cos(off)), 88.0);
      const double functions = 1e-6 + 4e-7 * power;
      for (const bool pdf : {false, true}) {
        const QuadFunction f = value_function(pdf);
        // The reflectances and the exponent are exact.
        auto deltas = [order] {
          std::vector<double> d = rounding(quads(order), 3, kDirectionRounding);
          std::fill(d.begin() + 9, d.end(), 0.0);
          return d;
        };
        Allowed allowed{
            1e-38, functions, "directions off by 2^-22; exp and log, 4e-7 of the power's logarithm", {}};
        allowed.computed = [f, order, deltas] { return sensitivity(f, quads(order), deltas()); };
        cases.push_back({fmt::format("phong/{}-{}{}", pair.name, e.name, pdf ? "-pdf" : ""),
                         fmt::format("{}, exponent {}", pair.stiff, e.name),
                         pdf ? "density, 1/sr" : "f cos, 1/sr",
                         KernelMeasurement{QUANTITY_BSDF_VALUE, inputs, outputs(pdf ? 1 : 0, 1)},
                         truth_of(f, order, "the definition in 113 bits"), allowed});
      }
    }
  }
}

void add_albedos(std::vector<Case>& cases) {
  struct Tilt {
    const char *name, *stiff;
    double angle;
  };
  const Tilt tilts[] = {{"normal", "along the normal", 0},
                        {"60", "60 degrees off the normal", 1.0471975511965976},
                        {"grazing", "under a cosine of 1e-6", 1.5707953267948966}};
  for (const Exponent& e : kExponents) {
    for (const Tilt& tilt : tilts) {
      for (const double lobe : {1.0, .5}) {
        Numbers inputs = floats({}, {lobe == 1 ? 0 : .5, lobe == 1 ? 1 : .5, e.value});
        const Point wo = rounded(Point{std::sin(tilt.angle), 0, std::cos(tilt.angle)});
        for (const double v : floats({{0, 0, 1}, wo}, {double(kGrid)})) inputs.push_back(v);
        const double exponent = e.value;
        cases.push_back({fmt::format("albedo/{}-{}{}", tilt.name, e.name, lobe == 1 ? "" : "-mixed"),
                         fmt::format("a lobe of exponent {}, {}{}", e.name, tilt.stiff,
                                     lobe == 1 ? "" : ", and a diffuse part"),
                         fmt::format("albedo by {0} x {0} samples", kGrid),
                         KernelMeasurement{QUANTITY_BSDF_ALBEDO, inputs,
                                           [](const Numbers& out) { return Numbers{out[0] + out[2]}; }},
                         {[wo, exponent, lobe] {
                            const Quad angle = atan2_q(wo.x, wo.z);
                            const Quad specular = phong_albedo(exponent, angle);
                            return Quads{lobe == 1 ? specular : (1 + specular) / 2};
                          },
                          "tanh-sinh quadrature in 113 bits"},
                         absolute(1.0 / (kGrid * std::sqrt(double(kGrid))),
                                  "N^-1.5 of the midpoint rule, for the root in u")});
      }
    }
  }
  cases.push_back(
      {"albedo/largest-weight", "a sample of a lobe of exponent 1e5 along the horizon",
       "largest weight of a sample",
       KernelMeasurement{QUANTITY_BSDF_ALBEDO, floats({}, {0, 1, 1e5, 0, 0, 1, 1, 0, 1e-6, kGrid}),
                         [](const Numbers& out) {
                           return Numbers{worst({0.0, out[1] - 1.00002})};
                         }},
       known(0, "a weight is at most (n + 2) / (n + 1)"), absolute(1e-6, "rounding")});
}

void add_sample_ends(std::vector<Case>& cases) {
  for (const Exponent& e : kExponents) {
    for (const auto& [name, u, v] :
         {std::tuple("u0", 0.0, 0.0), std::tuple("u1", kBelow1, kBelow1), std::tuple("u-2^-24", kUlp, .25)}) {
      Numbers inputs = floats({}, {0, 1, e.value});
      const Points directions{{0, 0, 1}, {0, 0, 1}};
      for (const double x : floats(directions, {u, v, 0})) inputs.push_back(x);
      // Along the normal the lobe is about it: cos^(n+1) = 1 - u.
      const Numbers order{u, v, e.value};
      const QuadFunction f = [](const Quads& in) {
        const Quad power = log_q(1 - in[0]) / (in[2] + 1);
        const Quad sine = sqrt_q(-expm1_q(2 * power)), azimuth = 2 * kQuadPi * in[1];
        return Quads{sine * cos_q(azimuth), sine * sin_q(azimuth), exp_q(power)};
      };
      cases.push_back({fmt::format("phong/sample-{}-{}", e.name, name),
                       fmt::format("u = {:.9g}, v = {:.9g}, exponent {}", u, v, e.name), "sampled direction",
                       KernelMeasurement{QUANTITY_BSDF_SAMPLE, inputs, outputs(0, 3)},
                       truth_of(f, order, "inverted distribution in 113 bits"),
                       absolute(1.5e-6, "the functions' documented errors, times 2 pi for the azimuth")});
    }
  }
}

void add_directions(std::vector<Case>& cases) {
  const char* kinds[] = {"cosine", "hemisphere", "sphere"};
  for (const int kind : {0, 1, 2}) {
    for (const auto& [name, u, v] : {std::tuple("u0", 0.0, 0.0), std::tuple("u1", kBelow1, kBelow1),
                                     std::tuple("u-2^-24", kUlp, .125)}) {
      const Numbers order = {u, v, double(kind)};
      const QuadFunction f = [](const Quads& in) {
        const int k = int(double(in[2]));
        const Quad z = k == 0 ? sqrt_q(1 - in[0]) : k == 1 ? 1 - in[0] : 1 - 2 * in[0];
        const Quad r = sqrt_q((1 - z) * (1 + z)), azimuth = 2 * kQuadPi * in[1];
        return Quads{r * cos_q(azimuth), r * sin_q(azimuth), z};
      };
      cases.push_back(
          {fmt::format("direction/{}-{}", kinds[kind], name), fmt::format("u = {:.9g}, v = {:.9g}", u, v),
           "sampled direction",
           KernelMeasurement{QUANTITY_DIRECTION, floats({}, {double(kind), 0, 0, 1, u, v}), outputs(0, 3)},
           truth_of(f, order, "inverted distribution in 113 bits"),
           absolute(1e-6, "the documented error of sincos_2pi and rounding")});
    }
  }
  for (const auto& [name, n] :
       {std::pair("down", Point{0, 0, -1}), std::pair("up", Point{0, 0, 1}),
        std::pair("almost-down", unit(3e-4, -1e-4, -1)), std::pair("equator", unit(1, 2, 0)),
        std::pair("minus-0", Point{1, 0, -0.0})}) {
    const Numbers inputs = floats({n, unit(.3, -.5, .8)});
    cases.push_back({fmt::format("direction/frame-{}", name), "a frame near the pole of its construction",
                     "how far a vector is missed that goes into the frame and back",
                     KernelMeasurement{QUANTITY_FRAME, inputs, outputs(3, 1)}, known(0, "closed form"),
                     absolute(16 * kUlp, "some dozen roundings of unit vectors")});
  }
}

}  // namespace

void add(std::vector<Case>& cases) {
  add_values(cases);
  add_sample_ends(cases);
  add_albedos(cases);
  add_directions(cases);
}

}  // namespace bsdf_cases

void add_bsdf_cases(std::vector<Case>& cases) { bsdf_cases::add(cases); }

}  // namespace penumbra::stress
