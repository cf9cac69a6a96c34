// A diffuse floor that light reaches only through the glass around a small lamp, 96 x 80 pixels.
#pragma once

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace penumbra {

inline void write_caustic_scene(const std::filesystem::path& path) {
  write_text(path, R"(<scene version="3.0.0">
  <default name="spp" value="8"/>
  <integrator type="path"><integer name="max_depth" value="10"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="60"/>
    <transform name="to_world">
      <lookat origin="0, 3, -4" target="0, 0.5, 0" up="0, 1, 0"/>
    </transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm">
      <integer name="width" value="96"/>
      <integer name="height" value="80"/>
      <rfilter type="box"/>
    </film>
  </sensor>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.6"/></bsdf>
  </shape>
  <shape type="sphere">
    <point name="center" x="0" y="1.5" z="0"/><float name="radius" value="0.5"/>
    <bsdf type="dielectric"/>
  </shape>
  <shape type="sphere">
    <point name="center" x="0.1" y="1.5" z="0"/><float name="radius" value="0.03"/>
    <emitter type="area"><rgb name="radiance" value="2000"/></emitter>
  </shape>
</scene>
)");
}

}  // namespace penumbra
