#include "tests/acceptance/film_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

namespace penumbra {
namespace {

constexpr double kLuminance[3] = {0.212671, 0.715160, 0.072169};  // of linear sRGB

/// First pixel of block `i` of `size` pixels.
int block_begin(int i, int size) { return i * size / FilmThumbnail::kBlocks; }

/// "0.5 instead of 0.25 (+100 %, z = 3.2)".
std::string step_text(double now, double before, double error) {
  const double difference = now - before;
  const std::string share =
      before != 0 ? fmt::format("{:+.3g} %", 100 * difference / before) : fmt::format("{:+.3g}", difference);
  const std::string z = error > 0 ? fmt::format("z = {:.2g}", difference / error) : "both without noise";
  return fmt::format("{:.6g} instead of {:.6g} ({}, {})", now, before, share, z);
}

}  // namespace

RecordedFilm record_film(const FilmAccumulator& film) {
  RecordedFilm recorded{fmt::format("{:016x}", film.hash()), {}};
  constexpr int kBlocks = FilmThumbnail::kBlocks;
  for (int block = 0; block < kBlocks * kBlocks; ++block) {
    const int row = block / kBlocks, column = block % kBlocks;
    double sum = 0, variance = 0;
    int pixels = 0;
    for (int y = block_begin(row, film.height()); y < block_begin(row + 1, film.height()); ++y)
      for (int x = block_begin(column, film.width()); x < block_begin(column + 1, film.width()); ++x) {
        const PixelStatistics& pixel = film.at(film.x() + x, film.y() + y);
        const double n = double(pixel.count);
        for (int c = 0; c < 3; ++c) {
          sum += kLuminance[c] * pixel.mean[c];
          // Channels of a sample vary together, so their deviations add up, not their squares; this is an
          // upper bound.
          if (n > 1) variance += kLuminance[c] * pixel.m2[c] / (n * (n - 1));
        }
        ++pixels;
      }
    recorded.picture.mean.push_back(sum / pixels);
    recorded.picture.error.push_back(std::sqrt(variance) / pixels);
  }
  return recorded;
}

FilmRecord read_film_record(const std::filesystem::path& path) {
  std::ifstream file(path);
  FilmRecord record;
  if (!file) return record;
  const nlohmann::json entries = nlohmann::json::parse(file);
  for (const auto& [name, entry] : entries.items())
    record[name] = {
        entry.at("hash"),
        {entry.value("mean", std::vector<double>{}), entry.value("error", std::vector<double>{})}};
  return record;
}

void write_film_record(const std::filesystem::path& path, const FilmRecord& record) {
  std::ofstream file(path);
  // A line an image, so that a change of the record can be read.
  const char* separator = "{\n";
  const auto numbers = [](const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += fmt::format("{}{:.4g}", text.empty() ? "" : ",", value);
    return text;
  };
  for (const auto& [name, film] : record) {
    file << separator << nlohmann::json(name).dump() << ": {\"hash\": \"" << film.hash << '"';
    if (!film.picture.mean.empty())
      file << fmt::format(", \"mean\": [{}], \"error\": [{}]", numbers(film.picture.mean),
                          numbers(film.picture.error));
    file << '}';
    separator = ",\n";
  }
  file << "\n}\n";
}

std::string difference_text(const FilmThumbnail& now, const FilmThumbnail& before, int width, int height) {
  const std::size_t blocks = now.mean.size();
  if (blocks == 0 || before.mean.size() != blocks) return "one of the two is no image";
  const auto error = [&](std::size_t i) { return std::hypot(now.error[i], before.error[i]); };
  std::size_t worst = 0;
  double worst_z = -1, variance = 0;
  for (std::size_t i = 0; i < blocks; ++i) {
    const double difference = std::abs(now.mean[i] - before.mean[i]);
    const double z = difference == 0 ? 0 : difference / std::max(error(i), 1e-12);
    if (z > worst_z) worst_z = z, worst = i;
    variance += error(i) * error(i);
  }
  const auto mean = [](const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0) / double(v.size());
  };
  const int row = int(worst) / FilmThumbnail::kBlocks, column = int(worst) % FilmThumbnail::kBlocks;
  return fmt::format("mean luminance {}; most different in pixels {}..{} x {}..{}: {}",
                     step_text(mean(now.mean), mean(before.mean), std::sqrt(variance) / double(blocks)),
                     block_begin(column, width), block_begin(column + 1, width) - 1, block_begin(row, height),
                     block_begin(row + 1, height) - 1,
                     step_text(now.mean[worst], before.mean[worst], error(worst)));
}

}  // namespace penumbra
