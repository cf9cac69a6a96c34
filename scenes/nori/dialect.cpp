#include "scenes/nori/dialect.h"

#include <fmt/format.h>

#include <set>

#include "scenes/names.h"

namespace penumbra::nori {
namespace {

/// A plugin that indicates a dialect, with a weight. A plugin that several forks of one dialect have and none
/// of the other outweighs those that forks have adopted from the other.
struct Mark {
  std::string_view tag, type;
  Dialect dialect;
  int weight;
};
constexpr Mark kMarks[] = {
    // Exercises of the original course.
    {"integrator", "whitted", Dialect::kNori, 2},
    {"integrator", "simple", Dialect::kNori, 2},
    {"integrator", "ao", Dialect::kNori, 2},
    {"integrator", "path_ems", Dialect::kNori, 2},
    {"integrator", "path_simple", Dialect::kNori, 1},
    // Courses that are based on it (Zaragoza's).
    {"emitter", "pointlight", Dialect::kNori, 3},
    {"texture", "textmap", Dialect::kNori, 3},
    {"texture", "checker", Dialect::kNori, 2},
    {"integrator", "direct_whitted", Dialect::kNori, 3},
    // ETH's.
    {"texture", "checkerboard_color", Dialect::kEth, 3},
    {"texture", "checkerboard_float", Dialect::kEth, 3},
    {"texture", "constant_color", Dialect::kEth, 3},
    {"texture", "constant_float", Dialect::kEth, 3},
    {"mesh", "sphere", Dialect::kEth, 2},
    {"shape", "sphere", Dialect::kEth, 2},
    {"emitter", "point", Dialect::kEth, 2},
    {"integrator", "av", Dialect::kEth, 2},
    {"integrator", "material", Dialect::kEth, 3},
    {"integrator", "direct", Dialect::kEth, 2},
    {"integrator", "direct_ems", Dialect::kEth, 1},
    {"integrator", "direct_mats", Dialect::kEth, 1},
    {"integrator", "direct_mis", Dialect::kEth, 1},
    {"integrator", "photonmapper", Dialect::kEth, 2},
};

struct Votes : pugi::xml_tree_walker {
  int weights[2] = {0, 0};
  const Mark* strongest[2] = {nullptr, nullptr};

  bool for_each(pugi::xml_node& node) override {
    const std::string_view tag = node.name();
    const std::string type = to_lower_case(node.attribute("type").value());
    for (const Mark& mark : kMarks) {
      if (mark.tag != tag || mark.type != type) continue;
      const int side = mark.dialect == Dialect::kEth ? 1 : 0;
      const Mark*& best = strongest[side];
      if (!seen_.insert(&mark).second) continue;  // each counts once
      weights[side] += mark.weight;
      if (best == nullptr || mark.weight > best->weight) best = &mark;
    }
    return true;
  }

 private:
  std::set<const Mark*> seen_;
};

}  // namespace

DialectChoice dialect_of(const pugi::xml_node& root) {
  Votes votes;
  pugi::xml_node start = root;
  start.traverse(votes);
  const int side = votes.weights[1] > votes.weights[0] ? 1 : 0;
  const Mark* mark = votes.strongest[side];
  if (mark == nullptr) return {Dialect::kNori, "nothing in it tells; --dialect nori-eth mirrors the camera"};
  return {mark->dialect, fmt::format("it has {} <{}> of type '{}'",
                                     mark->tag == "integrator" || mark->tag == "emitter" ? "an" : "a",
                                     mark->tag, mark->type)};
}

std::string describe(const DialectChoice& choice) {
  return fmt::format("{} ({})", dialects().print(choice.dialect), choice.reason);
}

}  // namespace penumbra::nori
