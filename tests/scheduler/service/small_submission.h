// A small job as a client submits it to a service.
#pragma once

#include <string>

#include "scheduler/service/spool.h"
#include "scheduler/service/submission.h"
#include "tests/support/fake_device.h"
#include "worker/protocol/asset_manifest.h"

namespace penumbra {

inline std::string hash_of(const DeviceScene& scene) { return manifest_of(scene).hash; }

inline Submission small_submission(const DeviceScene& scene, int priority = 0) {
  Submission submission{.name = "s.xml", .scene = hash_of(scene), .priority = priority, .record = {}};
  submission.record.scene.file = "folder/s.xml";
  submission.record.film.width = submission.record.film.crop_width = scene.header.film.width;
  submission.record.film.height = submission.record.film.crop_height = scene.header.film.height;
  submission.files = {"s.exr", "s.png", "s.json"};
  return submission;
}

/// Puts it where a client's upload would.
inline void put_scene(Spool& spool, const DeviceScene& scene) {
  auto incoming = spool.receive_scene(hash_of(scene));
  ASSERT_TRUE(incoming) << incoming.error().message;
  const auto bytes = scene.serialize();
  ASSERT_TRUE(incoming->add(bytes));
  const auto finished = incoming->finish();
  ASSERT_TRUE(finished) << finished.error().message;
}

}  // namespace penumbra
