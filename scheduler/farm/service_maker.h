// Lets another component serve additional calls at a scheduler's address.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace grpc {
class Service;
}

namespace penumbra {

/// Makes the service. Each of its calls must first pass the peer's name to the given function, once its token
/// has been checked, so that the connection counts as admitted.
using ServiceMaker =
    std::function<std::shared_ptr<grpc::Service>(std::function<void(const std::string& peer)>)>;

}  // namespace penumbra
