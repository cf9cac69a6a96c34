#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "tests/scenes/census/census.h"
#include "tests/scenes/census/items.h"
#include "tests/scenes/ply_writer.h"

namespace penumbra::census {
namespace {

constexpr int kSquare[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/// A square of corners, and faces of each form over them.
std::string obj_text(const Item& file) {
  std::string before, faces, after;
  const auto late = [&](const std::string& list) {
    for (const Item& each : file.inside)
      if (each.tag == "late" && each.type == list) return true;
    return false;
  };
  for (const Item& fact : file.inside) {
    if (fact.tag == "statement") {
      before += fact.type + " 1\n";
    } else if (fact.tag == "f" || fact.tag == "negative") {
      const int corners = fact.type == "short" ? 2 : fact.type == "triangle" ? 3 : 4;
      faces += "f";
      for (int corner = 1; corner <= corners; ++corner) {
        faces += ' ';
        for (const char c : fact.name)
          faces += c != 'i' ? std::string(1, c) : std::to_string(fact.tag == "f" ? corner : corner - 5);
      }
      faces += '\n';
    } else if (fact.tag.empty()) {
      std::string& text = late(fact.type) ? after : before;
      for (const auto& corner : kSquare) {
        text += fmt::format("{} {}", fact.type, corner[0]);
        for (int i = 1; i < std::stoi(fact.name); ++i) text += fmt::format(" {}", i == 1 ? corner[1] : 1);
        text += '\n';
      }
    }
  }
  return before + faces + after;
}

void put(PlyWriter& ply, const std::string& type, int value) {
  if (type == "char") return ply.put(std::int8_t(value));
  if (type == "uchar") return ply.put(std::uint8_t(value));
  if (type == "short") return ply.put(std::int16_t(value));
  if (type == "ushort") return ply.put(std::uint16_t(value));
  if (type == "int") return ply.put(std::int32_t(value));
  if (type == "uint") return ply.put(std::uint32_t(value));
  if (type == "float") return ply.put(float(value));
  EXPECT_EQ(type, "double");
  ply.put(double(value));
}

std::string ply_text(const std::vector<Item>& items) {
  const Item& file = items.front();
  const auto encoding = file.type == "ascii"                  ? PlyEncoding::kAscii
                        : file.type == "binary_little_endian" ? PlyEncoding::kLittleEndian
                                                              : PlyEncoding::kBigEndian;
  PlyWriter ply(encoding);
  std::string header;
  for (std::size_t i = 1; i < items.size(); ++i) {
    const Item& element = items[i];
    const int count = element.type == "vertex" ? 4 : 1;
    header += fmt::format("element {} {}\n", element.type, count);
    for (const Item& property : element.inside) {
      std::string type = property.tag;
      for (char& c : type)
        if (c == '-') c = ' ';
      header += fmt::format("property {} {}\n", type, property.type);
    }
    for (int number = 0; number < count; ++number) {
      for (const Item& property : element.inside) {
        if (!property.tag.starts_with("list-")) {
          const bool is_place = property.type == "x" || property.type == "y";
          put(ply, property.tag, is_place ? kSquare[number][property.type == "y" ? 1 : 0] : 1);
          continue;
        }
        const std::size_t dash = property.tag.rfind('-');
        put(ply, property.tag.substr(5, dash - 5), 3);
        for (int corner = 0; corner < 3; ++corner) put(ply, property.tag.substr(dash + 1), corner);
      }
      ply.end_element();
    }
  }
  std::string text = ply.file(header);
  const bool returns = !file.inside.empty();
  const std::string end = returns && file.inside.front().type == "cr" ? "\r" : "\r\n";
  std::size_t header_end = text.find("end_header\n") + 11;
  for (std::size_t at = 0; returns && (at = text.find('\n', at)) < header_end; at += end.size()) {
    text.replace(at, 1, end);
    header_end += end.size() - 1;
  }
  return text;
}

}  // namespace

std::string mesh_text(const Row& row) {
  const std::vector<Item> items = read_items(row.items);
  return row.version == "OBJ" ? obj_text(items.at(0)) : ply_text(items);
}

}  // namespace penumbra::census
