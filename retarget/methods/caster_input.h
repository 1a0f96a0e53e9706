#pragma once

#include "implicit/execution.h"
#include "implicit/geometry/camera.h"
#include "points/surfel_model.h"

namespace restroke::retarget {

/// What every method starts from: makeCaster's arguments. The model must outlive the caster unchanged.
struct CasterInput {
  const points::SurfelModel& model;
  Camera camera;
  implicit::Prefix prefix = {};
  Execution execution = {};
};

}  // namespace restroke::retarget
