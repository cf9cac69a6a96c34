#include "scenes/measured_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "kernels/bsdf/families.h"
#include "scenes/angles.h"
#include "scenes/spectrum.h"
#include "scenes/tensor_file.h"

namespace penumbra {
namespace {

using TensorShape = std::vector<std::uint64_t>;
constexpr std::uint64_t kAny = 0;  ///< in shapes that are wanted

class MeasuredReader {
 public:
  MeasuredReader(const std::string& name, const Tensors& tensors) : name_(name), tensors_(tensors) {}

  /// The first problem, or nothing.
  [[nodiscard]] const std::optional<std::string>& problem() const { return problem_; }

  MeasuredBrdf read() {
    MeasuredBrdf brdf;
    constexpr auto kHalfTurn = float(kPi);
    constexpr float kRound = 1e-3f;
    brdf.theta = angles("theta_i", -kRound, kHalfTurn / 2 + kRound);
    brdf.phi = angles("phi_i", -2 * kHalfTurn - kRound, 2 * kHalfTurn + kRound);
    const TensorShape directions{brdf.phi.size(), brdf.theta.size()};
    brdf.ndf = grids("ndf", {});
    brdf.sigma = grids("sigma", {});
    brdf.vndf = grids("vndf", directions);
    brdf.luminance = grids("luminance", directions);
    if (!problem_) brdf.colours = colours(brdf);
    const Tensor* flag = take("jacobian", Tensor::kByte, {1});
    brdf.by_facets = flag != nullptr && flag->bytes[0] != 0;
    return brdf;
  }

 private:
  void wrong(std::string_view field, const std::string& what) {
    if (!problem_) problem_ = fmt::format("{}: field '{}' {}", name_, field, what);
  }

  /// The field, if it has that type and shape; else null, and a problem.
  const Tensor* take(std::string_view field, std::uint8_t type, const TensorShape& wanted) {
    if (problem_) return nullptr;
    const auto found = tensors_.find(field);
    if (found == tensors_.end()) return wrong(field, "is missing"), nullptr;
    const Tensor& tensor = found->second;
    if (tensor.type != type)
      return wrong(field, fmt::format("has the type {}; it must be {}, {}", tensor.type, type,
                                      type == Tensor::kByte ? "unsigned bytes" : "single precision")),
             nullptr;
    const bool fits = std::ranges::equal(tensor.shape, wanted, [](std::uint64_t side, std::uint64_t want) {
      return want == kAny ? side > 0 : side == want;
    });
    if (fits) return &tensor;
    std::string words;
    for (const std::uint64_t want : wanted)
      words += fmt::format("{}{}", words.empty() ? "" : " x ", want == kAny ? "any" : fmt::to_string(want));
    wrong(field, fmt::format("has the shape {}; it must be {}", print_shape(tensor.shape), words));
    return nullptr;
  }

  /// The numbers of a field of single precision, which are finite.
  std::vector<float> numbers(std::string_view field, const TensorShape& wanted) {
    const Tensor* tensor = take(field, Tensor::kFloat, wanted);
    if (tensor == nullptr) return {};
    std::vector<float> values(tensor->bytes.size() / sizeof(float));
    std::memcpy(values.data(), tensor->bytes.data(), values.size() * sizeof(float));
    if constexpr (std::endian::native == std::endian::big)
      for (float& value : values)
        value = std::bit_cast<float>(std::byteswap(std::bit_cast<std::uint32_t>(value)));
    const auto odd = std::ranges::find_if(values, [](float value) { return !std::isfinite(value); });
    if (odd != values.end())
      wrong(field, fmt::format("has the number {} at {}; all must be finite", *odd, odd - values.begin()));
    return values;
  }

  std::vector<float> ascending(std::string_view field) {
    std::vector<float> values = numbers(field, {kAny});
    const auto odd = std::ranges::adjacent_find(values, [](float a, float b) { return !(a < b); });
    if (odd != values.end())
      wrong(field, fmt::format("has {} before {}; its numbers must ascend", odd[0], odd[1]));
    return values;
  }

  std::vector<float> angles(std::string_view field, float least, float most) {
    std::vector<float> values = ascending(field);
    if (values.size() > MEASURED_NODES)
      wrong(field, fmt::format("has {} angles; {} at most are read", values.size(), MEASURED_NODES));
    if (!values.empty() && !(values.front() >= least && values.back() <= most))
      wrong(field, fmt::format("goes from {} to {}; it must be in [{:.3f}, {:.3f}] radians", values.front(),
                               values.back(), least, most));
    return values;
  }

  /// Densities for each of some directions.
  MeasuredBrdf::Grids grids(std::string_view field, TensorShape shape) {
    shape.insert(shape.end(), {kAny, kAny});
    MeasuredBrdf::Grids result;
    result.values = numbers(field, shape);
    if (problem_) return {};
    const TensorShape& found = tensors_.find(field)->second.shape;
    const std::uint64_t rows = found[found.size() - 2], columns = found.back();
    if (std::min(rows, columns) < 2 || std::max(rows, columns) > MEASURED_SIDE)
      wrong(field, fmt::format("has grids of {} x {}; they must have 2 to {} knots along each side", rows,
                               columns, MEASURED_SIDE));
    const auto odd = std::ranges::find_if(result.values, [](float value) { return value < 0; });
    if (odd != result.values.end())
      wrong(field,
            fmt::format("has the number {} at {}; none may be below 0", *odd, odd - result.values.begin()));
    if (problem_) return {};
    result.rows = int(rows), result.columns = int(columns);
    return result;
  }

  std::vector<float> colours(const MeasuredBrdf& brdf) {
    const bool spectral = !tensors_.contains("rgb") && tensors_.contains("spectra");
    const std::vector<float> wavelengths = spectral ? ascending("wavelengths") : std::vector<float>{};
    const std::size_t channels = spectral ? wavelengths.size() : 3;
    const auto rows = std::uint64_t(brdf.luminance.rows), columns = std::uint64_t(brdf.luminance.columns);
    const std::vector<float> values =
        numbers(spectral ? "spectra" : "rgb", {brdf.phi.size(), brdf.theta.size(), channels, rows, columns});
    if (problem_) return {};
    const std::vector<glm::dvec3> weights =
        spectral ? weights_of(wavelengths) : std::vector<glm::dvec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::size_t knots = brdf.luminance.knots(), slices = brdf.phi.size() * brdf.theta.size();
    std::vector<float> result(3 * slices * knots);
    std::vector<glm::dvec3> sums(knots);
    for (std::size_t slice = 0; slice < slices; ++slice) {
      std::ranges::fill(sums, glm::dvec3(0.0));
      for (std::size_t k = 0; k < channels; ++k)
        for (std::size_t i = 0; i < knots; ++i)
          sums[i] += double(values[(slice * channels + k) * knots + i]) * weights[k];
      for (std::size_t i = 0; i < knots; ++i)
        for (int c = 0; c < 3; ++c)
          result[3 * (slice * knots + i) + std::size_t(c)] = float(std::max(sums[i][c], 0.0));
    }
    return result;
  }

  /// What a spectrum's value at each wavelength adds to its colour: the colour of a spectrum of 1 there and 0
  /// at the others. Beyond the ends it goes on.
  static std::vector<glm::dvec3> weights_of(std::span<const float> wavelengths) {
    constexpr double kBefore = -1.0, kBeyond = 1e6;  // nm: beyond what the eye sees
    std::vector<SpectrumSample> samples{{std::min(kBefore, double(wavelengths.front()) - 1), 0}};
    for (const float each : wavelengths) samples.push_back({double(each), 0});
    samples.push_back({std::max(kBeyond, double(wavelengths.back()) + 1), 0});
    std::vector<glm::dvec3> weights;
    for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
      samples[k].value = 1;
      samples.front().value = k == 1 ? 1 : 0;
      samples.back().value = k + 2 == samples.size() ? 1 : 0;
      weights.push_back(unclamped_index_to_rgb(samples));
      samples[k].value = 0;
    }
    return weights;
  }

  const std::string& name_;
  const Tensors& tensors_;
  std::optional<std::string> problem_;
};

}  // namespace

Expected<MeasuredBrdf> read_measured_file(const std::string& name, std::string_view bytes) {
  const Expected<Tensors> tensors = read_tensors(name, bytes);
  if (!tensors) return std::unexpected(tensors.error());
  MeasuredReader reader(name, *tensors);
  MeasuredBrdf brdf = reader.read();
  if (reader.problem()) return fail(*reader.problem());
  return brdf;
}

Expected<std::shared_ptr<const MeasuredBrdf>> MeasuredFiles::read(const FileAccess& files,
                                                                  const std::filesystem::path& path) {
  std::error_code ignored;
  const std::string key = std::filesystem::weakly_canonical(path, ignored).string();
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  const auto read_new = [&]() -> Expected<std::shared_ptr<const MeasuredBrdf>> {
    const Expected<std::string> bytes = files.read_bytes(path, kMaxMeasuredFileBytes);
    if (!bytes) return std::unexpected(bytes.error());
    Expected<MeasuredBrdf> brdf = read_measured_file(path.string(), *bytes);
    if (!brdf) return std::unexpected(brdf.error());
    return std::make_shared<const MeasuredBrdf>(std::move(*brdf));
  };
  return known_.emplace(key, read_new()).first->second;
}

}  // namespace penumbra
