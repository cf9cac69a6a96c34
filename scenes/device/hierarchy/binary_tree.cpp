#include "scenes/device/hierarchy/binary_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace penumbra {
namespace {

Box joined(Box a, const Box& b) {
  a.include(b);
  return a;
}

/// The largest number of candidates visited for a new position; some hundred are usual. It limits the time if
/// many boxes overlap.
constexpr int kMostVisits = 2000;
/// Smaller gains may be rounding errors.
constexpr double kLeastGain = 1e-6;

class SubtreeMover {
 public:
  SubtreeMover(BinaryTree& tree, std::span<const char> is_leaf) : tree_(tree), is_leaf_(is_leaf) {}

  /// Returns the number of subtrees moved.
  std::size_t pass(double share) {
    std::size_t moved = 0;
    for (const int node : largest(share)) {
      const int place = best_place(node);
      if (place < 0) continue;
      move(node, place);
      ++moved;
    }
    return moved;
  }

 private:
  [[nodiscard]] bool has_children(int node) const { return is_leaf_[std::size_t(node)] == 0; }
  [[nodiscard]] int sibling(int node) const {
    const BinaryTree::Node& parent = tree_[tree_[node].parent];
    return parent.child[parent.child[0] == node ? 1 : 0];
  }

  /// The nodes with the largest boxes, `share` of all, except those in the smallest trees; the largest first.
  std::vector<int> largest(double share) {
    constexpr std::size_t kSome = 4;
    std::vector<std::pair<double, int>> nodes;
    std::vector<int> left = {0};
    while (!left.empty()) {
      const int node = left.back();
      left.pop_back();
      nodes.emplace_back(-half_area(tree_[node].box), node);
      if (has_children(node)) left.insert(left.end(), {tree_[node].child[0], tree_[node].child[1]});
    }
    const std::size_t count =
        std::min(nodes.size(), std::max(kSome, std::size_t(share * double(nodes.size()))));
    std::partial_sort(nodes.begin(), nodes.begin() + std::ptrdiff_t(count), nodes.end());
    std::vector<int> first;
    for (std::size_t i = 0; i < count; ++i) first.push_back(nodes[i].second);
    return first;
  }

  /// The node beside which the subtree saves most, or -1 if no move saves anything. Removing it removes its
  /// parent, and the boxes above shrink; `saved` accumulates that on the way up. Inserting it enlarges the
  /// boxes above the new position.
  int best_place(int moving) {
    if (tree_[moving].parent <= 0) return -1;  // nothing is above its parent
    const Box box = tree_[moving].box;
    const double own = half_area(box);
    const int beside = sibling(moving);
    int pivot = tree_[moving].parent, best = -1, visits = 0;
    double saved = half_area(tree_[pivot].box), best_gain = kLeastGain * own;
    Box shrunk = tree_[beside].box;  // box of the pivot without the moved subtree
    for (int from = beside;;) {
      places_.assign(1, {0.0, from});
      while (!places_.empty() && visits < kMostVisits) {
        const auto [grown, place] = places_.back();
        places_.pop_back();
        if (saved - grown - own <= best_gain) continue;
        ++visits;
        const double with = half_area(joined(tree_[place].box, box));
        if (place != beside && saved - grown - with > best_gain) {
          best_gain = saved - grown - with;
          best = place;
        }
        const double grown_below = grown + with - half_area(tree_[place].box);
        if (has_children(place) && saved - grown_below - own > best_gain)
          for (const int child : tree_[place].child) places_.emplace_back(grown_below, child);
      }
      if (pivot == 0) return best;
      if (pivot != tree_[moving].parent) saved += half_area(tree_[pivot].box) - half_area(shrunk);
      from = sibling(pivot);
      shrunk.include(tree_[from].box);
      pivot = tree_[pivot].parent;
    }
  }

  /// The parent node moves together with the subtree.
  void move(int moving, int place) {
    const int parent = tree_[moving].parent, beside = sibling(moving), above = tree_[parent].parent;
    replace_child(above, parent, beside);
    replace_child(tree_[place].parent, place, parent);
    tree_[parent].child[0] = moving;
    tree_[parent].child[1] = place;
    tree_[place].parent = parent;
    fit(above);
    fit(parent);
  }
  void replace_child(int parent, int child, int by) {
    BinaryTree::Node& node = tree_[parent];
    node.child[node.child[0] == child ? 0 : 1] = by;
    tree_[by].parent = parent;
  }
  /// Recomputes the boxes from that node up to the root.
  void fit(int node) {
    for (; node >= 0; node = tree_[node].parent)
      tree_[node].box = joined(tree_[tree_[node].child[0]].box, tree_[tree_[node].child[1]].box);
  }

  BinaryTree& tree_;
  std::span<const char> is_leaf_;
  std::vector<std::pair<double, int>> places_;  // candidates with the growth of the boxes above them
};

/// The position at which to split the sorted parts with the least cost: number of parts times surface area,
/// summed over both sides.
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

std::vector<char> BinaryTree::is_part() const {
  std::vector<char> is_part;
  is_part.reserve(nodes.size());
  for (const Node& node : nodes) is_part.push_back(node.is_inner() ? 0 : 1);
  return is_part;
}

int BinaryTree::add_node(const Box& box, int parent) {
  const int node = int(nodes.size());
  nodes.push_back({.box = box, .parent = parent});
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

void move_subtrees(BinaryTree& tree, std::span<const char> is_leaf, double share, int passes) {
  SubtreeMover mover(tree, is_leaf);
  for (int i = 0; i < passes; ++i)
    if (mover.pass(share) == 0) return;
}

}  // namespace penumbra
