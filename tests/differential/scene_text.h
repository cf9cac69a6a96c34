// A scene as two texts: for Penumbra, and for Mitsuba 3, which lacks some features. They differ only in what
// is added with `each`.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/differential/mesh_text.h"

namespace penumbra::differential {

struct SceneText {
  std::string name;
  std::string ours, mitsubas;     ///< inside of <scene>
  std::vector<MeshFile> meshes;   ///< which the texts name
  std::string version = "3.0.0";  ///< of ours
  int block = 6;                  ///< side of the blocks that are compared; divides the crop's sides
  bool embree = false;            ///< traced with Embree
  double colour_error = 0;        ///< relative: where spectra are integrated to colours by other tables
  double samples = 1;             ///< how many times the usual number
  /// `ours` is this file, whole, of whatever format; Mitsuba renders what is made of it by `convert`.
  std::string converted{};
  std::vector<std::pair<std::string, std::string>> settings{};  ///< over what a file that is converted says

  void both(std::string_view text) { ours += text, mitsubas += text; }
  void each(std::string_view our_text, std::string_view their_text) {
    ours += our_text, mitsubas += their_text;
  }

  [[nodiscard]] std::string our_file() const { return converted.empty() ? "ours.xml" : converted; }
  /// Writes our file, mitsuba.xml and the meshes into a folder. Throws where a file cannot be converted.
  void write(const std::filesystem::path& folder) const;

 private:
  void write_converted(const std::filesystem::path& folder) const;
};

std::string number_text(double value);
std::string vector_text(glm::dvec3 value);
/// <TAG name="NAME" value="VALUE"/>
std::string element(std::string_view tag, std::string_view name, std::string_view value);
std::string integer(std::string_view name, int value);
std::string real(std::string_view name, double value);
std::string text(std::string_view name, std::string_view value);
std::string boolean(std::string_view name, bool value);
std::string rgb(std::string_view name, glm::dvec3 value);
std::string translate(glm::dvec3 offset);
/// A transform named to_world, of these steps.
std::string to_world(std::string_view steps);
std::string plugin(std::string_view tag, std::string_view type, std::string_view inside);
std::string look_at(glm::dvec3 origin, glm::dvec3 target);

}  // namespace penumbra::differential
