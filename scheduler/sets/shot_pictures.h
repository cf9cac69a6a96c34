// What is made of the pictures of a shot's frames when a set ends: the contact sheet and the video.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/contact_sheet.h"
#include "scheduler/sets/set_plan.h"
#include "scheduler/sets/set_summary.h"

namespace penumbra {

/// The frames of a shot in their order, with their pictures: those that are denoised where they are asked
/// for. A frame that failed has none, even where an earlier render has left one. `entries`: of the set.
std::vector<SheetFrame> frames_of_shot(const SetShot& shot, const SetPlan& plan,
                                       const std::vector<SetEntry>& entries);

/// The same with the finished frames of other sets that the plan's summary lists, which has been written.
std::vector<SheetFrame> frames_of_all_sets(const SetShot& shot, const SetPlan& plan,
                                           const std::vector<SetEntry>& entries);

/// Writes the contact sheet of each shot with two or more frames, counting those of other sets, if any has a
/// picture. Returns the files; what could not be written is printed and sets `failed`.
std::vector<std::string> write_contact_sheets(const SetPlan& plan, const std::vector<SetEntry>& entries,
                                              bool& failed);

}  // namespace penumbra
