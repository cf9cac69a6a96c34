// How much the error of a shot changes from frame to frame.
#pragma once

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// A frame and the next one.
struct FramePair {
  const Image& frame;
  const Image& next;
};

/// The mean over the points that both frames of the reference show, and over channels, of
/// ((a' - a) - (b' - b))² / (b² + epsilon): a and b are the radiance of the images and of the reference, '
/// that of the next frame where it shows the same point, see PointTracker. 0 for images without noise, twice
/// their relMSE where the noise of frames is independent. Errors: sizes differ; neither reference nor images
/// have the layer `motion` in both frames; no radiance; no point is in both frames.
Expected<double> flicker(const FramePair& images, const FramePair& reference, double epsilon);

}  // namespace penumbra
