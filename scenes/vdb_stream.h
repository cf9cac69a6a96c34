// OpenVDB's own stream of a file in memory. What OpenVDB reads past the end of a file it takes from
// uninitialised memory, and it makes room for as many bytes as a damaged length asks for. Here both are
// errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <streambuf>
#include <string_view>

namespace penumbra {

/// Reading past the end throws std::ios_base::failure.
class VdbStream : private std::streambuf, public std::istream {
 public:
  explicit VdbStream(std::string_view bytes);

  /// Of the file's bytes, those from the next one on.
  [[nodiscard]] std::string_view left() const;

 private:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;
};

/// Throws std::runtime_error unless the lengths of all texts and values of a map of metadata at the front of
/// `bytes` are within them. Returns the bytes after the map.
std::string_view check_vdb_metadata(std::string_view bytes);

/// The same for all that precedes a grid's tree: its description, metadata and kind of transform. `version`
/// is the version of the file's format.
void check_vdb_grid(std::string_view bytes, std::uint32_t version);

}  // namespace penumbra
