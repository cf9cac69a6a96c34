// Trees by Embree's builder, with a fixed instruction set: the same primitives always get the same tree,
// whatever the number of threads.
#pragma once

#include <memory>
#include <span>

#include "kernels/host/error.h"
#include "kernels/scene_types.h"
#include "scenes/device/hierarchy/binary_tree.h"
#include "scenes/device/hierarchy/wide_tree.h"

struct RTCDeviceTy;

namespace penumbra {

class EmbreeBuilder {
 public:
  static Expected<EmbreeBuilder> start(unsigned threads);

  /// Over the boxes of primitives, at least one, with so many in a leaf.
  [[nodiscard]] Expected<WideTree> wide_tree(std::span<const Box> boxes, int in_leaf) const;
  /// Over triangles, at least one, which are split where that pays, into up to half
  /// as many parts again: that takes three times as long, but bounced rays are 8 % (classroom) and 34 %
  /// (spaceship) faster.
  [[nodiscard]] Expected<BinaryTree> binary_tree(std::span<const Triangle> triangles) const;

 private:
  struct Release {
    void operator()(RTCDeviceTy* device) const;
  };
  explicit EmbreeBuilder(RTCDeviceTy* device) : device_(device) {}

  std::unique_ptr<RTCDeviceTy, Release> device_;
};

}  // namespace penumbra
