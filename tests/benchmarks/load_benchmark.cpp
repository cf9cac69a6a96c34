// Cost of loading a scene with one large mesh, stage by stage: CPU time, wall time, resident memory
// afterwards, and its peak. The mesh is a bumpy ball in a temporary binary PLY file, and a smaller one in
// ASCII.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <thread>

#include "scenes/device/device_scene_builder.h"
#include "scenes/device/hierarchy/bvh_builder.h"
#include "scenes/file_access.h"
#include "scenes/mesh_reader.h"
#include "scenes/mesh_tools.h"
#include "scenes/scene_reader.h"
#include "tests/benchmarks/bumpy_room.h"
#include "tests/benchmarks/load_stages.h"
#include "tests/support/temporary_folder.h"
#include "worker/embree_tracer.h"

namespace penumbra {
namespace {

/// Of about so many triangles, as a file of single precision; returns how many it has.
std::size_t write_ball(const std::filesystem::path& path, int triangles, bool ascii) {
  const SceneDescription room = bumpy_room(triangles);
  const Mesh& mesh = std::get<Mesh>(room.shapes[1].geometry);
  std::ofstream out(path, std::ios::binary);
  out << "ply\nformat " << (ascii ? "ascii" : "binary_little_endian") << " 1.0\nelement vertex "
      << mesh.positions.size() << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto bytes = [&](const auto& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const glm::dvec3& p : mesh.positions) {
    if (ascii)
      out << fmt::format("{} {} {}\n", float(p.x), float(p.y), float(p.z));
    else
      bytes(glm::vec3(p));
  }
  for (const glm::uvec3& t : mesh.triangles) {
    if (ascii) {
      out << fmt::format("3 {} {} {}\n", t.x, t.y, t.z);
    } else {
      out.put(3);
      bytes(t);
    }
  }
  return mesh.triangles.size();
}

void read_mesh(const std::filesystem::path& path, double triangles, const std::string& name) {
  std::unique_ptr<SourceFile> file;
  MeshFile mesh;
  show_stage(name + ": file", triangles,
             [&] { file = value_or_exit(FileAccess(std::nullopt).read(path, kMaxMeshFileBytes)); });
  const double seconds =
      show_stage(name + ": mesh", triangles, [&] { mesh = value_or_exit(read_ply(*file)); });
  const double megabytes = double(file->text.size()) / 1e6;
  fmt::print("  {:.0f} MB, {:.0f} MB/s a core\n", megabytes, megabytes / seconds);
  file.reset();
  show_stage(name + ": normals", triangles,
             [&] { value_or_exit(place_mesh(mesh.mesh, glm::dmat4(1.0), false)); });
}

void load_scene(const std::filesystem::path& file, double triangles, IntersectorChoice intersector) {
  SceneDescription description;
  DeviceScene built, shipped;
  std::vector<std::uint8_t> bytes;
  show_stage("scene", triangles, [&] { description = value_or_exit(read_scene(file, {})); });
  show_stage("device scene", triangles,
             [&] { built = value_or_exit(build_device_scene(description, {.intersector = intersector})); });
  description = {};
  fmt::print("  {:.1f} bytes a triangle in tables\n", double(built.words.size()) * 4 / triangles);
  show_stage("serialised", triangles, [&] { bytes = built.serialize(); });
  built = {};
  show_stage("deserialised and checked", triangles,
             [&] { shipped = value_or_exit(DeviceScene::deserialize(bytes)); });
  std::vector<std::uint8_t>().swap(bytes);
  if (intersector == IntersectorChoice::kPortable) {
    const auto* of =
        reinterpret_cast<const Triangle*>(shipped.words.data() + shipped.header.tables.triangles.offset);
    const std::span<const Triangle> all(of, std::size_t(shipped.header.tables.triangles.count));
    show_stage("hierarchy alone", triangles, [&] { value_or_exit(build_hierarchy(all, {})); });
    return;
  }
  std::unique_ptr<EmbreeTracer> tracer;
  show_stage("Embree's hierarchy", triangles, [&] {
    tracer =
        value_or_exit(EmbreeTracer::make(shipped, {.threads = int(std::thread::hardware_concurrency())}));
  });
}

}  // namespace
}  // namespace penumbra

// load_benchmark [TRIANGLES [TRIANGLES_IN_ASCII]]
int main(int argc, char** argv) {
  using namespace penumbra;
  const int triangles = argc > 1 ? std::atoi(argv[1]) : 10'000'000;
  const int in_ascii = argc > 2 ? std::atoi(argv[2]) : 1'000'000;
  const TemporaryFolder folder;
  const auto count = double(write_ball(folder / "ball.ply", triangles, false));
  const auto ascii_count = double(write_ball(folder / "ascii.ply", in_ascii, true));
  write_text(folder / "scene.xml", R"(<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective"><transform name="to_world">
      <lookat origin="0, 0.5, -2" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
    <emitter type="constant"/>
    <shape type="ply"><string name="filename" value="ball.ply"/></shape></scene>)");
  print_stage_heading("triangle");
  read_mesh(folder / "ball.ply", count, "binary");
  read_mesh(folder / "ascii.ply", ascii_count, "ASCII");
  for (const IntersectorChoice intersector : {IntersectorChoice::kEmbree, IntersectorChoice::kPortable})
    load_scene(folder / "scene.xml", count, intersector);
}
