// What Mitsuba 3 cannot read of the files that are written for it.
#pragma once

#include <string>
#include <string_view>

namespace penumbra::mitsuba {

/// In words, why Mitsuba 3 refuses the plugin `type` of the element `tag` ("bsdf"), or its parameter; empty:
/// it reads it. An empty `parameter` is the plugin itself.
std::string why_mitsuba3_refuses(std::string_view tag, std::string_view type, std::string_view parameter);

}  // namespace penumbra::mitsuba
