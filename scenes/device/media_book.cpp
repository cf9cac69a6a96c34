#include "scenes/device/media_book.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <span>

#include "kernels/medium/majorant_grid.h"
#include "scenes/bsdfs/half_space.h"
#include "scenes/device/scene_records.h"
#include "scenes/device/to_vec3.h"
#include "scenes/grid_volume.h"

namespace penumbra {
namespace {

/// The tables of volumes: grids by which media vary in space, and their majorants.
class VolumeTables {
 public:
  /// `center`: the centre of the scene, which is the origin of the kernels' coordinates.
  explicit VolumeTables(const glm::dvec3& center) : center_(center) {}

  /// Adds a volume to the tables and returns its index. A grid that is already in the tables is not stored
  /// again. Errors: tables too large for their indices; a transform that has no inverse.
  Expected<int> add(const GridVolume& volume, SceneRecords& records);

 private:
  struct Values {
    int first_value, first_majorant;
  };
  glm::dvec3 center_;
  std::map<std::pair<const VolumeGrid*, bool>, Values> known_;
};

constexpr std::int64_t kMostNumbers = std::numeric_limits<int>::max() / 2;

/// The fine cells that affect a cell of the coarse grid, including the neighbours that interpolation reads.
struct Range {
  int from, to;
};
Range cells_of(int coarse, int cells, bool nearest) {
  const int margin = nearest ? 0 : 1, first = coarse * MAJORANT_CELLS;
  return {std::max(first - margin, 0), std::min(first + MAJORANT_CELLS + margin, cells)};
}

float largest(const VolumeGrid& grid, Range x, Range y, Range z) {
  float most = 0.0f;
  for (int k = z.from; k < z.to; ++k)
    for (int j = y.from; j < y.to; ++j) {
      const std::size_t row = (std::size_t(k) * std::size_t(grid.ny) + std::size_t(j)) * std::size_t(grid.nx);
      const auto channels = std::size_t(grid.channels);
      const auto* begin = grid.values.data() + (row + std::size_t(x.from)) * channels;
      most = std::max(most, *std::max_element(begin, begin + std::size_t(x.to - x.from) * channels));
    }
  return most;
}

void append_majorants(const VolumeGrid& grid, bool nearest, std::vector<float>& majorants) {
  for (int z = 0; z < majorant_cells(grid.nz); ++z)
    for (int y = 0; y < majorant_cells(grid.ny); ++y)
      for (int x = 0; x < majorant_cells(grid.nx); ++x)
        majorants.push_back(largest(grid, cells_of(x, grid.nx, nearest), cells_of(y, grid.ny, nearest),
                                    cells_of(z, grid.nz, nearest)));
}

Expected<int> VolumeTables::add(const GridVolume& volume, SceneRecords& records) {
  const VolumeGrid& grid = *volume.grid;
  if (std::max({grid.nx, grid.ny, grid.nz}) > MAX_VOLUME_CELLS)
    return fail(fmt::format("a volume of {} x {} x {} cells; there may be {} along an axis", grid.nx, grid.ny,
                            grid.nz, MAX_VOLUME_CELLS));
  if (std::int64_t(records.volume_values.size() + grid.values.size()) > kMostNumbers)
    return fail(fmt::format("the volumes of the scene have more than {} numbers", kMostNumbers));
  const auto [entry, is_new] = known_.try_emplace({&grid, volume.nearest});
  if (is_new) {
    // A grid has different majorants with and without interpolation.
    const auto other = known_.find({&grid, !volume.nearest});
    const bool stored = other != known_.end();
    entry->second = {stored ? other->second.first_value : int(records.volume_values.size()),
                     int(records.majorants.size())};
    if (!stored)
      records.volume_values.insert(records.volume_values.end(), grid.values.begin(), grid.values.end());
    append_majorants(grid, volume.nearest, records.majorants);
  }

  const glm::dvec3 cells(grid.nx, grid.ny, grid.nz);
  const glm::dmat3 to_cells =
      glm::dmat3(glm::scale(glm::dmat4(1.0), cells)) * glm::inverse(glm::dmat3(volume.to_world));
  const glm::dmat3 rows = glm::transpose(to_cells);
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(float(rows[axis][k]))) return fail("a volume whose to_world has no inverse");
  Volume record{};
  record.corner = to_vec3(glm::dvec3(volume.to_world[3]) - center_);
  record.row_x = to_vec3(rows[0]);
  record.row_y = to_vec3(rows[1]);
  record.row_z = to_vec3(rows[2]);
  record.nx = grid.nx;
  record.ny = grid.ny;
  record.nz = grid.nz;
  record.channels = grid.channels;
  record.nearest = volume.nearest ? 1 : 0;
  record.fades = volume.fades ? 1 : 0;
  record.first_value = entry->second.first_value;
  record.first_majorant = entry->second.first_majorant;
  records.volumes.push_back(record);
  return int(records.volumes.size()) - 1;
}

constexpr std::size_t kMostMedia = MAX_MEDIA - 1;

/// The index of the phase function's material. Its lobes are added if they are new.
int material_of_phase(const std::vector<PhaseLobe>& phase, SceneRecords& records, int first_material) {
  std::vector<PhaseLobe> lobes = phase;
  lobes.resize(PHASE_LOBES, PhaseLobe{PHASE_HG, 0.0f, 0.0f});
  const auto known = int(records.phase_lobes.size()) / PHASE_LOBES;
  for (int k = 0; k < known; ++k)
    if (std::equal(lobes.begin(), lobes.end(), records.phase_lobes.begin() + k * PHASE_LOBES))
      return first_material + k;
  Material material = material_of_family(FAMILY_PHASE);
  material.first_lobe = int(records.phase_lobes.size());
  records.phase_lobes.insert(records.phase_lobes.end(), lobes.begin(), lobes.end());
  records.materials.push_back(material);
  return first_material + known;
}

bool equal(const std::optional<GridVolume>& a, const std::optional<GridVolume>& b) {
  if (!a || !b) return !a && !b;
  const VolumeGrid &g = *a->grid, &h = *b->grid;
  return a->to_world == b->to_world && a->nearest == b->nearest && a->fades == b->fades &&
         (&g == &h ||
          (g.nx == h.nx && g.ny == h.ny && g.nz == h.nz && g.channels == h.channels && g.values == h.values));
}

bool equal(const ParticipatingMedium& a, const ParticipatingMedium& b) {
  return a.extinction == b.extinction && a.albedo == b.albedo && a.phase == b.phase &&
         equal(a.density, b.density) && equal(a.albedo_grid, b.albedo_grid) && a.emission == b.emission &&
         equal(a.emission_grid, b.emission_grid) && a.emission_by_density == b.emission_by_density;
}

/// The grid that multiplies a medium's emission; of an emission that is the same in the box of the density,
/// one cell.
std::optional<GridVolume> emission_grid(const ParticipatingMedium& medium) {
  if (!medium.emits() || medium.emission_grid) return medium.emits() ? medium.emission_grid : std::nullopt;
  if (!medium.density || medium.emission_by_density) return std::nullopt;
  static const auto kOne = std::make_shared<const VolumeGrid>(VolumeGrid{1, 1, 1, 1, {1.0f}});
  return GridVolume{.grid = kOne, .to_world = medium.density->to_world};
}

/// The record of vacuum; other media change what they have.
Medium vacuum() {
  Medium nothing{};
  nothing.density = nothing.albedo_grid = nothing.emission_grid = nothing.light = -1;
  nothing.exit = nothing.albedo_curve = -1;
  return nothing;
}

/// The start of the curve of HalfSpace::curve for that mean cosine.
int half_space_curve(float g, std::map<float, int>& known, std::vector<float>& curves) {
  const auto [at, is_new] = known.try_emplace(g, int(curves.size()));
  if (is_new) std::ranges::copy(half_space(g).curve(), std::back_inserter(curves));
  return at->second;
}

bool is_boundary(const Shape& shape) { return shape.interior != kNoMedium || shape.exterior != kNoMedium; }

}  // namespace

std::map<int, std::string> boundary_names(const SceneDescription& scene) {
  std::map<int, std::string> names;
  int number = 0;
  const auto add = [&](const std::vector<Shape>& shapes) {
    for (const Shape& shape : shapes) {
      if (is_boundary(shape)) names.emplace(number, shape.name);
      ++number;
    }
  };
  add(scene.shapes);
  for (const ShapeGroup& group : scene.groups) add(group.shapes);
  return names;
}

MediaBook::MediaBook(const SceneDescription& scene, const std::vector<PlacedGroup>& placed) : scene_(scene) {
  const bool interiors = sees_interiors();
  if (!sees_media(scene.integrator) && !interiors) return;
  find_equal_media();
  if (interiors) find_interiors();
  std::size_t number = 0;
  for (const Shape& shape : scene.shapes) add(shape, number++);
  std::vector<bool> is_placed(scene.groups.size(), false);
  for (const PlacedGroup& place : placed) is_placed[std::size_t(place.group)] = true;
  for (std::size_t g = 0; g < scene.groups.size(); ++g) {
    firsts_.push_back(number);
    for (const Shape& shape : scene.groups[g].shapes) {
      if (is_placed[g]) add(shape, number);
      ++number;
    }
  }
  // As in Mitsuba 3, volpath's paths and shadow rays pass through thin panes as through boundaries.
  const bool has_pane =
      sees_media(scene.integrator) && std::ranges::any_of(scene.bsdfs, [](const Bsdf& bsdf) {
        return std::holds_alternative<ThinDielectricBsdf>(bsdf.model);
      });
  empty_ = boundaries_.empty() && record_of(scene.camera_medium) == 0 && !has_pane;
}

/// Media with equal properties are merged, because a file may define the same medium twice, even on both
/// sides of a boundary.
int MediaBook::record(const Entry& entry) {
  const auto same = std::ranges::find_if(entries_, [&](const Entry& each) {
    const bool kinds = (each.interior == nullptr) == (entry.interior == nullptr);
    return kinds && equal(*each.medium, *entry.medium) &&
           each.medium->of_material == entry.medium->of_material &&
           (each.interior == nullptr || (each.interior->walks == entry.interior->walks &&
                                         each.interior->by_colour == entry.interior->by_colour));
  });
  const int number = int(same - entries_.begin()) + 1;
  // Beyond the limit media are not compared any more; the limit is reported later.
  if (same == entries_.end() && entries_.size() <= kMostMedia) entries_.push_back(entry);
  return number;
}

void MediaBook::find_equal_media() {
  const bool all = sees_media(scene_.integrator);
  for (const ParticipatingMedium& medium : scene_.media)
    records_.push_back(all || medium.of_material ? record({&medium, nullptr}) : 0);
}

void MediaBook::find_interiors() {
  for (std::size_t i = 0; i < scene_.bsdfs.size(); ++i) {
    std::optional<Interior> inside = interior_of(scene_, int(i));
    const bool there = inside.has_value();
    if (there) interiors_.push_back(std::move(*inside));
    interior_records_.push_back(there ? record({&interiors_.back().medium, &interiors_.back()}) : 0);
  }
}

void MediaBook::add(const Shape& shape, std::size_t number) {
  const int own = shape.front_bsdf >= 0 && !interior_records_.empty()
                      ? interior_records_[std::size_t(shape.front_bsdf)]
                      : 0;
  const bool of_material =
      own != 0 || (shape.interior != kNoMedium && scene_.media[std::size_t(shape.interior)].of_material);
  if (!of_material && !(is_boundary(shape) && sees_media(scene_.integrator))) return;
  has_interiors_ |= of_material;
  const bool knows_around = shape.exterior != kNoMedium && sees_media(scene_.integrator);
  Boundary boundary{};
  boundary.interior = own != 0 ? own : record_of(shape.interior);
  boundary.exterior = knows_around ? record_of(shape.exterior) : -1;
  // Surfaces with a material need not be closed.
  boundary.shape = of_material ? -1 : int(number);
  numbers_.emplace(number, int(boundaries_.size()));
  boundaries_.push_back(boundary);
}

bool MediaBook::has_homogeneous() const {
  return !empty_ && sees_media(scene_.integrator) &&
         std::ranges::any_of(scene_.media, [](const ParticipatingMedium& medium) {
           return !medium.of_material && !medium.density && medium.albedo != decltype(medium.albedo)(0.0f);
         });
}

int MediaBook::of_shape(std::size_t index) const {
  const auto found = numbers_.find(index);
  return found != numbers_.end() ? found->second : -1;
}

int MediaBook::of_group(int group, std::size_t index) const {
  return empty_ ? -1 : of_shape(firsts_[std::size_t(group)] + index);
}

Expected<void> MediaBook::fill(const glm::dvec3& center, SceneRecords& records) {
  if (empty_) return {};
  if (entries_.size() > kMostMedia)
    return fail(fmt::format("the scene has {} media, more than {} that differ",
                            scene_.media.size() + interiors_.size(), kMostMedia));
  records.media.push_back(vacuum());
  VolumeTables volumes(center);
  const int first_material = int(records.materials.size());
  std::map<float, int> curves;
  int exit = -1;
  for (const Entry& entry : entries_) {
    const ParticipatingMedium& medium = *entry.medium;
    Medium record = vacuum();
    record.extinction = to_vec3(medium.extinction);
    record.albedo = to_vec3(medium.albedo);
    record.material = material_of_phase(medium.phase, records, first_material);
    record.interior = medium.of_material ? 1 : 0;
    if (entry.interior != nullptr && entry.interior->by_colour)
      record.albedo_curve = half_space_curve(medium.phase[0].g, curves, records.curves);
    record.emission = to_vec3(medium.emission);
    record.emission_by_density = medium.emits() && medium.density && medium.emission_by_density ? 1 : 0;
    const std::optional<GridVolume> emission = emission_grid(medium);
    for (const auto& [grid, index] :
         {std::pair(&medium.density, &record.density), std::pair(&medium.albedo_grid, &record.albedo_grid),
          std::pair(&emission, &record.emission_grid)}) {
      if (!*grid) continue;
      const Expected<int> added = volumes.add(**grid, records);
      if (!added) return fail(fmt::format("{}: {}", medium.name, added.error().message));
      *index = *added;
    }
    records.media.push_back(record);
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].interior == nullptr || !entries_[i].interior->walks) continue;
    if (exit < 0) {
      exit = int(records.materials.size());
      records.materials.push_back(
          material_of(DiffuseTransmitterBsdf{.transmittance = TexturedColour(glm::vec3(1.0f))}));
    }
    records.media[i + 1].exit = exit;
  }
  records.boundaries = std::move(boundaries_);
  return {};
}

}  // namespace penumbra
