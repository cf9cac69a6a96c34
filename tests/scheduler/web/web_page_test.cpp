// Tests the page in headless Chromium, with `penumbra serve --web` and `penumbra render --web` as users run
// them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "tests/scheduler/cli/moving_scene.h"
#include "tests/support/browser_page.h"
#include "tests/support/program.h"
#include "tests/support/readable_page.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::web_page_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::HasSubstr;

using Arguments = std::vector<std::string>;

/// What the page shows, in the shape of `status --json`.
constexpr const char* kShown = R"js((() => {
  const text = (node, selector) => node.querySelector(selector).textContent;
  const jobs = [...document.querySelectorAll(".job")].map(node => ({job: Number(text(node, ".number")),
    name: text(node, ".name"), state: text(node, ".state"), detail: text(node, ".detail")})).sort((a, b) => a.job - b.job);
  const workers = [...document.querySelectorAll("#workers li")].map(node => ({name: text(node, ".name"),
    at: text(node, ".at"), detail: text(node, ".detail")}));
  const messages = [...document.querySelectorAll("#messages li")].map(node => node.textContent).reverse();
  return {jobs, workers, messages, summary: text(document, "#summary")};
})())js";

class WebPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!find_browser()) GTEST_SKIP() << kNoBrowser;
    write_small_scene(folder_ / "s.xml");
  }
  void TearDown() override {
    if (!HasFailure() || !page_) return;
    if (const auto text = page_->evaluate("document.body.innerText")) std::cerr << *text << "\n";
  }

  void serve(const Arguments& more = {"--workers", "1", "--threads", "1"}) {
    Arguments arguments{"serve", "--listen", address_, "--spool", "spool", "--web", web_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    program_ = std::make_unique<Program>(folder_.path(), arguments);
    find_link();
    for (int i = 0; i < 3000 && run({"status"}).exit_code != 0; ++i) std::this_thread::sleep_for(10ms);
  }
  /// The link that the program prints.
  void find_link() {
    const std::regex link("http://127.0.0.1:([0-9]+)/\\?token=[0-9a-f]+");
    for (int i = 0; i < 6000; ++i) {
      for (const std::string& name : folder_.names()) {
        const std::string said = name.starts_with(".") ? file_contents(folder_ / name) : "";
        for (auto at = std::sregex_iterator(said.begin(), said.end(), link); at != std::sregex_iterator();
             ++at) {
          link_ = at->str();
          web_ = "127.0.0.1:" + (*at)[1].str();
        }
      }
      if (!link_.empty()) return;
      std::this_thread::sleep_for(10ms);
    }
    FAIL() << "there is no link";
  }
  ProgramResult run(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--to", address_});
    return run_penumbra(folder_.path(), arguments);
  }
  void submit(const Arguments& more) const {
    Arguments arguments{"submit", "s.xml", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult submitted = run(arguments);
    ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  }
  [[nodiscard]] json status() const { return json::parse(run({"status", "--json"}).out, nullptr, false); }

  void open(int width = 1280, bool dark = false) {
    auto page = BrowserPage::open(width, 900, dark);
    ASSERT_TRUE(page) << page.error().message;
    page_ = std::move(*page);
    const auto gone = page_->go(link_);
    ASSERT_TRUE(gone) << gone.error().message;
    ASSERT_TRUE(page_->comes("document.body.dataset.shown === 'true'"));
  }
  [[nodiscard]] json shown() { return page_->evaluate(kShown).value_or(json()); }
  void expect_readable_page() {
    for (const int width : {390, 1280})
      for (const bool dark : {false, true}) {
        SCOPED_TRACE(std::to_string(width) + (dark ? " pixels, dark" : " pixels, light"));
        page_->resize(width, 900, dark);
        const auto seen = page_->evaluate("(" + std::string(kMeasurePage) + ")()");
        ASSERT_TRUE(seen) << seen.error().message;
        expect_readable(*seen, width, 0);
        keep_screenshot(std::to_string(width) + (dark ? "-dark" : "-light"));
      }
  }
  /// Into the folder PENUMBRA_SCREENSHOTS, to be looked at.
  void keep_screenshot(const std::string& name) {
    const char* folder = std::getenv("PENUMBRA_SCREENSHOTS");
    if (folder == nullptr) return;
    const std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    page_->screenshot(std::filesystem::path(folder) / (test + "-" + name + ".png"));
  }

  const TemporaryFolder folder_;
  const std::string address_ = "unix:" + (folder_ / "socket").string();
  std::string web_ = "127.0.0.1:0", link_;
  std::unique_ptr<Program> program_;
  std::unique_ptr<BrowserPage> page_;
};

const Arguments kLong = {"--spp", "4000000", "--pass", "32", "--tile", "8"};

TEST_F(WebPage, ItShowsWhatTheStatusSays) {
  serve();
  submit({"--spp", "8", "-o", "first.exr"});
  ASSERT_EQ(run({"fetch", "1", "--wait", "-o", "out"}).exit_code, 0);
  submit(kLong);
  submit({"--spp", "16", "--priority", "-2"});
  open();
  EXPECT_THAT(page_->evaluate("location.href").value_or("").get<std::string>(),
              ::testing::Not(HasSubstr("token")));
  ASSERT_TRUE(page_->comes("document.querySelectorAll('#rendering .job').length === 1"));
  ASSERT_TRUE(page_->comes("document.querySelectorAll('#ended .job img').length === 1"))
      << "the picture of a file";
  ASSERT_TRUE(page_->comes("document.querySelectorAll('#rendering .job img').length === 1")) << "of a film";

  const json now = shown(), said = status();
  ASSERT_EQ(now["jobs"].size(), said["jobs"].size());
  for (std::size_t i = 0; i < now["jobs"].size(); ++i)
    for (const char* key : {"job", "name", "state"}) EXPECT_EQ(now["jobs"][i][key], said["jobs"][i][key]);
  EXPECT_THAT(now["jobs"][0]["detail"].get<std::string>(), HasSubstr("error"));
  EXPECT_THAT(now["jobs"][1]["detail"].get<std::string>(), HasSubstr("Msamples/s"));
  EXPECT_THAT(now["jobs"][2]["detail"].get<std::string>(), HasSubstr("priority -2"));
  ASSERT_EQ(now["workers"].size(), said["workers"].size());
  EXPECT_EQ(now["workers"][0]["name"], said["workers"][0]["name"]);
  EXPECT_EQ(now["workers"][0]["at"], "job 2");
  EXPECT_THAT(now["workers"][0]["detail"].get<std::string>(),
              HasSubstr(said["workers"][0]["device"].get<std::string>()));
  EXPECT_EQ(now["messages"], said["messages"]);
  EXPECT_EQ(now["summary"], "3 jobs · 1 rendering · 1 queued · 1 worker");

  // The page's own state is that of the command.
  const auto same = page_->evaluate("fetch('status.json').then(answer => answer.json())");
  ASSERT_TRUE(same);
  for (const char* key : {"name", "state", "files", "begun", "samples_total"})
    EXPECT_EQ((*same)["jobs"][0][key], said["jobs"][0][key]) << key;

  // Links to files.
  ASSERT_TRUE(page_->evaluate("document.querySelector('[data-job=\"1\"] .more').open = true"));
  ASSERT_TRUE(page_->comes("document.querySelectorAll('[data-job=\"1\"] .files a').length === 3"));
  const auto size = page_->evaluate(
      "fetch(document.querySelector('[data-job=\"1\"] .files a').href).then(a => a.blob()).then(b => "
      "b.size)");
  ASSERT_TRUE(size) << size.error().message;
  EXPECT_EQ(*size, said["jobs"][0]["files"][0]["bytes"]);

  // The larger picture.
  ASSERT_TRUE(page_->evaluate("document.querySelector('#rendering .picture').click()"));
  EXPECT_TRUE(page_->comes("document.querySelector('#viewer img')?.naturalWidth === 24"));
  keep_screenshot("viewer");
  ASSERT_TRUE(page_->evaluate("document.querySelector('#viewer button').click()"));
  EXPECT_TRUE(page_->comes("!document.getElementById('viewer').open"));

  // What happens is seen without loading again.
  ASSERT_EQ(run({"cancel", "2"}).exit_code, 0);
  EXPECT_TRUE(page_->comes("document.querySelectorAll('#ended .job').length === 3"));
}

TEST_F(WebPage, HostileNamesAreOnlyText) {
  serve({"--workers", "1", "--threads", "1"});
  write_small_scene(folder_ / "<img src=x onerror=document.title=1>.xml");
  write_small_scene(folder_ / "\"'><script>window.hit=1<-script>.xml");
  write_small_scene(folder_ /
                    "\xE2\x80\xAE"
                    "fdp.\xE2\x81\xA6 &amp; \xD7\xA9\xD7\x9C.xml");
  const std::string longest = std::string(240, 'W') + ".xml";
  write_small_scene(folder_ / longest);
  int jobs = 0;
  for (const std::string& name : folder_.names())
    if (name.ends_with(".xml")) {
      EXPECT_EQ(run({"submit", name, "-q", "--spp", "4", "-o", "a<b>'.exr"}).exit_code, 0) << name;
      ++jobs;
    }
  open();
  ASSERT_TRUE(page_->comes("document.querySelectorAll('#ended .job').length === " + std::to_string(jobs)));
  const json now = shown(), said = status();
  for (std::size_t i = 0; i < now["jobs"].size(); ++i)
    EXPECT_EQ(now["jobs"][i]["name"], said["jobs"][i]["name"]);
  ASSERT_TRUE(
      page_->evaluate("document.querySelectorAll('details').forEach(details => { details.open = true; })"));
  ASSERT_TRUE(page_->comes("document.querySelectorAll('.files a').length === " + std::to_string(3 * jobs)));
  EXPECT_EQ(
      page_
          ->evaluate("window.hit === undefined && document.querySelectorAll('script').length === 1 && "
                     "!document.querySelector('[onerror], .name > *') && document.title.endsWith('Penumbra')")
          .value_or(json()),
      true);
  // Even a script in the page's own text would not run.
  EXPECT_EQ(
      page_
          ->evaluate("(() => { const s = document.createElement('script'); s.textContent = 'window.hit = 2'; "
                     "document.body.append(s); return window.hit === undefined; })()")
          .value_or(json()),
      true);
  expect_readable_page();
}

TEST_F(WebPage, ManyJobsAndWorkersStayReadable) {
  serve({"--workers", "0"});
  open();
  // A farm of a hundred workers does not fit here, so the page is shown a state that one would send.
  json state = status();
  for (int i = 1; i <= 100; ++i)
    state["workers"].push_back(
        {{"worker", i},
         {"name", "render-node-" + std::to_string(i) + ".farm.example:" + std::to_string(20000 + i)},
         {"device", "AVX-512, 64 threads, AMD EPYC 9354P 32-Core Processor"},
         {"units", 1234 * i},
         {"samples", 1e9},
         {"busy_seconds", 345.6},
         {"job", i % 7 == 0 ? json() : json(1 + i % 8)},
         {"since_seconds", 7200 + i}});
  const char* states[] = {"rendering", "queued", "done", "failed", "cancelled", "incomplete"};
  const double now = state["now"];
  for (int i = 1; i <= 200; ++i) {
    const std::string is = i <= 8 ? states[0] : i <= 60 ? states[1] : states[2 + i % 4];
    state["jobs"].push_back(
        {{"job", i},
         {"name", "shots/castle-courtyard/frame-" + std::to_string(1000 + i) + ".xml"},
         {"state", is},
         {"priority", i % 5},
         {"error", is == "failed"
                       ? json("texture 'wood.png' of material 'floor' is missing: no such file or directory")
                       : json()},
         {"submitted", now - 9000},
         {"begun", i <= 8 || i > 60 ? json(now - 4000) : json()},
         {"ended", i > 60 ? json(now - 10 * i) : json()},
         {"samples_done", i <= 8   ? 1e7 * i
                          : i > 60 ? 1e8
                                   : 0.0},
         {"samples_total", 1e8},
         {"samples_before", 0},
         {"elapsed_seconds", 100},
         {"relative_error", 0.0123},
         {"files", json::array({{{"name", "frame.exr"}, {"bytes", 12345678}}})},
         {"problems", json::array()},
         {"group", i > 100 && i <= 150 ? json(14) : json()},
         {"submitter", "ann@studio"},
         {"after", i == 20 ? json({3, 4}) : json::array()},
         {"seconds_left", i <= 8 ? json(3700) : json()}});
  }
  state["groups"] = json::array({{{"group", 14},
                                  {"name", "courtyard.toml"},
                                  {"state", "rendering"},
                                  {"submitter", "ann@studio"},
                                  {"size", 50},
                                  {"jobs",
                                   {{"done", 20},
                                    {"rendering", 0},
                                    {"queued", 0},
                                    {"incomplete", 10},
                                    {"failed", 12},
                                    {"cancelled", 8}}},
                                  {"samples_done", 4e9},
                                  {"samples_total", 5e9},
                                  {"seconds_left", 1234},
                                  {"submitted", now - 9000},
                                  {"ended", nullptr}}});
  state["messages"] = {"worker 7 left: killed by signal 9", "worker 8 has joined"};
  ASSERT_TRUE(page_->evaluate("import('./page.js').then(page => page.show(" + state.dump() + "))"));
  ASSERT_TRUE(page_->comes("document.querySelectorAll('.job').length === 200"));
  EXPECT_EQ(page_
                ->evaluate("[...document.querySelectorAll('#rendering > ul > .job, #waiting .job, #ended > "
                           "ul > .job, .group .job')].length")
                .value_or(json()),
            200);
  EXPECT_EQ(page_->evaluate("document.querySelectorAll('#rendering .group[data-group=\"14\"] .job').length")
                .value_or(json()),
            50);
  EXPECT_EQ(page_->evaluate("document.querySelectorAll('#workers li').length").value_or(json()), 100);
  keep_screenshot("closed");
  expect_readable_page();
}

TEST_F(WebPage, ALostSchedulerIsSaidAndItsNextOneFound) {
  serve();
  submit({"--spp", "8", "-o", "first.exr"});
  open();
  ASSERT_TRUE(page_->comes("document.querySelectorAll('#ended .job').length === 1"));
  program_->send(SIGKILL);
  program_->wait();
  ASSERT_TRUE(page_->comes(
      "document.getElementById('notice').textContent.includes('Connection lost, trying again.')"));
  EXPECT_TRUE(
      page_->comes("/What you see is of .*[0-9]/.test(document.getElementById('notice').textContent)"));
  EXPECT_EQ(page_->evaluate("document.querySelectorAll('#ended .job').length").value_or(json()), 1);
  keep_screenshot("lost");
  serve();
  submit({"--spp", "8", "-o", "second.exr"});
  EXPECT_TRUE(page_->comes("document.querySelectorAll('#ended .job').length === 2"));
  EXPECT_TRUE(page_->comes("document.getElementById('notice').hidden"));
}

TEST_F(WebPage, OfOneRender) {
  program_ =
      std::make_unique<Program>(folder_.path(), Arguments{"render", "s.xml", "--spp", "4000000", "--pass",
                                                          "32", "--tile", "8", "--web", web_, "-o", "a.exr"});
  find_link();
  open();
  ASSERT_TRUE(page_->comes("document.querySelectorAll('#rendering .job img').length === 1"));
  const json now = shown();
  EXPECT_EQ(now["jobs"][0]["name"], "s.xml");
  EXPECT_EQ(now["workers"].size(), 1u);
  EXPECT_EQ(now["workers"][0]["at"], "job 1");
  program_->send(SIGINT);
  EXPECT_TRUE(page_->comes("document.getElementById('notice').textContent.includes('The render is over')"));
  EXPECT_TRUE(page_->comes("document.querySelector('#ended .job .state')?.textContent === 'incomplete'"));
}

TEST_F(WebPage, AShotIsAStripOfFramesWithPicturesAsTheyEnd) {
  write_moving_scene(folder_ / "shot.xml");
  serve();
  const ProgramResult submitted = run({"submit", "shot.xml", "--frames", "1-24", "--set", "film.width=192",
                                       "--set", "film.height=108", "--spp", "64", "-q"});
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  ASSERT_EQ(run({"cancel", "1", "--frames", "20-22"}).exit_code, 0);
  open();
  ASSERT_TRUE(page_->comes("document.querySelectorAll('.group[data-group=\"1\"] .strip i').length === 24"));
  EXPECT_TRUE(page_->comes("document.querySelectorAll('.frames [data-state=\"done\"] img').length > 3"));
  keep_screenshot("rendering");
  EXPECT_TRUE(page_->comes("document.querySelectorAll('.strip i[data-state=\"done\"]').length === 21"));
  ASSERT_TRUE(page_->evaluate("document.querySelector('.group > details').open = true"));
  EXPECT_TRUE(page_->comes("document.querySelectorAll('.frames img').length === 21"));
  EXPECT_EQ(
      page_
          ->evaluate("[...document.querySelectorAll('.frames li')].map(node => Number(node.dataset.frame))"
                     ".every((frame, index) => frame === index + 1)")
          .value_or(json()),
      true);
  ASSERT_TRUE(page_->evaluate("document.querySelector('.frames [data-frame=\"5\"] .picture').click()"));
  EXPECT_TRUE(page_->comes("document.querySelector('#viewer img')?.naturalWidth === 192"));
  EXPECT_TRUE(page_->comes("document.querySelector('#viewer h2').textContent === 'shot.xml frame=5'"));
  ASSERT_TRUE(page_->evaluate("document.querySelector('#viewer button').click()"));
  EXPECT_EQ(shown()["jobs"].size(), 24u);
  expect_readable_page();
}

TEST_F(WebPage, AShotOfMoreFramesThanJobsAreShownHasAllPictures) {
  write_moving_scene(folder_ / "shot.xml");
  serve();
  const ProgramResult submitted = run({"submit", "shot.xml", "--frames", "1-520", "--spp", "1", "--crop",
                                       "0,0,8,8", "-q", "-o", "shot.####.png"});
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  ASSERT_EQ(run({"fetch", "1", "--wait", "-q", "-o", "out"}).exit_code, 0);
  open();
  ASSERT_TRUE(page_->comes("document.querySelectorAll('.strip i[data-state=\"done\"]').length === 520"));
  EXPECT_EQ(page_->evaluate("document.querySelectorAll('.frames li').length").value_or(json()), 520);
  EXPECT_EQ(page_->evaluate("document.querySelectorAll('.job').length").value_or(json()), 500);
}

TEST_F(WebPage, AShotThatIsRenderedHereIsAGroupToo) {
  write_moving_scene(folder_ / "shot.xml");
  program_ =
      std::make_unique<Program>(folder_.path(), Arguments{"render", "shot.xml", "--frames", "1-4", "--spp",
                                                          "60000", "--web", web_, "-o", "shot.####.exr"});
  find_link();
  open();
  ASSERT_TRUE(page_->comes("document.querySelectorAll('.group .strip i').length === 4"));
  EXPECT_TRUE(page_->comes("document.querySelectorAll('.frames [data-state=\"done\"] img').length > 0"));
  EXPECT_EQ(page_->evaluate("document.querySelector('.group .name').textContent").value_or(json()),
            "shot.xml");
  program_->send(SIGINT);
}

TEST_F(WebPage, OfASetOfRenders) {
  write_text(
      folder_ / "jobs.toml",
      "[[render]]\nscene = \"s.xml\"\nspp = [4, 8, 4000000, 16]\npass = 32\ntile = 8\nout = \"{spp}.exr\"\n");
  program_ = std::make_unique<Program>(folder_.path(),
                                       Arguments{"render", "jobs.toml", "--web", web_, "--workers", "1"});
  find_link();
  open();
  ASSERT_TRUE(page_->comes("document.querySelectorAll('#ended .job img').length === 2"));
  ASSERT_TRUE(page_->comes("document.querySelectorAll('#rendering .job img').length === 1"));
  EXPECT_EQ(page_->evaluate("document.querySelectorAll('#waiting .job').length").value_or(json()), 1);
  keep_screenshot("set");
  program_->send(SIGINT);
  EXPECT_TRUE(page_->comes("document.getElementById('notice').textContent.includes('The render is over')"));
}

}  // namespace
}  // namespace penumbra::web_page_test
