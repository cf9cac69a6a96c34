// `penumbra compare A B`: how far is A from the reference B?
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "scheduler/cli/commands.h"
#include "scheduler/outputs/compare.h"

namespace penumbra {
namespace {

struct CompareOptions {
  std::string image, reference;
  bool json = false;
  std::optional<double> tolerance;
};

ExitCode compare(const CompareOptions& options) {
  const auto image = read_image(options.image);
  if (!image) return print_error(image.error()), kBadInput;
  const auto reference = read_image(options.reference);
  if (!reference) return print_error(reference.error()), kBadInput;
  const auto comparison = compare_images(*image, *reference);
  if (!comparison) {
    print_error({fmt::format("cannot compare {} with {}: {}", options.image, options.reference,
                             comparison.error().message)});
    return kBadInput;
  }
  if (options.json) {
    fmt::print("{}\n", comparison_json(*comparison).dump(2));
  } else {
    fmt::print("{}", comparison_text(*comparison));
  }
  if (options.tolerance && !(comparison->relative_mse <= *options.tolerance)) {
    print_error({fmt::format("relMSE {:.6g} is above the tolerance {:.6g}", comparison->relative_mse,
                             *options.tolerance)});
    return kIncomplete;
  }
  return kAllDone;
}

}  // namespace

void add_compare_command(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand("compare", "Error of image A against the reference B");
  const auto options = std::make_shared<CompareOptions>();
  command->add_option("A", options->image, "Image")->required();
  command->add_option("B", options->reference, "Reference, of the same size")->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_option("--tolerance", options->tolerance, "Exit with code 1 if relMSE is above this")
      ->type_name("E")
      ->check(CLI::NonNegativeNumber);
  command->footer(
      "relMSE is the mean over pixels and channels of (A - B)^2 / (B^2 + 0.01). Any format that OpenImageIO "
      "reads;\n"
      "of an EXR the channels R, G, B. Values are compared as stored: compare EXR with EXR, PNG with PNG.\n\n"
      "Examples:\n"
      "  penumbra compare cornell.exr reference.exr\n"
      "  penumbra compare cornell.exr reference.exr --json | jq .relative_mse\n"
      "  penumbra compare cornell.exr reference.exr --tolerance 1e-3 && echo good enough");
  command->callback([options, &chosen] { chosen = [options] { return compare(*options); }; });
}

}  // namespace penumbra
