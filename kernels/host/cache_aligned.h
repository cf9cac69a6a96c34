// Vectors whose memory starts at a cache line, so that registers loaded from a table or a block never span
// two lines. The largest tables use large pages where the system has them: touching these first costs half as
// much.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <vector>

namespace penumbra {

constexpr std::size_t kCacheLine = 64;

constexpr std::size_t kLargePage = std::size_t{2} << 20;

inline std::align_val_t alignment_of(std::size_t bytes) {
  return std::align_val_t(bytes >= 4 * kLargePage ? kLargePage : kCacheLine);
}

template <typename T>
struct CacheAligned {
  using value_type = T;
  CacheAligned() = default;
  template <typename U>
  CacheAligned(const CacheAligned<U>&) {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    void* memory = ::operator new(bytes, alignment_of(bytes));
#ifdef MADV_HUGEPAGE
    if (alignment_of(bytes) == std::align_val_t(kLargePage)) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    ::operator delete(memory, alignment_of(count * sizeof(T)));
  }
  bool operator==(const CacheAligned&) const = default;
};

template <typename T>
using AlignedVector = std::vector<T, CacheAligned<T>>;

}  // namespace penumbra
