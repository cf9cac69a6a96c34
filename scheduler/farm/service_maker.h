// Calls that somebody else answers at a scheduler's address.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace grpc {
class Service;
}

namespace penumbra {

/// Is given what each call has to begin with, once its token is checked: its peer is told to what bounds
/// connections.
using ServiceMaker =
    std::function<std::shared_ptr<grpc::Service>(std::function<void(const std::string& peer)>)>;

}  // namespace penumbra
