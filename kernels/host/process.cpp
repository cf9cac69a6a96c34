#include "kernels/host/process.h"

#include <elf.h>
#include <link.h>

#include <algorithm>
#include <cstring>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>
#include <utility>

namespace penumbra {
namespace {

/// The identification of one program or library; see elf(5). Empty if it has none.
std::string build_id(const dl_phdr_info& object) {
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object.dlpi_phdr[i];
    if (segment.p_type != PT_NOTE) continue;
    const auto padded = [&](std::size_t size) {
      const std::size_t step = std::max<std::size_t>(segment.p_align, 4);
      return (size + step - 1) / step * step;
    };
    const std::string_view notes(reinterpret_cast<const char*>(object.dlpi_addr + segment.p_vaddr),
                                 segment.p_memsz);
    for (std::size_t at = 0; at + sizeof(ElfW(Nhdr)) <= notes.size();) {
      ElfW(Nhdr) note;
      std::memcpy(&note, notes.data() + at, sizeof note);
      const std::size_t name = at + sizeof note, content = name + padded(note.n_namesz);
      if (note.n_type == NT_GNU_BUILD_ID && notes.substr(name).starts_with(std::string_view("GNU\0", 4)))
        return std::string(notes.substr(content, note.n_descsz));
      at = content + padded(note.n_descsz);
    }
  }
  return {};
}

}  // namespace

std::string build_ids(std::initializer_list<std::string_view> libraries) {
  struct Search {
    std::initializer_list<std::string_view> libraries;
    std::string ids = {};
    bool is_program = true;  // the first object is
  } search{libraries};
  const auto visit = [](dl_phdr_info* object, std::size_t, void* data) {
    auto& found = *static_cast<Search*>(data);
    const std::string file = std::filesystem::path(object->dlpi_name).filename().string();
    const bool is_program = std::exchange(found.is_program, false);
    if (is_program ||
        std::ranges::any_of(found.libraries, [&](std::string_view name) { return file.starts_with(name); }))
      found.ids += build_id(*object);
    return int(is_program && found.ids.empty());  // 1 ends the search
  };
  dl_iterate_phdr(visit, &search);
  return search.ids;
}

std::uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    std::uint64_t kibibytes = 0;
    if (key == "VmHWM:") return status >> kibibytes ? kibibytes * 1024 : 0;
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace penumbra
