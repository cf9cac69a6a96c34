#include "scheduler/advise/pilot.h"

#include <algorithm>
#include <cmath>

#include "kernels/sampler/sampler.h"
#include "worker/device.h"

namespace penumbra {
namespace {

constexpr uint kTileSeed = 0x51ed270bu;  // of the tiles' places

/// Random whole numbers below `end`.
int number_below(int end, int tile, int which) {
  const uint bits = hash_uint(kTileSeed ^ hash_uint(uint(2 * tile + which)));
  return std::min(end - 1, int(double(unit_float(bits)) * end));
}

}  // namespace

std::vector<PilotTile> pilot_tiles(const Film& film, int most) {
  const int width = film.crop_width, height = film.crop_height;
  const int across = (width + kPilotSide - 1) / kPilotSide, down = (height + kPilotSide - 1) / kPilotSide;
  int columns = across, rows = down;
  if (std::int64_t(across) * down > most) {
    columns = int(std::lround(std::sqrt(double(most) * across / down)));
    columns = std::clamp(columns, 1, std::min(across, most));
    rows = std::clamp(most / columns, 1, down);
  }
  std::vector<PilotTile> tiles;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const int x0 = across * column / columns, x1 = across * (column + 1) / columns;
      const int y0 = down * row / rows, y1 = down * (row + 1) / rows;
      const int tile = int(tiles.size());
      const int x = (x0 + number_below(x1 - x0, tile, 0)) * kPilotSide;
      const int y = (y0 + number_below(y1 - y0, tile, 1)) * kPilotSide;
      tiles.push_back({film.crop_x + x, film.crop_y + y, std::min(kPilotSide, width - x),
                       std::min(kPilotSide, height - y)});
    }
  return tiles;
}

Expected<Pilot> render_pilot(const DeviceScene& scene, std::span<const PilotTile> tiles, int threads) {
  Pilot pilot;
  DeviceOptions options{.threads = threads, .isa = best_isa()};
  options.traced = &pilot.traced;
  auto device = make_device(scene, options);
  if (!device) return std::unexpected(device.error());
  for (int batch = 0; batch < kPilotBatches; ++batch) {
    std::vector<float>& means = pilot.means.emplace_back();
    std::size_t at = 0;
    for (const PilotTile& tile : tiles) {
      const RenderUnit unit{.x = tile.x,
                            .y = tile.y,
                            .width = tile.width,
                            .height = tile.height,
                            .first_sample = 0,
                            .sample_count = kPilotSamples,
                            .sequence = uint(batch + 1),
                            .spp = kPilotSamples};
      const auto rendered = (*device)->render(unit);
      if (!rendered) return std::unexpected(rendered.error());
      pilot.samples += rendered->pixels() * kPilotSamples;
      pilot.within.resize(std::max(pilot.within.size(), at + 3 * rendered->pixels()));
      for (std::size_t pixel = 0; pixel < rendered->pixels(); ++pixel)
        for (int c = 0; c < 3; ++c, ++at) {
          means.push_back(rendered->plane(kMeanR + c)[pixel]);
          const double deviation = rendered->plane(kDeviationR + c)[pixel];
          pilot.within[at] += deviation * deviation / (kPilotSamples - 1) / kPilotBatches;
        }
    }
  }
  return pilot;
}

}  // namespace penumbra
