// How the film is written to a file. Nothing here changes what is rendered.
#pragma once

namespace penumbra {

/// OpenEXR's compression methods, in the order of its documentation. Those from kPxr24 on are lossy, except
/// for channels that they store unchanged.
enum class ExrCompression { kNone, kRle, kZips, kZip, kPiz, kPxr24, kB44, kB44a, kDwaa, kDwab };

}  // namespace penumbra
