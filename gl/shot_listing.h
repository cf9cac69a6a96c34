// Which frames of a shot are there, by its folder and by the summary of the renders in it.
#pragma once

#include <vector>

#include "gl/view_model.h"
#include "kernels/host/file_stamp.h"
#include "scheduler/render/frame_files.h"

namespace penumbra {

struct ListedFrame {
  int number = 0;
  FrameState state = FrameState::kMissing;
  bool has_file = false;
  FileStamp stamp = {};  ///< of the file, if there is one
  bool operator==(const ListedFrame&) const = default;
};

/// The frames of the shot, ascending: those with a file, those that `jobs.json` or `NAME.jobs.json` in its
/// folder lists, and between the first and the last others at the smallest distance of those, which are
/// missing. At most a million.
std::vector<ListedFrame> list_shot(const FrameFiles& files);

}  // namespace penumbra
