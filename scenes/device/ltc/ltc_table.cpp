#include "scenes/device/ltc/ltc_table.h"

#include <iterator>

namespace penumbra {
namespace {

constexpr LtcCell kCells[] = {
#include "scenes/device/ltc/ltc_table.inc"
};
static_assert(std::size(kCells) == 2 * LTC_SIZE * LTC_SIZE);

}  // namespace

std::vector<LtcCell> ltc_table() { return {std::begin(kCells), std::end(kCells)}; }

}  // namespace penumbra
