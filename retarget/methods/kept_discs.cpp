#include "retarget/methods/kept_discs.h"

#include <utility>

#include "retarget/methods/disc_scene.h"

namespace restroke::retarget {

KeptDiscs::KeptDiscs() = default;
KeptDiscs::~KeptDiscs() = default;

std::unique_ptr<DiscScene> KeptDiscs::take() {
  const std::lock_guard lock(mutex_);
  return std::move(scene_);
}

void KeptDiscs::giveBack(std::unique_ptr<DiscScene> scene) {
  const std::lock_guard lock(mutex_);
  std::swap(scene_, scene);  // what was here goes when the lock is free again
}

}  // namespace restroke::retarget
