// Converts between the viewers' messages of penumbra.proto and their own types. Received messages are
// validated here.
#pragma once

#include "kernels/host/error.h"
#include "penumbra.pb.h"
#include "scheduler/watch/watch_board.h"

namespace penumbra {

namespace wire = penumbra::v1;

wire::WatchEvent encode(const WatchedJob& job);
/// Errors: an invalid film, rectangle or centre.
Expected<WatchedJob> decode(const wire::WatchedJob& message);

wire::WatchEvent encode(const WatchItem& item);
Expected<WatchView> decode(const wire::NumberedView& message);
WatchProgress decode(const wire::Progress& message);
/// Errors: the tile is not on the job's film, or lacks values that the job's tiles have.
Expected<TileSnapshot> decode(const wire::TileState& message, const WatchedJob& job);

}  // namespace penumbra
