// The snippets of scheduler/record/PYTHON.md work: they are run in the order of the page, beside scenes/,
// once with each of the two libraries that read the images.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr const char* kPage = "scheduler/record/PYTHON.md";
constexpr const char* kImage = "out/a.exr";

struct Snippet {
  std::size_t line;  ///< of the page, from 0, where its text begins
  std::string text;
};

std::vector<Snippet> snippets() {
  std::vector<Snippet> found;
  std::istringstream page(file_contents(source_path(kPage)));
  bool inside = false;
  std::size_t number = 0;
  for (std::string line; std::getline(page, line); ++number) {
    if (line.starts_with("```")) {
      inside = line == "```python";
      if (inside) found.push_back({number + 1, {}});
    } else if (inside) {
      found.back().text += line + '\n';
    }
  }
  return found;
}

/// Whether the snippet reads an image, and with that library.
bool reads(const Snippet& snippet) { return snippet.text.starts_with("import numpy, "); }
bool reads_with(const Snippet& snippet, const std::string& library) {
  return snippet.text.starts_with("import numpy, " + library + '\n');
}

/// What the page runs, each line where it is in the page: errors name that line.
std::string script(const std::string& library) {
  std::string text;
  for (const Snippet& snippet : snippets()) {
    if (reads(snippet) && !reads_with(snippet, library)) continue;
    text.append(snippet.line - std::size_t(std::ranges::count(text, '\n')), '\n');
    text += snippet.text;
  }
  return text;
}

/// The page's way to read an image, for another image.
std::string reading(const std::string& library, const std::string& image) {
  for (const Snippet& snippet : snippets()) {
    if (!reads_with(snippet, library)) continue;
    std::string text = snippet.text;
    text.replace(text.find(kImage), std::string_view(kImage).size(), image);
    return text;
  }
  return "";
}

/// What is true after the snippets: the same numbers in other ways.
constexpr const char* kChecks = R"(
statistics = json.load(open("out/a.json"))
assert metadata["penumbra:film_hash"] == statistics["film_hash"]
assert mean.shape == (3, 64, 64) and mean.dtype == numpy.float32
relative = numpy.sqrt(numpy.mean(error.astype(float) ** 2 / (mean.astype(float) ** 2 + 0.01)))
assert abs(relative / statistics["relative_error"] - 1) < 1e-5, relative

def close(a, b): return abs(a - b).max() < 1e-5
assert close(matte("CryptoObject", "left-wall"), matte("CryptoMaterial", "red"))
assert close(matte("CryptoObject", "light"), matte("CryptoMaterial", "black"))
assert close(sum(matte("CryptoMaterial", name) for name in ("white", "red", "green", "black")), layers["depth.Z"] > 0)
light = matte("CryptoObject", "light")  # the share of the samples that hit it, whose radiance is 17
assert (light > 0.25).sum() > 20
assert (abs(mean[0] - 17 * light) < 1 + 5 * 17 * numpy.sqrt(light * (1 - light) / 128)).all()
)";

/// `layers` are now those of the same scene with another seed. Of the differences between both images 5 % are
/// larger than 1.96 standard errors. That share of 4000 pixels has a standard deviation of 0.34 %; and the
/// distribution of 128 samples is not quite normal.
constexpr const char* kCoverage = R"(
assert close(high - mean, mean - low)
limit = numpy.hypot((high - low)[0] / 2, 1.96 * numpy.sqrt(layers["variance.R"]))
noisy = limit > 0
outside = (abs(mean[0] - layers["R"]) > limit)[noisy]
assert noisy.sum() > 3500 and abs(outside.mean() - 0.05) < 3 * 0.0034, outside.mean()
difference = image_mean[0] - layers["R"].mean()
assert abs(difference) < 4 * numpy.sqrt(image_error[0] ** 2 + layers["variance.R"].sum() / 64**4)
)";

class PythonPage : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    std::filesystem::create_directory_symlink(source_path("scenes"), folder_ / "scenes");
    find_python();
    if (python_.empty())
      GTEST_SKIP() << "no Python here has numpy and " << GetParam() << "; PENUMBRA_PYTHON may name one\n"
                   << missing_;
  }

  /// Sets python_ to the first that has the modules.
  void find_python() {
    const char* named = std::getenv("PENUMBRA_PYTHON");
    for (const std::string candidate : {named != nullptr ? named : "", "python3", "/usr/bin/python3"}) {
      if (candidate.empty()) continue;
      const ProgramResult result = run(fmt::format("'{}' -c 'import numpy, {}'", candidate, GetParam()));
      if (result.exit_code == 0) {
        python_ = candidate;
        return;
      }
      EXPECT_THAT(result.err,
                  AnyOf(HasSubstr("ModuleNotFoundError"), HasSubstr("No such file"), HasSubstr("not found")));
      missing_ += fmt::format("{}: {}\n", candidate, result.err);
    }
  }

  ProgramResult run(const std::string& line) { return run_shell(folder_.path(), line); }
  void expect_runs(const std::string& arguments) {
    const ProgramResult result = run(fmt::format("'{}' {}", python_, arguments));
    EXPECT_EQ(result.exit_code, 0) << arguments << '\n' << result.out << result.err;
  }

  TemporaryFolder folder_;
  std::string python_, missing_;
};

TEST_P(PythonPage, SnippetsWork) {
  const std::string library = GetParam();
  write_text(folder_ / "PYTHON.md",
             script(library) + kChecks + "subprocess.run('''penumbra render " +
                 "scenes/cornell-small/cornell-small.xml -D resolution=64 --spp 128 " +
                 "--sampler independent --seed 1 -o out/b.exr''', shell=True, check=True)\n" +
                 reading(library, "out/b.exr") + kCoverage);
  expect_runs("PYTHON.md");
}

INSTANTIATE_TEST_SUITE_P(Libraries, PythonPage, testing::Values("OpenImageIO", "OpenEXR"),
                         [](const auto& tested) { return std::string(tested.param); });

/// CI, which installs what is listed there, runs the page.
TEST(PythonPackages, AreInstalledForTests) {
  const std::string page = file_contents(source_path(kPage)),
                    list = file_contents(source_path(".ci/install_packages.sh"));
  for (const char* package : {"python3-numpy", "python3-openimageio"}) {
    EXPECT_THAT(page, HasSubstr(package));
    EXPECT_THAT(list, HasSubstr(package));
  }
}

}  // namespace
}  // namespace penumbra
