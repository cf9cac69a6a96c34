// The images of all sample scenes, by hash, against tests/acceptance/film_hashes.json: every compiler,
// machine, instruction set and OpenCL device must give the recorded bits, with every integrator, sampler and
// filter. If a change is meant to change images, update the record and review what changed in it:
//    PENUMBRA_UPDATE_RECORD=1 build/release/bit_identity_test --gtest_filter='*FilmHash*'
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <fcntl.h>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "kernels/host/kernel_needs.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/settings.h"
#include "tests/acceptance/film_record.h"
#include "tests/acceptance/suite_scenes.h"
#include "tests/support/oracles.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using Settings = std::vector<std::string>;  // name=value, as for --set

constexpr const char* kHowToUpdate =
    "; where images are meant to change: PENUMBRA_UPDATE_RECORD=1 build/release/bit_identity_test "
    "--gtest_filter='*FilmHash*', then look at the difference of tests/acceptance/film_hashes.json";

constexpr int kWidth = 20, kHeight = 15;
const std::vector<Settings> kIntegrators{
    {"integrator.type=path_mats"},
    {"integrator.type=path_ems", "integrator.mis=power"},
    {"integrator.type=path_mis"},
    {"integrator.type=path", "integrator.nee=cv"},
    {"integrator.type=direct"},
    {"integrator.type=direct", "integrator.bsdf_sampling=uniform", "integrator.mis=power"},
    {"integrator.type=direct", "integrator.emitter_sampling=projected", "integrator.bsdf_samples=0"},
    {"integrator.type=polygon_analytic"},
    {"integrator.type=polygon_area", "integrator.emitter_samples=2"},
    {"integrator.type=polygon_cv"},
    {"integrator.type=whitted"},
    {"integrator.type=whitted", "integrator.indirect_samples=2", "integrator.branch_depth=2",
     "integrator.indirect_sampling=uniform", "integrator.nee=cv"},
    {"integrator.type=ao", "integrator.vis_samples=2"},
    {"integrator.type=ro"},
};
const std::vector<std::string> kSamplers{"independent", "stratified", "halton", "sobol"};
const std::vector<std::string> kFilters{"box", "tent", "gaussian", "mitchell"};
/// With every sampler and filter too: diffuse and glossy, triangles and spheres.
const std::vector<std::string> kThorough{"cornell-small/cornell-small.xml", "veach-mis/veach-mis.xml",
                                         "star-light/star-light.xml"};

// Those kernels are the same whichever compiler made the tests: one of them asks.
#ifdef __clang__
constexpr bool kAsksOpenCl = true;
#else
constexpr bool kAsksOpenCl = false;
#endif
constexpr const char* kWithMedia = "smoke/smoke.xml";

/// One image: a scene and what is set in it.
struct FilmCase {
  std::string name;
  Settings settings;
};

std::vector<FilmCase> cases_of(const std::string& scene) {
  std::vector<Settings> all = kIntegrators;
  if (std::ranges::find(kThorough, scene) != kThorough.end()) {
    for (const char* integrator : {"path_mis", "direct", "polygon_cv"})
      for (const std::string& sampler : kSamplers)
        for (const std::string& filter : kFilters)
          all.push_back({std::string("integrator.type=") + integrator, "sampler.type=" + sampler,
                         "film.rfilter=" + filter});
  }
  if (scene == kWithMedia)
    for (const Settings& settings : {Settings{"integrator.type=volpath"},
                                     {"integrator.type=volpath_mats"},
                                     {"integrator.type=volpath", "integrator.nee=cv"}})
      all.push_back(settings);
  std::vector<FilmCase> cases;
  for (const Settings& settings : all) {
    FilmCase c{scene, settings};
    for (const std::string& setting : settings) c.name += " " + setting;
    cases.push_back(std::move(c));
  }
  return cases;
}

/// Every scene file of scenes/, and oracles; without their own folder, which is what the record names.
struct SceneFile {
  std::string name;
  bool is_oracle = false;
};

void PrintTo(const SceneFile& file, std::ostream* out) { *out << file.name; }

std::vector<SceneFile> scene_files() {
  std::vector<SceneFile> files;
  const fs::path folder = project_file("scenes");
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".xml") files.push_back({fs::relative(entry.path(), folder).string()});
  std::ranges::sort(files, {}, &SceneFile::name);
  for (const char* oracle : {"bitterli/cornell-box/scene.xml", "mitsuba/scenes/cbox/cbox-rgb.xml",
                             "tinyrender-a4/grid/tinyrender/grid_cv.toml",
                             "tinyrender-a4/mcgill/tinyrender/mcgill_cv_offline.toml"})
    files.push_back({oracle, true});
  return files;
}

/// The scene, small, with its settings; the reason where the integrator refuses it.
Expected<DeviceScene> build(SceneDescription scene, const FilmCase& film_case) {
  for (const std::string& setting : film_case.settings) {
    const std::size_t equals = setting.find('=');
    if (const auto set = apply_setting(scene, setting.substr(0, equals), setting.substr(equals + 1)); !set)
      throw std::runtime_error(set.error().message);
  }
  // Furnaces have no end.
  with_parameter(scene.integrator, PENUMBRA_PARAMETER(max_depth), [](int& depth) {
    if (depth < 0) depth = 8;
  });
  resize_film(scene, kWidth, kHeight);
  scene.sampler.spp = 4;
  return build_device_scene(scene, {.intersector = IntersectorChoice::kPortable});
}

/// By one kernel for everything, so that hundreds of scenes compile two of them (feature_mask_test.cpp shows
/// that this is no other image).
FilmAccumulator render_with_opencl(const DeviceScene& scene) {
  DeviceScene all = scene;
  // The planes of denoising would be between the others, and images have no layers on demand.
  all.header.features = (FEATURE_ALL & ~(FEATURE_BVH | FEATURE_DENOISING | LAYERS_ON_DEMAND)) |
                        (scene.header.features & FEATURE_BVH);
  all.header.families = kEveryFamily;
  all.header.light_kinds = ALL_LIGHT_KINDS;
  const auto device = make_device(all, opencl_device().options);
  if (!device) throw std::runtime_error(device.error().message);
  const SceneHeader& h = scene.header;
  auto result = (*device)->render(
      {.width = h.film.width, .height = h.film.height, .first_sample = 0, .sample_count = h.sampler.spp});
  if (!result) throw std::runtime_error(result.error().message);
  result->planes = plane_count(h.features);
  result->values.resize(std::size_t(result->planes) * result->pixels());
  FilmAccumulator film(0, 0, h.film.width, h.film.height, FilmLayers(h.features));
  film.add(0, 0, *result);
  return film;
}

fs::path record_path() { return project_file("tests/acceptance/film_hashes.json"); }

/// The names of the record that are of one scene.
std::vector<std::string> names_of(const FilmRecord& record, const std::string& scene) {
  std::vector<std::string> names;
  for (const auto& [name, film] : record)
    if (name.starts_with(scene + " ")) names.push_back(name);
  return names;
}

/// Replaces what the record says of the scene; tests in other processes may do the same at the same time.
void update_record(const std::string& scene, const FilmRecord& now) {
  const int lock = open(record_path().parent_path().c_str(), O_RDONLY | O_CLOEXEC);
  flock(lock, LOCK_EX);
  FilmRecord record = read_film_record(record_path());
  for (const std::string& name : names_of(record, scene)) record.erase(name);
  record.insert(now.begin(), now.end());
  write_film_record(record_path(), record);
  ::close(lock);
}

class FilmHash : public testing::TestWithParam<SceneFile> {};

TEST_P(FilmHash, IsThatOfTheRecordFromEveryBackend) {
  const SceneFile& file = GetParam();
  if (file.is_oracle) PENUMBRA_NEED_ORACLE(file.name);
  const bool update = std::getenv("PENUMBRA_UPDATE_RECORD") != nullptr;
  const FilmRecord expected = read_film_record(record_path());
  const SceneDescription description =
      read_or_throw(file.is_oracle ? *find_oracle("") / file.name : project_file("scenes/" + file.name));
  FilmRecord found;
  for (const FilmCase& c : cases_of(file.name)) {
    const Expected<DeviceScene> scene = build(description, c);
    if (!scene) {
      found[c.name].hash = "refused";
      continue;
    }
    TestDevice device = native_device();
    device.options.threads = 1;
    FilmRecord by_backend;
    for (const Isa isa : usable_isas()) {
      device.options.isa = isa;
      by_backend[std::string(isa_name(isa))] = record_film(render_or_throw(*scene, device));
    }
    device.options.block_of_one = true;
    by_backend["one pixel at a time"] = record_film(render_or_throw(*scene, device));
    if (kAsksOpenCl) by_backend["OpenCL"] = record_film(render_with_opencl(*scene));
    const RecordedFilm& film = found[c.name] = by_backend.at("one pixel at a time");
    for (const auto& [backend, other] : by_backend)
      EXPECT_EQ(other.hash, film.hash) << c.name << ": " << backend << " differs from one pixel at a time: "
                                       << difference_text(other.picture, film.picture, kWidth, kHeight);
  }
  if (update) update_record(file.name, found);
  for (const auto& [name, film] : found) {
    const auto entry = update ? found.find(name) : expected.find(name);
    if (entry == (update ? found.end() : expected.end())) {
      ADD_FAILURE() << name << " is not in the record" << kHowToUpdate;
    } else {
      EXPECT_EQ(film.hash, entry->second.hash)
          << name << " is another image than in the record: "
          << difference_text(film.picture, entry->second.picture, kWidth, kHeight) << kHowToUpdate;
    }
  }
  for (const std::string& name : names_of(update ? found : expected, file.name))
    EXPECT_TRUE(found.contains(name)) << name << " is in the record but no longer rendered" << kHowToUpdate;
}

INSTANTIATE_TEST_SUITE_P(Scenes, FilmHash, testing::ValuesIn(scene_files()), [](const auto& tested) {
  std::string name = tested.param.name;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

TEST(FilmHashRecord, NamesNoSceneThatIsGone) {
  std::vector<std::string> known;
  for (const SceneFile& file : scene_files()) known.push_back(file.name);
  const bool update = std::getenv("PENUMBRA_UPDATE_RECORD") != nullptr;
  std::set<std::string> gone;
  for (const auto& [name, film] : read_film_record(record_path())) {
    const std::string scene = name.substr(0, name.find(' '));
    if (std::ranges::find(known, scene) == known.end()) gone.insert(scene);
  }
  for (const std::string& scene : gone) {
    if (update) {
      update_record(scene, {});
    } else {
      ADD_FAILURE() << scene << kHowToUpdate;
    }
  }
}

}  // namespace
}  // namespace penumbra
