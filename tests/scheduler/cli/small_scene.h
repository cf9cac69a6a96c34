// A scene that renders in a fraction of a second: a grey floor below a square area light, 24 x 20 pixels.
#pragma once

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace penumbra {

inline void write_small_scene(const std::filesystem::path& path) {
  write_text(path, R"(<scene version="3.0.0">
  <default name="albedo" value="0.5"/>
  <default name="spp" value="8"/>
  <integrator type="path"/>
  <sensor type="perspective">
    <float name="fov" value="60"/>
    <transform name="to_world">
      <lookat origin="0, 2, -4" target="0, 0.5, 0" up="0, 1, 0"/>
    </transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm">
      <integer name="width" value="24"/>
      <integer name="height" value="20"/>
      <rfilter type="box"/>
    </film>
  </sensor>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="$albedo"/></bsdf>
  </shape>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="90"/><translate y="2"/></transform>
    <emitter type="area"><rgb name="radiance" value="4, 3, 2"/></emitter>
  </shape>
</scene>
)");
}

}  // namespace penumbra
