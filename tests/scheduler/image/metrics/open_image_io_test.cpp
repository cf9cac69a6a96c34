// Compares the metrics with OpenImageIO's where both have the same ones.
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include "scheduler/image/metrics/error_metrics.h"
#include "tests/scheduler/image/metrics/small_images.h"

namespace penumbra {
namespace {

OIIO::ImageBufAlgo::CompareResults compared(const Image& a, const Image& b) {
  const OIIO::ImageSpec spec(a.data.width, a.data.height, 3, OIIO::TypeDesc::FLOAT);
  const OIIO::ImageBuf first(spec, const_cast<float*>(a.values.data()));
  const OIIO::ImageBuf second(spec, const_cast<float*>(b.values.data()));
  return OIIO::ImageBufAlgo::compare(first, second, 0, 0);
}

// OpenImageIO squares in float: 1e-6 of relative error.
TEST(OpenImageIo, AgreesOnMeanSquareLargestAndPeakSignalToNoise) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    std::vector<float> a, b;
    for (std::uint64_t i = 0; i < 37 * 23 * 3; ++i) {
      b.push_back(float(hashed(i, 2 * seed)));
      a.push_back(float(b.back() + 0.2 * (hashed(i, 2 * seed + 1) - 0.5)));
    }
    b[500] = 1;  // the peak, by which OpenImageIO takes the largest value of both
    a[500] = 0.9f;
    for (float& value : a) value = std::min(value, 1.0f);
    const Image image = image_of(37, 23, a), reference = image_of(37, 23, b);
    const ImagePair pair = pair_of(image, reference);
    const auto other = compared(image, reference);
    const double mse = mean_squared_error(pair).overall;
    EXPECT_NEAR(mse, other.rms_error * other.rms_error, 1e-6 * mse);
    const LargestDifference largest = largest_difference(pair);
    EXPECT_NEAR(largest.value, other.maxerror, 1e-6 * largest.value);
    EXPECT_EQ(largest.x, other.maxx);
    EXPECT_EQ(largest.y, other.maxy);
    EXPECT_EQ(int(largest.channel), other.maxc);
    EXPECT_NEAR(peak_signal_to_noise_ratio(pair).overall, other.PSNR, 1e-4);
  }
}

}  // namespace
}  // namespace penumbra
