// The ratio estimator's statistics of one pixel. Its quotient is that of the sums of all samples: by the pass
// its bias would be that of a pass, however many there are.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace penumbra {

/// A channel of a pixel in one result, see RatioPlane: samples a_i + r b_i for their own ratio r.
struct RatioPart {
  std::uint64_t count = 0;
  double mean = 0, deviation = 0;  ///< of the samples
  double b = 0, deviation_b = 0;   ///< of b
  double correlation = 0;          ///< of the samples and b
  double ratio = 0, w = 0;         ///< <H> / <W>, and <W>
  double difference = 0;           ///< mean of the layer of that name, which depends on r as the mean does
};

/// All results of it. Sample i is a_i + r b_i with r = <H> / <W> over all samples, 0 where <W> is 0. The mean
/// is that of G <H> / <W> for equal G, and the samples are its linearisation about the means, so that their
/// spread is its error by the delta method (Heitz, Hill and McGuire 2018). Biased by
///   -E[(H - r W) b] / (n E[W]) + O(1/n^2) for n samples.
/// Sums are kept for the first result's ratio, near which the last one is: little cancels then, and nothing
/// changes where there is one result, or the same ratio in all.
class RatioSums {
 public:
  void add(const RatioPart& part) {
    if (count_ == 0) ratio_ = part.ratio;
    const double n = double(part.count), share = n / double(count_ + part.count);
    const double squares = double(count_) * share, change = ratio_ - part.ratio;
    const double squares_b = part.deviation_b * part.deviation_b * n;
    const double products = part.correlation * part.deviation * part.deviation_b * n;
    const double mean = part.mean + change * part.b;
    const double between = mean - mean_, between_b = part.b - b_;
    m2_ += part.deviation * part.deviation * n + change * (2 * products + change * squares_b) +
           between * between * squares;
    squares_b_ += squares_b + between_b * between_b * squares;
    products_ += products + change * squares_b + between * between_b * squares;
    mean_ += between * share;
    b_ += between_b * share;
    w_ += (part.w - w_) * share;
    excess_ += (-change * part.w - excess_) * share;
    difference_ += (part.difference + change * part.b - difference_) * share;
    count_ += part.count;
  }

  [[nodiscard]] double mean() const { return mean_ + change() * b_; }
  /// Sum of squared deviations from it.
  [[nodiscard]] double m2() const {
    return std::max(m2_ + change() * (2 * products_ + change() * squares_b_), 0.0);
  }
  [[nodiscard]] double difference() const { return difference_ + change() * b_; }

  /// Whether they are numbers, of so many samples.
  [[nodiscard]] bool is_of(std::uint64_t count) const {
    const double all[] = {ratio_, mean_, m2_, b_, squares_b_, products_, w_, excess_, difference_};
    return count_ == count && std::ranges::all_of(all, [](double v) { return std::isfinite(v); });
  }

 private:
  /// From the first result's ratio to that of all.
  [[nodiscard]] double change() const { return w_ > 0 ? excess_ / w_ : 0; }

  std::uint64_t count_ = 0;
  double ratio_ = 0;              // of the first result; the following are for it
  double mean_ = 0, m2_ = 0;      // of the samples
  double b_ = 0, squares_b_ = 0;  // mean and sum of squared deviations of b
  double products_ = 0;           // sum of the products of both deviations
  double w_ = 0, excess_ = 0;     // means of W and of H - ratio_ W
  double difference_ = 0;
};

}  // namespace penumbra
