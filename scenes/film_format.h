// How the film goes into a file: nothing of it changes what is rendered.
#pragma once

namespace penumbra {

/// OpenEXR's, in its documentation's order. From kPxr24 on they lose something, but for what they do not
/// know.
enum class ExrCompression { kNone, kRle, kZips, kZip, kPiz, kPxr24, kB44, kB44a, kDwaa, kDwab };

}  // namespace penumbra
