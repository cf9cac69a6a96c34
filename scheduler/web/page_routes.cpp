#include "scheduler/web/page_routes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <string_view>

#include "scheduler/files/html_text.h"

namespace penumbra {
namespace {

constexpr int kThumbnailSide = 256,
              kImageSide = 2048;  // pixels; thumbnails for screens with two per CSS pixel
constexpr std::chrono::milliseconds kStreamCheck{1000};  // how often a stream looks for the end of its peer
constexpr std::chrono::seconds kAliveInterval{10};

constexpr const char* kJson = "application/json; charset=utf-8";

WebResponse error(int status, std::string text) { return {.status = status, .text = std::move(text) + "\n"}; }

std::string_view type_of(std::string_view name) {
  const std::string_view extension = name.substr(std::min(name.rfind('.'), name.size()));
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".css") return "text/css; charset=utf-8";
  if (extension == ".js") return "text/javascript; charset=utf-8";
  if (extension == ".svg") return "image/svg+xml";
  if (extension == ".png") return "image/png";
  if (extension == ".json") return kJson;
  return "application/octet-stream";
}

/// A file of the page; null if there is none.
const EmbeddedFile* page_file(std::string_view path) {
  const std::string name =
      "scheduler/web/page/" +
      std::string(path == "/" ? "index.html" : path.substr(std::min<std::size_t>(1, path.size())));
  const auto files = page_files();
  const auto found = std::ranges::find(files, name, &EmbeddedFile::name);
  return found == files.end() ? nullptr : &*found;
}

WebResponse not_admitted() {
  return {.status = 401,
          .type = "text/html; charset=utf-8",
          .headers = {{"WWW-Authenticate", "Bearer"}},
          .text =
              "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Penumbra</title>"
              "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
              "<meta name=\"color-scheme\" content=\"light dark\">"
              "<h1>No token</h1><p>Open the link that the scheduler printed; with keys add ?token= and the "
              "contents of watch.token to the address.</p><p><a href=\"/\">Try again</a></p></html>\n"};
}

/// A name in a header (RFC 8187).
std::string encoded_name(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const bool is_plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
    out += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

WebResponse picture(const std::optional<WebPicture>& made, const WebRequest& request) {
  if (!made) return error(404, "there is no picture of this job yet");
  const std::string tag = '"' + made->tag + '"';
  // The browser keeps it, and asks each time whether it is still the newest.
  WebResponse response{.type = "image/png",
                       .headers = {{"ETag", tag}, {"Cache-Control", "private, no-cache"}},
                       .bytes = made->png};
  if (request.if_none_match == tag) response.status = 304;
  return response;
}

}  // namespace

const std::vector<std::pair<std::string, std::string>>& page_headers() {
  static const std::vector<std::pair<std::string, std::string>> headers{
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
       "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cross-Origin-Opener-Policy", "same-origin"}};
  return headers;
}

PageRoutes::PageRoutes(const WebAccess& access, WebContent& content, int most_streams, bool comes_back)
    : access_(access),
      content_(content),
      most_streams_(most_streams),
      comes_back_(comes_back),
      feed_([&content] { return content.status(); }) {}

WebResponse PageRoutes::answer(const WebRequest& request) {
  const auto respond = [&]() -> WebResponse {
    if (request.method != "GET" && request.method != "HEAD") {
      WebResponse response = error(405, "this page only shows: GET and HEAD");
      response.headers.emplace_back("Allow", "GET, HEAD");
      return response;
    }
    if (!access_.is_own_name(request.host))
      return error(421, fmt::format("this server has another name: {}", access_.url()));
    if (request.path == "/" && access_.is_token(request.token))
      return {.status = 303, .headers = {{"Location", "/"}, {"Set-Cookie", access_.cookie()}}};
    if (!access_.admits(request)) return not_admitted();
    if (request.path == "/events") return events();
    if (request.path == "/status.json")
      return {.type = kJson,
              .text = content_.status().dump(2, ' ', false, nlohmann::json::error_handler_t::replace)};
    if (request.path.starts_with("/jobs/")) return of_job(request);
    if (request.path == "/base.css")
      return {.type = std::string(type_of(request.path)), .text = std::string(html_base_style())};
    if (const auto* file = page_file(request.path))
      return {.type = std::string(type_of(file->name)), .text = std::string(file->text)};
    return error(404, "there is no such page");
  };
  WebResponse response = respond();
  if (std::ranges::find(response.headers, "Cache-Control", &std::pair<std::string, std::string>::first) ==
      response.headers.end())
    response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

/// Each event is the whole state: a page that misses some needs nothing but the next.
WebResponse PageRoutes::events() {
  struct Stream {
    explicit Stream(std::shared_ptr<std::atomic<int>> of) : streams(std::move(of)) {}
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    ~Stream() { --*streams; }
    std::shared_ptr<std::atomic<int>> streams;
    std::uint64_t seen = 0;
    bool said_end = false;
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
  };
  if (++*streams_ > most_streams_) {
    --*streams_;
    WebResponse response =
        error(503, fmt::format("{} pages show this already; close one of them", most_streams_));
    response.headers.emplace_back("Retry-After", "10");
    return response;
  }
  const auto stream = std::make_shared<Stream>(streams_);
  return {.type = "text/event-stream", .stream = [stream, this]() -> std::optional<std::string> {
            const auto state = feed_.next(stream->seen, kStreamCheck);
            if (!state && feed_.is_closed()) {
              if (comes_back_ || std::exchange(stream->said_end, true)) return {};
              return "event: over\ndata: {}\n\n";
            }
            const auto now = std::chrono::steady_clock::now();
            if (!state && now - stream->last < kAliveInterval) return "";
            stream->last = now;
            // So that the page notices a connection that is lost without an end.
            if (!state) return "event: alive\ndata: {}\n\n";
            stream->seen = state->number;
            return "data: " + *state->json + "\n\n";
          }};
}

WebResponse PageRoutes::of_job(const WebRequest& request) {
  std::string_view rest = request.path;
  rest.remove_prefix(std::string_view("/jobs/").size());
  JobId job = 0;
  const auto [end, parsed] = std::from_chars(rest.data(), rest.data() + rest.size(), job);
  if (parsed != std::errc()) return error(404, "there is no such page");
  rest.remove_prefix(std::size_t(end - rest.data()));
  if (rest == ".json") {
    const nlohmann::ordered_json status = content_.job(job);
    if (status.is_null()) return error(404, fmt::format("there is no job {}", job));
    return {.type = kJson, .text = status.dump(2, ' ', false, nlohmann::json::error_handler_t::replace)};
  }
  if (rest == "/thumbnail.png") return picture(content_.picture(job, kThumbnailSide), request);
  if (rest == "/image.png") return picture(content_.picture(job, kImageSide), request);
  constexpr std::string_view kFiles = "/files/";
  if (!rest.starts_with(kFiles)) return error(404, "there is no such page");
  const std::string name(rest.substr(kFiles.size()));
  const auto path = content_.file(job, name);
  if (!path) return error(404, "the job has no such file");
  return {.type = std::string(type_of(name)),
          .headers = {{"Content-Disposition", "attachment; filename*=UTF-8''" + encoded_name(name)}},
          .file = *path};
}

}  // namespace penumbra
