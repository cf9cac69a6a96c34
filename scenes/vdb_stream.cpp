#include "scenes/vdb_stream.h"

#include <cstring>
#include <stdexcept>

namespace penumbra {
namespace {

// Of OpenVDB's openvdb/version.h.in: the first versions with the name of a grid that another one shares its
// tree with, and with a grid's own kind of compression.
constexpr std::uint32_t kInstancing = 216, kCompressionOfGrids = 222;

/// Takes values from the front of bytes.
class Front {
 public:
  explicit Front(std::string_view bytes) : left_(bytes) {}

  std::uint32_t number() {
    std::uint32_t value;
    const std::string_view bytes = take(sizeof value);
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  /// A text or a value of metadata: its length and so many bytes.
  void sized() { take(number()); }
  std::string_view take(std::size_t count) {
    if (count > left_.size()) throw std::runtime_error("the file ends early, or a length in it is damaged");
    const std::string_view taken = left_.substr(0, count);
    left_.remove_prefix(count);
    return taken;
  }
  void metadata() {
    const std::uint32_t count = number();
    for (std::uint32_t i = 0; i < count; ++i)
      for (int part = 0; part < 3; ++part) sized();  // name, type, value
  }
  [[nodiscard]] std::string_view left() const { return left_; }

 private:
  std::string_view left_;
};

}  // namespace

VdbStream::VdbStream(std::string_view bytes) : std::istream(nullptr) {
  // A get area is of char*, but nothing is put back into it.
  char* first = const_cast<char*>(bytes.data());
  setg(first, first, first + bytes.size());
  std::istream::rdbuf(static_cast<std::streambuf*>(this));
  exceptions(std::ios_base::badbit | std::ios_base::failbit | std::ios_base::eofbit);
}

std::string_view VdbStream::left() const { return {gptr(), egptr()}; }

VdbStream::pos_type VdbStream::seekoff(off_type offset, std::ios_base::seekdir from,
                                       std::ios_base::openmode) {
  const off_type start = from == std::ios_base::beg   ? 0
                         : from == std::ios_base::cur ? gptr() - eback()
                                                      : egptr() - eback();
  const off_type size = egptr() - eback();
  if (offset < -start || offset > size - start) return pos_type(off_type(-1));
  setg(eback(), eback() + start + offset, egptr());
  return start + offset;
}

VdbStream::pos_type VdbStream::seekpos(pos_type position, std::ios_base::openmode which) {
  return seekoff(off_type(position), std::ios_base::beg, which);
}

std::string_view check_vdb_metadata(std::string_view bytes) {
  Front front(bytes);
  front.metadata();
  return front.left();
}

void check_vdb_grid(std::string_view bytes, std::uint32_t version) {
  Front front(bytes);
  front.sized();                              // name
  front.sized();                              // type
  if (version >= kInstancing) front.sized();  // name of the grid whose tree it shares
  front.take(3 * sizeof(std::uint64_t));      // positions in the file
  if (version >= kCompressionOfGrids) front.number();
  front.metadata();
  front.sized();  // type of the transform
}

}  // namespace penumbra
