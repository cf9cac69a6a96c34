// The instruction sets that native kernels are compiled for.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace penumbra {

enum class Isa { kSse2, kAvx2, kAvx512 };  ///< from the narrowest to the widest

constexpr std::array<Isa, 3> kIsas{Isa::kSse2, Isa::kAvx2, Isa::kAvx512};
constexpr std::array<std::string_view, 3> kIsaNames{"sse2", "avx2", "avx512"};
constexpr std::string_view isa_name(Isa isa) { return kIsaNames[std::size_t(isa)]; }

}  // namespace penumbra
