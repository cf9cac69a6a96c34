#include "scenes/device/hierarchy/binary_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace penumbra {
namespace {

/// Where the sorted parts are cut in two at the least cost, the number of parts times the surface about them.
std::size_t best_cut(std::span<const TreePart> parts) {
  std::vector<double> above(parts.size());
  Box box;
  for (std::size_t i = parts.size(); i-- > 1;) {
    box.include(parts[i].box);
    above[i] = half_area(box) * double(parts.size() - i);
  }
  box = Box();
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 1;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    box.include(parts[i - 1].box);
    const double cost = half_area(box) * double(i) + above[i];
    if (cost >= least) continue;
    least = cost;
    best = i;
  }
  return best;
}

int longest_axis(const Box& box) {
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (box.high[axis] - box.low[axis] > box.high[longest] - box.low[longest]) longest = axis;
  return longest;
}

void sort_along(std::span<TreePart> parts, int axis) {
  std::ranges::sort(parts, {}, [axis](const TreePart& part) {
    return std::pair(double(part.box.low[axis]) + double(part.box.high[axis]), part.primitive);
  });
}

}  // namespace

int BinaryTree::add_node(const Box& box, int parent) {
  const int node = int(nodes.size());
  nodes.push_back({.box = box});
  if (parent >= 0) (*this)[parent].child[(*this)[parent].child[0] < 0 ? 0 : 1] = node;
  return node;
}

void BinaryTree::add_parts(std::span<TreePart> parts, int parent) {
  Box box;
  for (const TreePart& part : parts) box.include(part.box);
  const int node = add_node(box, parent);
  if (parts.size() == 1) {
    (*this)[node].primitive = parts.front().primitive;
    return;
  }
  sort_along(parts, longest_axis(box));
  const std::size_t cut = best_cut(parts);
  add_parts(parts.first(cut), node);
  add_parts(parts.subspan(cut), node);
}

}  // namespace penumbra
