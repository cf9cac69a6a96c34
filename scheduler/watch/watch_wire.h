// Between the messages of penumbra.proto for watchers and the types that they carry. What arrives is checked
// here.
#pragma once

#include "kernels/host/error.h"
#include "penumbra.pb.h"
#include "scheduler/watch/watch_board.h"

namespace penumbra {

namespace wire = penumbra::v1;

wire::WatchEvent encode(const WatchedJob& job);
/// Fails on a film, a rectangle or a centre that makes no sense.
Expected<WatchedJob> decode(const wire::WatchedJob& message);

wire::WatchEvent encode(const WatchItem& item);
Expected<WatchView> decode(const wire::NumberedView& message);
WatchProgress decode(const wire::Progress& message);
/// Fails unless it lies on the job's film and has all values that the job's tiles have.
Expected<TileSnapshot> decode(const wire::TileState& message, const WatchedJob& job);

}  // namespace penumbra
