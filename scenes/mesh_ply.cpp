#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "scenes/mesh_reader.h"
#include "scenes/number.h"

namespace penumbra {
namespace {

constexpr std::size_t kMaxElements = 256;

enum class Format { kAscii, kLittleEndian, kBigEndian };
enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> count_type;  ///< type of the length of a list
  int field = -1;                  ///< the vertex field that it is; -1: ignored
  bool is_indices = false;         ///< whether it lists the vertices of faces
  bool is_tangents = false;        ///< whether it lists the tangents of faces' corners
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
  SourceLocation location;
};

std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[std::size_t(type)];
}

std::optional<Type> type_named(std::string_view name) {
  struct Name {
    std::string_view text;
    Type type;
  };
  static constexpr Name kNames[] = {
      {"char", Type::kInt8},     {"int8", Type::kInt8},     {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},   {"short", Type::kInt16},   {"int16", Type::kInt16},
      {"ushort", Type::kUint16}, {"uint16", Type::kUint16}, {"int", Type::kInt32},
      {"int32", Type::kInt32},   {"uint", Type::kUint32},   {"uint32", Type::kUint32},
      {"float", Type::kFloat},   {"float32", Type::kFloat}, {"double", Type::kDouble},
      {"float64", Type::kDouble}};
  for (const Name& each : kNames) {
    if (each.text == name) return each.type;
  }
  return std::nullopt;
}

/// The fields of a vertex. -1 means an ignored property.
enum PlyField : int { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kU, kV, kRed, kGreen, kBlue, kFields };
int field_named(std::string_view name) {
  static constexpr std::pair<std::string_view, int> kNames[] = {
      {"x", kX},        {"y", kY},         {"z", kZ},     {"nx", kNormalX},  {"ny", kNormalY},
      {"nz", kNormalZ}, {"u", kU},         {"s", kU},     {"texture_u", kU}, {"v", kV},
      {"t", kV},        {"texture_v", kV}, {"red", kRed}, {"green", kGreen}, {"blue", kBlue},
      {"r", kRed},      {"g", kGreen},     {"b", kBlue}};
  for (const auto& [text, field] : kNames) {
    if (text == name) return field;
  }
  return -1;
}

/// Determines the field of each property of an element. The properties of an attribute are its channels, one
/// or three of them.
void find_fields(std::vector<Property>& properties, bool is_vertex, std::string_view attribute) {
  std::vector<Property*> channels;
  const std::string_view stem =
      attribute.ends_with("_color") ? attribute.substr(0, attribute.size() - 6) : attribute;
  bool is_rgb = false;
  for (Property& each : properties) {
    if (each.count_type) continue;
    const int field = field_named(each.name);
    const bool is_colour = field >= kRed;
    if (is_vertex && !is_colour) each.field = field;
    if (is_colour && attribute == "color") each.field = field;
    is_rgb = is_rgb || (is_colour && attribute == "color");
    const std::size_t end = each.name.rfind('_');
    if (field >= 0 || end == std::string::npos) continue;
    const std::string_view name = std::string_view(each.name).substr(0, end),
                           ending = std::string_view(each.name).substr(end + 1);
    const bool of_colour =
        stem != attribute && name == stem && (ending == "r" || ending == "g" || ending == "b");
    if (of_colour || name == attribute) channels.push_back(&each);
  }
  if (is_rgb || (channels.size() != 1 && channels.size() != 3)) return;
  for (std::size_t i = 0; i < channels.size(); ++i) channels[i]->field = kRed + int(i);
}

/// Integers are sRGB-encoded with the largest as 1, as programs write them. Floats are linear, as in Mitsuba
/// 3.
double linear_colour(Type type, double value) {
  if (type == Type::kFloat || type == Type::kDouble) return value;
  const double x = std::clamp(value / (std::exp2(8.0 * double(size_of(type))) - 1.0), 0.0, 1.0);
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

class PlyReader {
 public:
  PlyReader(const SourceFile& file, const MeshAttributeNames& attributes)
      : file_(file), text_(file.text), attributes_(attributes) {}

  Expected<MeshFile> read() {
    if (auto done = header(); !done) return std::unexpected(done.error());
    for (Element& element : elements_) {
      const bool is_vertex = element.name == "vertex";
      if (is_vertex || element.name == "face")
        find_fields(element.properties, is_vertex, is_vertex ? attributes_.vertex : attributes_.face);
    }
    vertices_ = element_named("vertex")->count;
    reserve();
    for (const Element& element : elements_) {
      if (auto done = body(element); !done) return std::unexpected(done.error());
    }
    for (const EarlyFace& face : early_faces_) {
      if (auto done = finish_face(face.number, face.corners, face.colour, face.tangents); !done)
        return std::unexpected(done.error());
    }
    if (!mesh_.tangents.empty()) mesh_.tangents.resize(mesh_.triangles.size());
    MeshFile result{std::move(mesh_), std::move(faces_)};
    if (std::ranges::none_of(elements_, has_faces))
      result.warnings.emplace_back("the file has points without faces, which are not shown");
    return result;
  }

 private:
  std::unexpected<Error> wrong_at(std::size_t offset, std::string_view message) const {
    return fail(format_diagnostic({&file_, offset}, "error", message));
  }
  /// In a binary body a location is the number of an element, not a line.
  std::unexpected<Error> wrong(const Element& element, std::uint64_t number, std::string_view message) const {
    const std::string text = fmt::format("{} {}: {}", element.name, number, message);
    if (format_ == Format::kAscii) return wrong_at(token_start_, text);
    return fail(fmt::format("{}: error: {}", file_.path.string(), text));
  }

  std::string_view header_line() {
    line_start_ = at_;
    const std::size_t end = std::min(text_.find(line_end_, at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    return trim(line);
  }

  Expected<void> header() {
    if (text_.starts_with("ply\r") && !text_.starts_with("ply\r\n")) line_end_ = '\r';
    if (header_line() != "ply") return wrong_at(0, "a PLY file starts with the line 'ply'");
    bool has_format = false;
    for (;;) {
      if (at_ >= text_.size())
        return wrong_at(at_, "the file ends inside its header: there is no 'end_header'");
      const std::string_view line = header_line();
      if (line == "end_header") break;
      std::vector<std::string_view> words;
      for (std::size_t i = 0; i < line.size();) {
        const std::size_t end = std::min(line.find_first_of(" \t", i), line.size());
        if (end > i) words.push_back(line.substr(i, end - i));
        i = end + 1;
      }
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      Expected<void> done;
      if (words[0] == "format") {
        done = format(words);
        has_format = true;
      } else if (words[0] == "element") {
        done = element(words);
      } else if (words[0] == "property") {
        done = property(words);
      } else {
        const std::vector<std::string> known = {"format",  "element",  "property",
                                                "comment", "obj_info", "end_header"};
        done = wrong_at(line_start_, fmt::format("'{}' is not a line of a PLY header{}",
                                                 words[0].substr(0, 40), suggestion(words[0], known)));
      }
      if (!done) return done;
    }
    if (!has_format) return wrong_at(0, "the header has no 'format' line");
    return check_elements();
  }

  Expected<void> format(const std::vector<std::string_view>& words) {
    static constexpr std::pair<std::string_view, Format> kFormats[] = {
        {"ascii", Format::kAscii},
        {"binary_little_endian", Format::kLittleEndian},
        {"binary_big_endian", Format::kBigEndian}};
    for (const auto& [name, value] : kFormats) {
      if (words.size() == 3 && words[1] == name && words[2] == "1.0") {
        format_ = value;
        return {};
      }
    }
    return wrong_at(line_start_,
                    "a format is 'ascii', 'binary_little_endian' or 'binary_big_endian', and 1.0");
  }

  Expected<void> element(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return wrong_at(line_start_, "an element has a name and a count");
    const auto count = parse_integer(words[2], 0, std::numeric_limits<std::uint32_t>::max());
    if (!count) return wrong_at(line_start_, count.error().message);
    if (element_named(words[1]) != nullptr) {
      return wrong_at(line_start_, fmt::format("the element '{}' is there twice", words[1]));
    }
    if (elements_.size() >= kMaxElements)
      return wrong_at(line_start_, fmt::format("more than {} elements", kMaxElements));
    elements_.push_back({std::string(words[1]), std::uint64_t(*count), {}, {&file_, line_start_}});
    return {};
  }

  Expected<void> property(const std::vector<std::string_view>& words) {
    if (elements_.empty()) return wrong_at(line_start_, "a property must follow an element");
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) {
      return wrong_at(line_start_,
                      "a property is 'property TYPE NAME' or 'property list COUNT_TYPE TYPE NAME'");
    }
    Property result{std::string(words.back()), Type::kFloat, std::nullopt};
    const auto type = type_named(words[words.size() - 2]);
    if (list) result.count_type = type_named(words[2]);
    const bool count_ok = !list || (result.count_type && *result.count_type != Type::kFloat &&
                                    *result.count_type != Type::kDouble);
    if (!type || !count_ok) {
      return wrong_at(line_start_,
                      "a property's type is one of char, uchar, short, ushort, int, uint, float, double "
                      "(a list's count: an integer)");
    }
    result.type = *type;
    result.is_tangents = list && result.name == "tangents";
    result.is_indices = list && (result.name == "vertex_indices" || result.name == "vertex_index");
    elements_.back().properties.push_back(std::move(result));
    return {};
  }

  [[nodiscard]] const Element* element_named(std::string_view name) const {
    const auto found =
        std::find_if(elements_.begin(), elements_.end(), [&](const Element& e) { return e.name == name; });
    return found == elements_.end() ? nullptr : &*found;
  }

  /// Checks the elements' names, and that the rest of the file is long enough for the promised counts. Memory
  /// is not reserved before this check.
  Expected<void> check_elements() const {
    const Element* vertex = element_named("vertex");
    if (vertex == nullptr) return wrong_at(0, "the header must have the element vertex");
    std::array<bool, kFields> has{};
    for (const Property& each : vertex->properties) {
      const int field = field_named(each.name);
      if (field >= 0 && !each.count_type) has[std::size_t(field)] = true;
    }
    if (!has[kX] || !has[kY] || !has[kZ])
      return wrong_at(vertex->location.offset, "a vertex must have x, y and z");
    for (const Element& each : elements_) {
      if (has_faces(each) && std::ranges::none_of(each.properties, &Property::is_indices))
        return wrong_at(each.location.offset, "a face must have the list vertex_indices (or vertex_index)");
    }
    std::uint64_t least = 0;
    for (const Element& each : elements_) {
      std::uint64_t bytes = 0;
      for (const Property& p : each.properties) {
        bytes += format_ == Format::kAscii ? 2 : size_of(p.count_type.value_or(p.type));
      }
      least += each.count * bytes;
    }
    const std::uint64_t rest = text_.size() - at_ + 1;  // the last line of a text may lack its line end
    if (least > rest) {
      return wrong_at(
          at_, fmt::format("the file ends early: its header promises at least {} bytes more, {} are left",
                           least, text_.size() - at_));
    }
    return {};
  }

  /// Reserves memory for as many elements as the rest of the file can hold, so that large meshes are not
  /// moved as they grow.
  void reserve() {
    const Element& vertex = *element_named("vertex");
    const std::uint64_t rest = text_.size() - at_;
    const bool ascii = format_ == Format::kAscii;
    const auto most = [&](const Element& of) {
      std::uint64_t bytes = 0;
      for (const Property& p : of.properties) {
        bytes += ascii ? 2 : size_of(p.count_type.value_or(p.type));
        if (p.is_indices) bytes += 3 * (ascii ? 2 : size_of(p.type));
      }
      return std::size_t(std::min(of.count, rest / std::max<std::uint64_t>(bytes, 1)));
    };
    mesh_.positions.reserve(most(vertex));
    const auto has = [&](const Element& of, int first, int last) {
      int found = 0;
      for (const Property& p : of.properties) found += p.field >= first && p.field <= last ? 1 : 0;
      return found == last - first + 1;
    };
    if (has(vertex, kNormalX, kNormalZ)) mesh_.normals.reserve(most(vertex));
    if (has(vertex, kU, kV)) mesh_.texcoords.reserve(most(vertex));
    if (has(vertex, kRed, kBlue)) mesh_.colours.reserve(most(vertex));
    if (const Element* face = element_named("face"); face != nullptr) {
      mesh_.triangles.reserve(most(*face));
      if (has(*face, kRed, kBlue)) mesh_.face_colours.reserve(most(*face));
    }
  }

  static bool has_faces(const Element& e) { return e.name == "face" || e.name == "tristrips"; }

  /// The next value. Nothing at the end of the file, or if an ascii token is not a number.
  Expected<double> value(Type type, const Element& element, std::uint64_t number) {
    if (format_ == Format::kAscii) {
      while (at_ < text_.size() && std::strchr(" \t\r\n", text_[at_]) != nullptr && text_[at_] != '\0') ++at_;
      token_start_ = at_;
      while (at_ < text_.size() && (std::strchr(" \t\r\n", text_[at_]) == nullptr || text_[at_] == '\0'))
        ++at_;
      if (token_start_ == at_) return wrong(element, number, "the file ends early");
      const auto result = parse_number(text_.substr(token_start_, at_ - token_start_));
      if (!result) return wrong(element, number, result.error().message);
      return *result;
    }
    const std::size_t size = size_of(type);
    if (text_.size() - at_ < size) return wrong(element, number, "the file ends early");
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), text_.data() + at_, size);
    at_ += size;
    const bool host_is_little = std::endian::native == std::endian::little;
    if ((format_ == Format::kLittleEndian) != host_is_little)
      std::reverse(bytes.begin(), bytes.begin() + size);
    return decode(type, bytes);
  }

  template <typename T>
  static double load(const std::array<char, 8>& bytes) {
    T result;
    std::memcpy(&result, bytes.data(), sizeof(T));
    return static_cast<double>(result);
  }

  static double decode(Type type, const std::array<char, 8>& bytes) {
    switch (type) {
      case Type::kInt8:
        return load<std::int8_t>(bytes);
      case Type::kUint8:
        return load<std::uint8_t>(bytes);
      case Type::kInt16:
        return load<std::int16_t>(bytes);
      case Type::kUint16:
        return load<std::uint16_t>(bytes);
      case Type::kInt32:
        return load<std::int32_t>(bytes);
      case Type::kUint32:
        return load<std::uint32_t>(bytes);
      case Type::kFloat:
        return load<float>(bytes);
      case Type::kDouble:
        return load<double>(bytes);
    }
    return 0.0;
  }

  Expected<void> body(const Element& element) {
    if (element.properties.empty()) return {};  // an element without properties has no data
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    const bool is_strips = element.name == "tristrips";
    for (std::uint64_t number = 0; number < element.count; ++number) {
      std::array<double, kFields> fields{};
      std::array<bool, kFields> has{};
      polygon_.clear();
      tangents_.clear();
      for (const Property& property : element.properties) {
        const int field = property.field;
        const bool indices = (is_face || is_strips) && property.is_indices;
        std::uint64_t count = 1;
        if (property.count_type) {
          const auto length = value(*property.count_type, element, number);
          if (!length) return std::unexpected(length.error());
          if (*length < 0.0 || *length != std::floor(*length) || *length > double(text_.size())) {
            return wrong(element, number, fmt::format("{} cannot be the length of a list", *length));
          }
          count = std::uint64_t(*length);
        }
        for (std::uint64_t i = 0; i < count; ++i) {
          const auto item = value(property.type, element, number);
          if (!item) return std::unexpected(item.error());
          if (field >= 0) {
            if (!std::isfinite(*item)) {
              return wrong(element, number,
                           fmt::format("{} is {}, not a finite number", property.name, *item));
            }
            fields[std::size_t(field)] = field >= kRed ? linear_colour(property.type, *item) : *item;
            has[std::size_t(field)] = true;
          }
          if (indices) polygon_.push_back(*item);
          if (is_face && property.is_tangents) tangents_.push_back(float(*item));
        }
      }
      if (is_vertex) add_vertex(fields, has);
      if (is_face) {
        if (has[kRed] && !has[kGreen] && !has[kBlue]) spread_grey(fields, has);
        if (has[kRed] && has[kGreen] && has[kBlue])
          face_colour_ = {float(fields[kRed]), float(fields[kGreen]), float(fields[kBlue])};
        if (auto done = add_face(element, number); !done) return done;
      }
      if (is_strips) {
        if (auto done = add_strips(element, number); !done) return done;
      }
    }
    return {};
  }

  static void spread_grey(std::array<double, kFields>& f, std::array<bool, kFields>& has) {
    f[kGreen] = f[kBlue] = f[kRed];
    has[kGreen] = has[kBlue] = true;
  }

  void add_vertex(std::array<double, kFields>& f, std::array<bool, kFields>& has) {
    if (has[kRed] && !has[kGreen] && !has[kBlue]) spread_grey(f, has);
    mesh_.positions.push_back({f[kX], f[kY], f[kZ]});
    if (has[kNormalX] && has[kNormalY] && has[kNormalZ]) {
      mesh_.normals.push_back({float(f[kNormalX]), float(f[kNormalY]), float(f[kNormalZ])});
    }
    if (has[kRed] && has[kGreen] && has[kBlue])
      mesh_.colours.push_back({float(f[kRed]), float(f[kGreen]), float(f[kBlue])});
    if (has[kU] && has[kV]) mesh_.texcoords.push_back({float(f[kU]), float(f[kV])});
  }

  Expected<void> add_face(const Element& element, std::uint64_t number) {
    for (const double index : polygon_) {
      if (!(index >= 0.0) || index >= double(vertices_) || index != std::floor(index)) {
        return wrong(element, number,
                     fmt::format("vertex index {} is out of range: there are {} vertices, counted from 0",
                                 index, vertices_));
      }
    }
    corners_.assign(polygon_.begin(), polygon_.end());
    if (!tangents_.empty() && (tangents_.size() != 12 || corners_.size() != 3))
      return wrong(element, number, "tangents are four numbers for each corner of a triangle");
    if (!std::ranges::all_of(tangents_, [](float x) { return std::isfinite(x); }))
      return wrong(element, number, "a tangent is not finite");
    if (mesh_.positions.size() == vertices_) return finish_face(number, corners_, face_colour_, tangents_);
    early_faces_.push_back({number, corners_, face_colour_, tangents_});
    return {};
  }

  /// Strips of triangles one after another, each ended by -1; every other triangle is turned.
  Expected<void> add_strips(const Element& element, std::uint64_t number) {
    const std::vector<double> strips = std::move(polygon_);
    std::size_t first = 0;
    for (std::size_t i = 0; i < strips.size(); ++i) {
      if (strips[i] == -1.0) {
        first = i + 1;
      } else if (i >= first + 2) {
        const bool is_turned = (i - first) % 2 == 1;
        polygon_ = {strips[i - 2], strips[i - (is_turned ? 0 : 1)], strips[i - (is_turned ? 1 : 0)]};
        if (auto done = add_face(element, number); !done) return done;
      }
    }
    return {};
  }

  /// `tangents`: of a triangle's corners, or empty.
  Expected<void> finish_face(std::uint64_t number, const std::vector<std::uint32_t>& corners,
                             const std::optional<glm::vec3>& colour, const std::vector<float>& tangents) {
    outline_.clear();
    for (const std::uint32_t corner : corners) outline_.push_back(mesh_.positions[corner]);
    const std::string name = corners.size() != 3 ? fmt::format("face {}", number) : "";
    const std::size_t first = mesh_.triangles.size();
    if (const auto done = cut_face(outline_, corners, {}, name, mesh_.triangles, faces_); !done)
      return fail(fmt::format("{}: error: {}: {}", file_.path.string(), name, done.error().message));
    if (colour) mesh_.face_colours.resize(mesh_.triangles.size(), *colour);
    if (tangents.empty() || mesh_.triangles.size() != first + 1) return {};
    mesh_.tangents.resize(first + 1);
    for (std::size_t i = 0; i < 12; ++i) mesh_.tangents.back()[i / 4][int(i % 4)] = tangents[i];
    return {};
  }

  const SourceFile& file_;
  std::string_view text_;
  const MeshAttributeNames& attributes_;
  std::size_t at_ = 0;
  char line_end_ = '\n';  ///< of the header
  std::size_t line_start_ = 0;
  std::size_t token_start_ = 0;
  Format format_ = Format::kAscii;
  std::vector<Element> elements_;
  std::uint64_t vertices_ = 0;
  /// A face that precedes the vertices in the file.
  struct EarlyFace {
    std::uint64_t number;
    std::vector<std::uint32_t> corners;
    std::optional<glm::vec3> colour;
    std::vector<float> tangents;
  };

  std::optional<glm::vec3> face_colour_;  ///< of the last face
  std::vector<double> polygon_;
  std::vector<float> tangents_;  ///< of the last face
  std::vector<std::uint32_t> corners_;
  std::vector<glm::dvec3> outline_;
  std::vector<EarlyFace> early_faces_;
  Mesh mesh_;
  FaceFindings faces_;
};

}  // namespace

Expected<MeshFile> read_ply(const SourceFile& file, const MeshAttributeNames& attributes) {
  return PlyReader(file, attributes).read();
}

}  // namespace penumbra
