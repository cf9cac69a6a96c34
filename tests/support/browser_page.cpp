#include "tests/support/browser_page.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <thread>
#include <vector>

#include "tests/support/browser.h"

namespace penumbra {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

constexpr int kToBrowser = 3, kFromBrowser = 4;  // the descriptors of --remote-debugging-pipe
constexpr auto kPatience = 60s;

std::string bytes_of_base64(const std::string& text) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned word = 0;
  int bits = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) continue;
    word = word << 6 | unsigned(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    out += char(word >> bits & 0xFFu);
  }
  return out;
}

}  // namespace

Expected<std::unique_ptr<BrowserPage>> BrowserPage::open(int width, int height, bool dark) {
  const auto browser = find_browser();
  if (!browser) return fail(kNoBrowser);
  std::unique_ptr<BrowserPage> page(new BrowserPage);
  std::vector<std::string> arguments{browser->string(),
                                     "--headless",
                                     "--no-sandbox",
                                     "--disable-gpu",
                                     "--no-first-run",
                                     "--hide-scrollbars",
                                     "--ignore-certificate-errors",
                                     "--remote-debugging-pipe",
                                     "--user-data-dir=" + (page->folder_ / "profile").string(),
                                     "about:blank"};
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) return fail("no pipes");
  page->pid_ = fork();
  if (page->pid_ == 0) {
    setpgid(0, 0);
    // Via numbers that are free, because the pipes may have those that the browser expects.
    const int in = fcntl(to[0], F_DUPFD, 10), out = fcntl(from[1], F_DUPFD, 10);
    dup2(in, kToBrowser);
    dup2(out, kFromBrowser);
    const int nothing = ::open("/dev/null", O_RDWR);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(to[0]);
  close(from[1]);
  page->to_ = to[1];
  page->from_ = from[0];
  const auto target = page->call("Target.createTarget", {{"url", "about:blank"}});
  if (!target) return std::unexpected(target.error());
  const auto attached =
      page->call("Target.attachToTarget", {{"targetId", (*target)["targetId"]}, {"flatten", true}});
  if (!attached) return std::unexpected(attached.error());
  page->session_ = (*attached)["sessionId"];
  page->resize(width, height, dark);
  return page;
}

BrowserPage::~BrowserPage() {
  if (to_ >= 0) close(to_);
  if (from_ >= 0) close(from_);
  if (pid_ <= 0) return;
  kill(-pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

Expected<json> BrowserPage::receive() {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  for (;;) {
    if (const std::size_t end = unread_.find('\0'); end != std::string::npos) {
      json message = json::parse(unread_.substr(0, end), nullptr, false);
      unread_.erase(0, end + 1);
      return message;
    }
    pollfd entry{from_, POLLIN, 0};
    if (std::chrono::steady_clock::now() > until || poll(&entry, 1, 1000) < 0)
      return fail("the browser gives no answer");
    if (entry.revents == 0) continue;
    std::string part(std::size_t(1) << 16, '\0');
    const ssize_t got = read(from_, part.data(), part.size());
    if (got <= 0) return fail("the browser has ended");
    unread_.append(part, 0, std::size_t(got));
  }
}

Expected<json> BrowserPage::call(const std::string& method, json parameters) {
  json message{{"id", ++calls_}, {"method", method}, {"params", std::move(parameters)}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump() + '\0';
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t sent = write(to_, text.data() + at, text.size() - at);
    if (sent <= 0) return fail("the browser has ended");
    at += std::size_t(sent);
  }
  for (;;) {
    const auto answer = receive();
    if (!answer) return answer;
    if (answer->value("id", 0) != calls_) continue;  // an event
    if (answer->contains("error")) return fail(method + ": " + (*answer)["error"].dump());
    return (*answer)["result"];
  }
}

void BrowserPage::resize(int width, int height, bool dark) {
  (void)call("Emulation.setDeviceMetricsOverride",
             {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
  (void)call("Emulation.setEmulatedMedia",
             {{"features", {{{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}}}}});
}

Expected<void> BrowserPage::go(const std::string& url) {
  const auto navigated = call("Page.navigate", {{"url", url}});
  if (!navigated) return std::unexpected(navigated.error());
  if (navigated->contains("errorText")) return fail((*navigated)["errorText"].get<std::string>());
  if (!comes("document.readyState === 'complete' && location.href !== 'about:blank'"))
    return fail("the page is not loaded");
  return {};
}

Expected<json> BrowserPage::evaluate(const std::string& script) {
  const auto result =
      call("Runtime.evaluate", {{"expression", script}, {"returnByValue", true}, {"awaitPromise", true}});
  if (!result) return result;
  if (result->contains("exceptionDetails")) return fail((*result)["exceptionDetails"].dump());
  return (*result)["result"].value("value", json());
}

bool BrowserPage::comes(const std::string& script) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < until) {
    if (const auto value = evaluate(script); value && *value == true) return true;
    std::this_thread::sleep_for(50ms);
  }
  return false;
}

void BrowserPage::screenshot(const std::filesystem::path& file) {
  const auto size = evaluate("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]");
  if (!size) return;
  const auto shot = call("Page.captureScreenshot", {{"format", "png"},
                                                    {"captureBeyondViewport", true},
                                                    {"clip",
                                                     {{"x", 0},
                                                      {"y", 0},
                                                      {"width", (*size)[0]},
                                                      {"height", std::min(4000, (*size)[1].get<int>())},
                                                      {"scale", 1}}}});
  if (shot) write_text(file, bytes_of_base64((*shot)["data"]));
}

}  // namespace penumbra
