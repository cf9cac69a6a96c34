#include "scheduler/farm/result_room.h"

namespace penumbra {

std::shared_ptr<void> ResultRoom::take(std::size_t bytes) {
  const std::lock_guard lock(state_->mutex);
  if (state_->used > 0 && (bytes > state_->most || state_->used > state_->most - bytes)) return nullptr;
  state_->used += bytes;
  return {static_cast<void*>(state_.get()), [state = state_, bytes](void*) {
            const std::lock_guard released(state->mutex);
            state->used -= bytes;
          }};
}

}  // namespace penumbra
