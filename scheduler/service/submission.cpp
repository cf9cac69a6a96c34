#include "scheduler/service/submission.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <ranges>
#include <set>

#include "scenes/settings.h"
#include "scheduler/denoise/in_time.h"
#include "scheduler/render/frames.h"
#include "worker/protocol/text.h"

namespace penumbra {
namespace {

constexpr std::size_t kLongestFileName =
    200;  // file systems allow 255 bytes, of which a checkpoint needs some
constexpr std::size_t kLongestFolder = 1000;

template <typename Field>
void add_texts(const std::vector<std::string>& texts, Field* field) {
  for (const std::string& text : texts) *field->Add() = wire_text(text, kLongestText);
}

template <typename Field>
void add_named(const std::vector<std::pair<std::string, std::string>>& texts, Field* field) {
  for (const auto& [name, text] : texts) {
    wire::NamedText* added = field->Add();
    added->set_name(wire_text(name, kLongestName));
    added->set_text(wire_text(text, kLongestText));
  }
}

template <typename Field>
std::vector<std::pair<std::string, std::string>> named_texts(const Field& field) {
  std::vector<std::pair<std::string, std::string>> texts;
  for (const wire::NamedText& text : field) texts.emplace_back(text.name(), text.text());
  return texts;
}

void encode(const RenderRecord& record, wire::Record& message) {
  message.set_scene(wire_text(record.scene.file, kLongestText));
  message.set_scene_hash(record.scene_hash);
  const auto add = [](const std::string& name, const std::string& text, auto* field) {
    wire::NamedText* added = field->Add();
    added->set_name(name);
    added->set_text(wire_text(text, kLongestText));
  };
  for (const RenderOption& option : all_render_options())
    if (option.is_sent())
      for (const std::string& value : given_values(option, record))
        add(option.name(), value, message.mutable_options());
  for (const Setting& setting : all_settings())
    if (setting.print && setting.belongs_to(record))
      if (const std::string value = setting.print(record); !value.empty())
        add(setting.key, value, message.mutable_render_settings());
}

Expected<RenderRecord> decode(const wire::Record& message) {
  RenderRecord record;
  for (const wire::NamedText& setting : message.render_settings())
    if (const auto applied = apply_setting(record, setting.name(), setting.text()); !applied)
      return std::unexpected(applied.error());
  if (const auto checked = check_settings(record); !checked) return std::unexpected(checked.error());
  static_cast<RenderRequest&>(record) = {};
  for (const wire::NamedText& given : message.options()) {
    const RenderOption* option = find_render_option(given.name());
    if (option == nullptr || !option->is_sent())
      return fail(
          fmt::format("'{}' is no option of a submitted render", wire_text(given.name(), kLongestName)));
    std::string text = given.text();
    if (const auto applied = option->apply(record, text); !applied)
      return fail(fmt::format("{}: {}", option->word(), applied.error().message));
  }
  if (const auto checked = check_exclusions(record); !checked) return std::unexpected(checked.error());
  if (record.plan.tile == 0 || record.plan.samples_per_pass == 0 || record.scene.intersector == "auto" ||
      (record.scene.intersector == "embree" && record.isa.empty()))
    return fail(
        "a render without --tile, --pass, --intersector or its --isa: another version of penumbra has "
        "submitted it");
  record.scene.file = message.scene();
  record.scene_hash = message.scene_hash();
  return record;
}

void encode(const MatteNames& names, wire::MatteNames& message) {
  add_texts(names.objects, message.mutable_objects());
  add_texts(names.materials, message.mutable_materials());
  for (const MatteNames::Matte& matte : names.mattes) {
    message.add_matte_objects(matte.object);
    message.add_matte_materials(matte.material);
  }
}

Expected<MatteNames> decode(const wire::MatteNames& message) {
  MatteNames names{.objects = {message.objects().begin(), message.objects().end()},
                   .materials = {message.materials().begin(), message.materials().end()},
                   .mattes = {}};
  if (message.matte_objects_size() != message.matte_materials_size())
    return fail("mattes of which some have no object or no material");
  for (int i = 0; i < message.matte_objects_size(); ++i) {
    const MatteNames::Matte matte{message.matte_objects(i), message.matte_materials(i)};
    if (matte.object >= names.objects.size() || matte.material >= names.materials.size())
      return fail("a matte whose object or material has no name");
    names.mattes.push_back(matte);
  }
  return names;
}

}  // namespace

bool is_result_name(std::string_view name) {
  if (name.empty() || name.size() > kLongestFileName || name.front() == '.') return false;
  if (name.find('/') != std::string_view::npos || name.find('\0') != std::string_view::npos) return false;
  const std::string extension = std::filesystem::path(name).extension().string();
  return extension == ".exr" || extension == ".png" || extension == ".json";
}

bool is_result_folder(std::string_view folder) {
  if (folder.empty()) return true;
  if (folder.size() > kLongestFolder) return false;
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(folder, is_control)) return false;
  return std::ranges::all_of(std::views::split(folder, '/'), [](const auto& part) {
    return !part.empty() && part.front() != '.' &&
           std::size_t(std::ranges::distance(part)) <= kLongestFileName;
  });
}

wire::Submission encode(const Submission& submission) {
  wire::Submission message;
  message.set_name(wire_text(submission.name, kLongestText));
  message.set_scene(submission.scene);
  message.set_priority(submission.priority);
  encode(submission.record, *message.mutable_record());
  for (const double coordinate : submission.center) message.add_center(coordinate);
  add_texts(submission.warnings, message.mutable_warnings());
  add_named(submission.needs, message.mutable_needs());
  add_named(submission.left_out, message.mutable_left_out());
  message.set_build_seconds(submission.build_seconds);
  add_texts(submission.command_line, message.mutable_command_line());
  add_texts(submission.files, message.mutable_files());
  if (submission.record.scene.cryptomatte) encode(submission.mattes, *message.mutable_mattes());
  message.set_folder(submission.folder);
  message.set_submitter(wire_text(submission.submitter, kLongestName));
  if (const auto& group = submission.group) {
    message.mutable_group()->set_number(group->number);
    message.mutable_group()->set_name(wire_text(group->name, kLongestName));
    message.mutable_group()->set_size(group->size);
  }
  for (const JobId job : submission.after) message.add_after(job);
  if (submission.frame) message.set_frame(*submission.frame);
  if (submission.beside) {
    message.mutable_beside()->set_shot(submission.beside->shot);
    for (const int frame : submission.beside->frames) message.mutable_beside()->add_frames(frame);
  }
  message.set_choice(wire_text(submission.choice, kLongestText));
  return message;
}

Expected<Submission> decode(const wire::Submission& message) {
  auto record = decode(message.record());
  if (!record) return std::unexpected(record.error());
  Submission submission{.name = message.name(),
                        .scene = message.scene(),
                        .priority = message.priority(),
                        .record = std::move(*record)};
  if (message.center_size() != int(submission.center.size()) ||
      !std::ranges::all_of(message.center(), [](double coordinate) { return std::isfinite(coordinate); }))
    return fail("the scene's centre is none");
  std::ranges::copy(message.center(), submission.center.begin());
  submission.warnings = {message.warnings().begin(), message.warnings().end()};
  submission.needs = named_texts(message.needs());
  submission.left_out = named_texts(message.left_out());
  submission.build_seconds = message.build_seconds();
  submission.command_line = {message.command_line().begin(), message.command_line().end()};
  submission.files = {message.files().begin(), message.files().end()};
  // A denoised image comes after the image that it is made of.
  const int most_images = is_denoised(submission.record.film) ? 2 : 1;
  std::set<std::string_view> names;
  std::map<std::string_view, int> of_kind;
  for (const std::string& name : submission.files) {
    if (!is_result_name(name))
      return fail(
          fmt::format("'{}' is no name of a result: NAME.exr, NAME.png or NAME.json without folders", name));
    const std::string_view kind = std::string_view(name).substr(name.rfind('.'));
    if (++of_kind[kind] > (kind == ".json" ? 1 : most_images)) return fail("two results of one kind");
    if (!names.insert(name).second) return fail("two results of one name");
  }
  if (submission.files.empty()) return fail("there is no file to be written");
  auto mattes = decode(message.mattes());
  if (!mattes) return std::unexpected(mattes.error());
  submission.mattes = std::move(*mattes);
  submission.folder = message.folder();
  if (!is_result_folder(submission.folder))
    return fail(fmt::format("'{}' is no folder for results: a relative path without '..'",
                            wire_text(submission.folder, kLongestName)));
  submission.submitter = wire_text(message.submitter(), kLongestName);
  submission.choice = wire_text(message.choice(), kLongestText);
  if (message.has_group())
    submission.group = {message.group().number(), wire_text(message.group().name(), kLongestName),
                        message.group().size()};
  submission.after = {message.after().begin(), message.after().end()};
  if (message.has_frame()) {
    if (message.frame() < 0 || message.frame() > kLastFrame)
      return fail(fmt::format("{} is no frame", message.frame()));
    submission.frame = message.frame();
  }
  if (message.has_beside()) {
    if (!submission.frame || of_kind[".exr"] < 2)
      return fail("only a frame with an EXR and a denoised EXR has frames beside it");
    submission.beside = {message.beside().shot(),
                         {message.beside().frames().begin(), message.beside().frames().end()}};
    int last = -1;
    for (const int frame : submission.beside->frames) {
      if (frame <= last || frame == *submission.frame ||
          std::abs(frame - *submission.frame) > kMostTimeRadius)
        return fail(fmt::format("frame {} is not beside frame {}", frame, *submission.frame));
      last = frame;
    }
  }
  return submission;
}

}  // namespace penumbra
