// Opens the page in the browser, for the option --web.
#pragma once

#include <memory>
#include <string>

#include "jobs.pb.h"
#include "scheduler/web/web_server.h"
#include "worker/protocol/wire.h"

namespace penumbra {

struct WebPage {
  std::string address;  ///< empty: no page
  std::shared_ptr<const Keys> keys = {};
};

/// Checks the address and reads the keys from `folder` (empty: none) if it needs them. Errors: see
/// check_web_address and read_keys.
Expected<WebPage> web_page_of(const std::string& address, const std::string& folder);

/// Opens the page. It takes `token` and the keys' token for watching. `comes_back`: see WebOptions. Errors:
/// those of WebServer::listen.
Expected<std::unique_ptr<WebServer>> open_web_page(const WebPage& page, const std::string& token,
                                                   bool comes_back, WebContent& content);

/// Where the page is, for users. The link contains the token, unless it is one of the keys.
std::string web_page_notice(const WebServer& server, const WebPage& page);

/// The JSON of the state (see status_json) for pages. Of very many jobs only those being rendered, those
/// waiting and those that ended last; "jobs_left_out" is the number of others. "frames_left_out" of a group
/// has of its frames among them what their pictures need.
nlohmann::ordered_json web_page_status(wire::StatusReply status);

}  // namespace penumbra
